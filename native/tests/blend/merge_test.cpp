// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/merge.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

/// A patch that holds the samples for which keep(position) holds, put where `place` of their true image lies.
template <class Keep, class Place>
Patch patch(Keep&& keep, Place&& place) {
    const Pair& pair = twins().pair();
    const Samples& samples = pair.source.samples;
    Patch result;
    result.map = PartialMap(samples.count());
    for (int s = 0; s < samples.count(); ++s) {
        if (!keep(samples.position[s])) continue;
        const OrientedMatch match = twins().true_match(s);
        const SurfacePoint p = shapes::point_nearest(pair.target.mesh, place(position(pair.target.mesh, match.point)));
        result.map.put(pair.target.mesh, s, p, match.rotation);
        result.map.seed = s;
    }
    measure_seed_distance(samples, result.map);
    return result;
}

Eigen::Vector3d right(const Eigen::Vector3d& x) { return x; }
/// The other end of the body.
Eigen::Vector3d astray(const Eigen::Vector3d& x) { return 2.0 * twins().truth(Eigen::Vector3d::Zero()) - x; }
bool all(const Eigen::Vector3d& /*x*/) { return true; }

TEST(Merge, OfPatchesThatAgreeIsWhatTheyAgreeOn) {
    const auto low = [](const Eigen::Vector3d& x) { return x.y() < 0.1; };
    const auto high = [](const Eigen::Vector3d& x) { return x.y() > -0.1; };
    const Patch a = patch(low, right);
    const Patch b = patch(high, right);
    PartialMap map(twins().pair().source.samples.count());
    merge_into(map, twins().pair(), twins().settings(), {&a, &b}, {1.0, 1.0});
    EXPECT_EQ(map.count, twins().pair().source.samples.count());
    for (const int s : twins().all_samples()) EXPECT_LT(twins().error(s, map.position[s]), 0.3);
}

TEST(Merge, GoesWithTheMajorityAndNotWithTheMean) {
    const Patch a = patch(all, right);
    const Patch b = patch(all, right);
    const Patch wrong = patch(all, astray);
    PartialMap map(twins().pair().source.samples.count());
    merge_into(map, twins().pair(), twins().settings(), {&wrong, &a, &b}, {1.0, 1.0, 1.0});
    EXPECT_GT(map.count, 0);
    for (const int s : twins().all_samples()) {
        if (map.mapped[s]) {
            EXPECT_LT(twins().error(s, map.position[s]), 0.3);
        }
    }
}

TEST(Merge, LeavesWhatIsThereAndHearsNobodyWithoutWeight) {
    const Patch wrong = patch(all, astray);
    PartialMap map = twins().true_map({3});
    const Eigen::Vector3d before = map.position[3];
    merge_into(map, twins().pair(), twins().settings(), {&wrong}, {0.0});
    EXPECT_EQ(map.count, 1);
    merge_into(map, twins().pair(), twins().settings(), {&wrong}, {1.0});
    EXPECT_GT(map.count, 1);
    EXPECT_EQ(map.position[3], before);
}

TEST(ContinuousParts, AreOneWhereNothingIsTorn) {
    const auto parts = continuous_parts(twins().true_map(twins().all_samples()), twins().pair());
    EXPECT_EQ(std::count(parts.begin(), parts.end(), 0), static_cast<std::ptrdiff_t>(parts.size()));
}

TEST(ContinuousParts, AreNumberedByAreaAndLeaveOutTheUnmapped) {
    // Two caps and a gap of several spacings between them; the lower one is the larger.
    const Pair& pair = twins().pair();
    const auto high = [](const Eigen::Vector3d& x) { return x.y() > 0.22; };
    const auto low = [](const Eigen::Vector3d& x) { return x.y() < -0.02; };
    const Patch both = patch([&](const Eigen::Vector3d& x) { return high(x) || low(x); }, right);
    const auto parts = continuous_parts(both.map, pair);
    for (const int s : twins().all_samples()) {
        const Eigen::Vector3d& x = pair.source.samples.position[s];
        EXPECT_EQ(parts[s], low(x) ? 0 : high(x) ? 1 : -1);
    }
}

TEST(TornParts, AreDroppedWhereTheyTouchALargerOneAndLieElsewhere) {
    const auto cap = [](const Eigen::Vector3d& x) { return x.y() > 0.2; };
    Patch whole = patch(all, right);
    const Patch wrong = patch(cap, astray);
    int moved = 0;
    for (const int s : twins().all_samples()) {
        if (!wrong.map.mapped[s]) continue;
        whole.map.put(twins().pair().target.mesh, s, wrong.map.image[s], wrong.map.rotation[s]);
        ++moved;
    }
    ASSERT_GT(moved, 10);
    const int before = whole.map.count;
    const int dropped = drop_torn_parts(whole.map, twins().pair());
    EXPECT_EQ(whole.map.count, before - dropped);
    EXPECT_GE(dropped, moved - 2);
    for (const int s : twins().all_samples()) {
        if (whole.map.mapped[s]) {
            EXPECT_LT(twins().error(s, whole.map.position[s]), 0.3);
        }
    }
}

TEST(TornParts, ThatTouchNothingStay) {
    const Patch both = patch([](const Eigen::Vector3d& x) { return x.y() > 0.22 || x.y() < -0.02; }, right);
    PartialMap map = both.map;
    EXPECT_EQ(drop_torn_parts(map, twins().pair()), 0);
    EXPECT_EQ(map.count, both.map.count);
}

}  // namespace
}  // namespace isograft
