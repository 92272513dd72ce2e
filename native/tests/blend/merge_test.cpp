// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/merge.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "made_patch.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

TEST(Merge, OfPatchesThatAgreeIsWhatTheyAgreeOn) {
    const auto low = [](const Eigen::Vector3d& x) { return x.y() < 0.1; };
    const auto high = [](const Eigen::Vector3d& x) { return x.y() > -0.1; };
    const Patch a = made_patch(low, where_it_belongs);
    const Patch b = made_patch(high, where_it_belongs);
    PartialMap map(twins().pair().source.samples.count());
    merge_into(map, twins().pair(), twins().settings(), {&a, &b}, {1.0, 1.0});
    EXPECT_EQ(map.count, twins().pair().source.samples.count());
    for (const int s : twins().all_samples()) EXPECT_LT(twins().error(s, map.position[s]), 0.3);
}

TEST(Merge, GoesWithTheMajorityAndNotWithTheMean) {
    const Patch a = made_patch(everywhere, where_it_belongs);
    const Patch b = made_patch(everywhere, where_it_belongs);
    const Patch wrong = made_patch(everywhere, at_the_other_end);
    PartialMap map(twins().pair().source.samples.count());
    merge_into(map, twins().pair(), twins().settings(), {&wrong, &a, &b}, {1.0, 1.0, 1.0});
    EXPECT_GT(map.count, 0);
    for (const int s : twins().all_samples()) {
        if (map.mapped[s]) {
            EXPECT_LT(twins().error(s, map.position[s]), 0.3);
        }
    }
}

TEST(Merge, AnEdgeKeepsItsLengthToAThirdAndAFifthOfASpacing) {
    const Samples& source = twins().pair().source.samples;
    const SampleEdge& edge = source.edges[source.base_edges_of[3].front()];
    const Eigen::Vector3d along = source.position[edge.v] - source.position[edge.u];
    const double bearable = 0.35 * edge.length + 0.2 * source.spacing;
    const auto keeps = [&](double change) {
        const Eigen::Vector3d a(1.0, 2.0, 3.0);
        return keeps_length(source, edge, a, a + (along.norm() + change) * along.normalized());
    };
    EXPECT_TRUE(keeps(0.0));
    EXPECT_TRUE(keeps(0.99 * bearable));
    EXPECT_TRUE(keeps(-0.99 * bearable));
    EXPECT_FALSE(keeps(1.01 * bearable));
    EXPECT_FALSE(keeps(-1.01 * bearable));
}

TEST(Merge, LeavesWhatIsThereAndHearsNobodyWithoutWeight) {
    const Patch wrong = made_patch(everywhere, at_the_other_end);
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
    const Patch both = made_patch([&](const Eigen::Vector3d& x) { return high(x) || low(x); }, where_it_belongs);
    const auto parts = continuous_parts(both.map, pair);
    for (const int s : twins().all_samples()) {
        const Eigen::Vector3d& x = pair.source.samples.position[s];
        EXPECT_EQ(parts[s], low(x) ? 0 : high(x) ? 1 : -1);
    }
}

// As a completion has them, from the largest part.
int drop_torn(PartialMap& map) {
    PartialMap main = map;
    const std::vector<int> part = continuous_parts(map, twins().pair());
    for (const int s : twins().all_samples()) {
        if (part[s] > 0) main.drop(s);
    }
    DistanceFields fields(twins().pair());
    Anchors anchors(fields);
    Monitor monitor;
    EXPECT_TRUE(anchors.place(main, 12, monitor));
    return drop_torn_parts(map, twins().pair(), anchors);
}

TEST(TornParts, AreDroppedWhereTheyTouchALargerOneAndLieElsewhere) {
    const auto cap = [](const Eigen::Vector3d& x) { return x.y() > 0.2; };
    Patch whole = made_patch(everywhere, where_it_belongs);
    const Patch wrong = made_patch(cap, at_the_other_end);
    int moved = 0;
    for (const int s : twins().all_samples()) {
        if (!wrong.map.mapped[s]) continue;
        whole.map.put(twins().pair().target.mesh, s, wrong.map.image[s], wrong.map.rotation[s]);
        ++moved;
    }
    ASSERT_GT(moved, 10);
    EXPECT_GT(torn_share(whole.map, twins().pair().source.samples), 0.01);
    const int before = whole.map.count;
    const int dropped = drop_torn(whole.map);
    EXPECT_EQ(whole.map.count, before - dropped);
    EXPECT_GE(dropped, moved - 2);
    EXPECT_EQ(torn_share(whole.map, twins().pair().source.samples), 0.0);
    for (const int s : twins().all_samples()) {
        if (whole.map.mapped[s]) {
            EXPECT_LT(twins().error(s, whole.map.position[s]), 0.3);
        }
    }
}

// Two caps with a gap between them, the lower one larger.
Patch caps(double low, double high, const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place_high) {
    const Patch below = made_patch([&](const Eigen::Vector3d& x) { return x.y() < low; }, where_it_belongs);
    Patch both = made_patch([&](const Eigen::Vector3d& x) { return x.y() > high; }, place_high);
    for (const int s : twins().all_samples()) {
        if (below.map.mapped[s]) {
            both.map.put(twins().pair().target.mesh, s, below.map.image[s], below.map.rotation[s]);
        }
    }
    return both;
}

TEST(TornParts, ThatTouchNothingAndFitStay) {
    PartialMap map = caps(-0.02, 0.22, where_it_belongs).map;
    const int before = map.count;
    EXPECT_EQ(drop_torn(map), 0);
    EXPECT_EQ(map.count, before);
}

// Two caps, the upper one `spacings` away from where it belongs.
PartialMap moved_cap(double low, double high, const Eigen::Vector3d& direction, double spacings) {
    const Eigen::Vector3d step =
        spacings * twins().spacing() * (twins().truth(direction) - twins().truth(Eigen::Vector3d::Zero()));
    return caps(low, high, [step](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + step); }).map;
}

TEST(TornParts, BeyondAStretchedJointStay) {
    PartialMap map = moved_cap(0.0, 0.08, Eigen::Vector3d::UnitY(), 4.0);
    EXPECT_EQ(drop_torn(map), 0);
}

TEST(TornParts, ThatFitNoAnchorGo) {
    PartialMap map = moved_cap(0.0, 0.2, Eigen::Vector3d::UnitX(), 8.0);
    EXPECT_GT(drop_torn(map), 20);
}

}  // namespace
}  // namespace isograft
