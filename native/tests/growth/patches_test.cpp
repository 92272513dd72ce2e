// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/patches.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "feature/pair.h"
#include "isograft/errors.h"
#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

std::vector<OrientedMatch> some_matches() {
    std::vector<OrientedMatch> matches;
    for (int s = 0; s < twins().pair().source.samples.count(); s += 12) matches.push_back(twins().true_match(s));
    return matches;
}

std::vector<Patch> grown(const std::vector<OrientedMatch>& matches, int threads) {
    PatchSettings settings = twins().settings();
    settings.threads = threads;
    settings.blend.patches = 12;
    settings.blend.patch_size = 80;
    Monitor monitor;
    return grow_patches(twins().pair(), settings, matches, 0, monitor, 0.0, 1.0);
}

TEST(Mismatch, IsSmallWhereASampleBelongsAndAboutOneElsewhere) {
    const Pair& pair = twins().pair();
    std::vector<double> right, wrong, turned;
    const int count = pair.source.samples.count();
    for (int s = 0; s < count; s += 3) {
        const OrientedMatch m = twins().true_match(s);
        right.push_back(mismatch(pair, twins().options().feature, s, m.point, m.rotation));
        turned.push_back(mismatch(pair, twins().options().feature, s, m.point, -m.rotation));
        const OrientedMatch other = twins().true_match((s + count / 2) % count);
        wrong.push_back(mismatch(pair, twins().options().feature, s, other.point, other.rotation));
    }
    EXPECT_LT(shapes::mean(right), 0.35);
    EXPECT_NEAR(shapes::mean(wrong), 1.0, 0.3);
    EXPECT_GT(shapes::mean(turned), shapes::mean(right) + 0.3);
}

TEST(Patches, FromRightMatchesAreRightAndComeBestFirst) {
    const auto patches = grown(some_matches(), 2);
    ASSERT_FALSE(patches.empty());
    EXPECT_LE(patches.size(), 12U);
    EXPECT_TRUE(std::is_sorted(patches.begin(), patches.end(),
                               [](const Patch& a, const Patch& b) { return a.quality < b.quality; }));
    for (const Patch& p : patches) {
        EXPECT_GT(p.map.count, 20);
        EXPECT_LE(p.map.count, 80);
        std::vector<double> errors;
        for (const int s : twins().all_samples()) {
            if (p.map.mapped[s]) errors.push_back(twins().error(s, p.map.position[s]));
        }
        EXPECT_LT(shapes::mean(errors), 0.3);
    }
}

TEST(BetterHalf, IsTheMeanOfWhatIsBelowTheMedian) {
    EXPECT_DOUBLE_EQ(better_half({9.0, 1.0, 3.0, 7.0}), 2.0);
    EXPECT_DOUBLE_EQ(better_half({9.0, 1.0, 3.0, 7.0, 100.0}), 2.0);
    EXPECT_DOUBLE_EQ(better_half({5.0}), 5.0);
}

TEST(Patches, FromWrongMatchesAreWorse) {
    const auto& settings = twins().settings();
    Grower grower(twins().pair().source.samples, twins().pair().target, settings.growth);
    const auto matches = some_matches();
    double right = 0.0, wrong = 0.0;
    for (std::size_t i = 0; i < matches.size(); ++i) {
        OrientedMatch astray = matches[(i + matches.size() / 2) % matches.size()];
        astray.sample = matches[i].sample;
        right += probe(twins().pair(), settings, grower, matches[i], 40).quality;
        wrong += probe(twins().pair(), settings, grower, astray, 40).quality;
    }
    EXPECT_LT(right, 0.6 * wrong);
}

TEST(Patches, AreEqualBitForBitForAnyNumberOfThreads) {
    const auto one = grown(some_matches(), 1);
    const auto two = grown(some_matches(), 2);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].quality, two[i].quality);
        EXPECT_EQ(one[i].map.mapped, two[i].map.mapped);
        EXPECT_EQ(one[i].map.rotation, two[i].map.rotation);
    }
}

TEST(Patches, StopWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(grow_patches(twins().pair(), twins().settings(), some_matches(), 0, monitor, 0.0, 1.0), Cancelled);
}

}  // namespace
}  // namespace isograft
