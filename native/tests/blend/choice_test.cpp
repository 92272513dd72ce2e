// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/choice.h"

#include <vector>

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

std::vector<double> all_doubt(double value) {
    return std::vector<double>(static_cast<std::size_t>(twins().pair().source.samples.count()), value);
}

MapQuality quality(const PartialMap& map, const std::vector<double>& doubts) {
    return measure_quality(twins().pair(), twins().options().feature, map, doubts);
}

/// Every sample where another one belongs.
PartialMap shuffled() {
    const int count = twins().pair().source.samples.count();
    PartialMap map(count);
    for (int s = 0; s < count; ++s) {
        const OrientedMatch match = twins().true_match((s + count / 2) % count);
        map.put(twins().pair().target.mesh, s, match.point, match.rotation);
    }
    return map;
}

TEST(MapQuality, OfARigidMotionIsNearlyPerfect) {
    const MapQuality q = quality(twins().true_map(twins().all_samples()), all_doubt(0.0));
    EXPECT_LT(q.mismatch, 0.3);
    EXPECT_GT(q.curvature, 0.97);
    EXPECT_LT(q.rigidity, 1e-3);
    EXPECT_NEAR(q.expected, 1.0, 1e-9);
}

TEST(MapQuality, OfAShuffledMapIsThatOfChance) {
    const MapQuality q = quality(shuffled(), all_doubt(0.0));
    EXPECT_NEAR(q.mismatch, 1.0, 0.3);
    EXPECT_LT(q.curvature, 0.4);
    EXPECT_GT(q.rigidity, 0.3);
}

TEST(MapQuality, ExpectsThatMuchOfTheAreaAsIsMappedWithoutDoubt) {
    const Samples& samples = twins().pair().source.samples;
    std::vector<int> low;
    std::vector<double> doubts = all_doubt(0.0);
    double area = 0.0;
    double whole = 0.0;
    for (const int s : twins().all_samples()) {
        whole += samples.area[s];
        if (samples.position[s].y() < 0.0) {
            low.push_back(s);
            area += samples.area[s];
        } else {
            doubts[s] = 1.0;
        }
    }
    // Two ways to have no say: not mapped, or certainly wrong.
    EXPECT_NEAR(quality(twins().true_map(low), doubts).expected, area / whole, 1e-3);
    EXPECT_NEAR(quality(twins().true_map(twins().all_samples()), doubts).expected, area / whole, 1e-3);
}

TEST(MapQuality, ExpectsLessTheMoreDoubtThereIsAndNeverLessThanNothing) {
    const PartialMap map = twins().true_map(twins().all_samples());
    double before = 2.0;
    for (const double doubt : {0.0, 0.05, 0.1, 0.2}) {
        const double expected = quality(map, all_doubt(doubt)).expected;
        EXPECT_LT(expected, before);
        before = expected;
    }
    EXPECT_EQ(quality(map, all_doubt(0.9)).expected, 0.0);
}

TEST(MapQuality, OfNothingIsNothing) {
    const MapQuality q = quality(twins().true_map({}), all_doubt(0.0));
    EXPECT_EQ(q.expected, 0.0);
    EXPECT_EQ(q.mismatch, 0.0);
    EXPECT_EQ(choice_score(q), 0.0);
}

TEST(ChoiceScore, RisesWithEachMeasureThatSpeaksForAMap) {
    MapQuality good;
    good.expected = 0.6;
    good.curvature = 0.7;
    good.rigidity = 0.1;
    const double score = choice_score(good);
    MapQuality more = good;
    more.expected = 0.7;
    EXPECT_GT(choice_score(more), score);
    MapQuality bumpier = good;
    bumpier.curvature = 0.8;
    EXPECT_GT(choice_score(bumpier), score);
    MapQuality bent = good;
    bent.rigidity = 0.2;
    EXPECT_LT(choice_score(bent), score);
}

TEST(ChoiceScore, PrefersTheRightMapEvenWithoutDoubtToTellItBy) {
    const PartialMap right = twins().true_map(twins().all_samples());
    EXPECT_GT(choice_score(quality(right, all_doubt(0.1))), 2.0 * choice_score(quality(shuffled(), all_doubt(0.1))));
}

}  // namespace
}  // namespace isograft
