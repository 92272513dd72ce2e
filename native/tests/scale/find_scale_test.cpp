// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/find_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

ScaleVotes votes(const shapes::Shape& a, const shapes::Shape& b, int threads = 2) {
    ScaleOptions options;
    options.votes = 40;
    Monitor monitor;
    return vote_scale(gate(a).mesh_with_paths(), gate(b).mesh_with_paths(), {}, options, 3, threads, monitor, 0.0, 1.0);
}

const shapes::Shape& body() {
    static const shapes::Shape shape = shapes::blob(3);
    return shape;
}

shapes::Shape copy(double scale) {
    return shapes::renumbered(shapes::moved(body(), shapes::some_rotation(), {3, 1, 2}, scale), 7).shape;
}

TEST(VoteScale, ReadsTheUnitsOfACopyWhateverTheyAre) {
    for (const double scale : {1.0, 0.01, 40.0}) {
        const ScaleVotes v = votes(body(), copy(scale));
        EXPECT_NEAR(v.by_fit / scale, 1.0, 0.05) << scale;
        EXPECT_NEAR(v.by_vote / scale, 1.0, 0.05) << scale;
        EXPECT_TRUE(votes_agree(v));
    }
}

TEST(VoteScale, ReadsTheUnitsOfAPart) {
    const shapes::Shape part = shapes::cut(body(), [](const Eigen::Vector3d& x) { return x.y() < 0.3; });
    const ScaleVotes v = votes(shapes::moved(part, shapes::some_rotation(), {0, 0, 0}, 2.0), body());
    EXPECT_NEAR(v.by_fit * 2.0, 1.0, 0.06);
}

TEST(VoteScale, IsEqualBitForBitForAnyNumberOfThreads) {
    const ScaleVotes one = votes(body(), copy(1.3), 1);
    const ScaleVotes two = votes(body(), copy(1.3), 2);
    EXPECT_EQ(one.by_fit, two.by_fit);
    EXPECT_EQ(one.by_vote, two.by_vote);
    EXPECT_EQ(one.fit, two.fit);
}

TEST(VoteScale, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    const TriangleMesh mesh = gate(body()).mesh_with_paths();
    EXPECT_THROW(vote_scale(mesh, mesh, {}, {}, 0, 2, monitor, 0.0, 1.0), Cancelled);
}

bool has(const std::vector<double>& candidates, double ratio) {
    return std::any_of(candidates.begin(), candidates.end(),
                       [&](double c) { return std::abs(c / ratio - 1.0) < 0.015; });
}

TEST(ScaleCandidates, TakeACommonUnitExactlyWhereTheVotesConfirmIt) {
    const auto found = scale_candidates({1.01, 0.99, 0.3}, {0.6, 1.0});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0], 1.0);
}

TEST(ScaleCandidates, TakeTheAreasExactlyWhereTheVotesConfirmThem) {
    const auto found = scale_candidates({1.99, 2.02, 0.3}, {2.0, 1.0});
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0], 2.0);
}

TEST(ScaleCandidates, HoldVotesThatAgreeAndTheExactRatiosThatTheyDoNotConfirm) {
    const auto found = scale_candidates({3.0, 3.0, 0.3}, {2.0, 1.0});
    EXPECT_NEAR(found.at(0), 3.0, 1e-12);
    EXPECT_TRUE(has(found, 1.0));
    EXPECT_TRUE(has(found, 2.0));
}

TEST(ScaleCandidates, HoldBothVotesWhereTheyDisagree) {
    const auto found = scale_candidates({0.5, 1.7, 0.3}, {1.2, 1.0});
    for (const double ratio : {0.5, 1.7, 1.0, 1.2}) EXPECT_TRUE(has(found, ratio)) << ratio;
}

}  // namespace
}  // namespace isograft
