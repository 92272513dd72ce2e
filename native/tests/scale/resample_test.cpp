// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/resample.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

Pair resampled(std::uint64_t seed, int threads) {
    Monitor monitor;
    Pair pair = Twins::of_a_blob().pair();
    MatchOptions options = Twins::of_a_blob().options();
    options.threads = threads;
    resample(pair, options, seed, monitor, 0.0, 1.0);
    return pair;
}

TEST(Resample, MovesTheSamplesAndKeepsSpacingMeshAndCurvature) {
    const Pair& before = Twins::of_a_blob().pair();
    const Pair after = resampled(77, 2);
    EXPECT_EQ(after.source.samples.spacing, before.source.samples.spacing);
    EXPECT_EQ(after.target.samples.spacing, before.target.samples.spacing);
    EXPECT_EQ(after.source_curvature, before.source_curvature);
    EXPECT_NEAR(after.source.samples.count(), before.source.samples.count(), 0.1 * before.source.samples.count());
    int same = 0;
    for (const auto& p : after.source.samples.position) {
        same += std::any_of(before.source.samples.position.begin(), before.source.samples.position.end(),
                            [&](const Eigen::Vector3d& q) { return (p - q).norm() < 1e-9; })
                    ? 1
                    : 0;
    }
    EXPECT_LT(same, after.source.samples.count() / 2);
    EXPECT_EQ(after.source_descriptor.size(), after.source.samples.point.size());
    EXPECT_EQ(after.target_descriptor.size(), after.target.samples.point.size());
}

TEST(Resample, IsTheSameWithAnyNumberOfThreads) {
    const Pair one = resampled(5, 1);
    const Pair eight = resampled(5, 8);
    ASSERT_EQ(one.target.samples.count(), eight.target.samples.count());
    for (int s = 0; s < one.target.samples.count(); ++s) {
        EXPECT_EQ(one.target.samples.position[s], eight.target.samples.position[s]);
        EXPECT_EQ(one.target_descriptor[s].cell, eight.target_descriptor[s].cell);
    }
    EXPECT_EQ(one.chance, eight.chance);
}

TEST(Resample, LeavesLandmarksTheFirstSamples) {
    Monitor monitor;
    Pair pair = Twins::of_a_blob().pair();
    MatchOptions options = Twins::of_a_blob().options();
    options.landmarks = {{3, 4, 1.0}, {5, 6, 1.0}};
    const auto first = pair.source.samples.position[0];
    const auto second = pair.source.samples.position[1];
    resample(pair, options, 9, monitor, 0.0, 1.0);
    EXPECT_LT((pair.source.samples.position[0] - first).norm(), 1e-12);
    EXPECT_LT((pair.source.samples.position[1] - second).norm(), 1e-12);
}

}  // namespace
}  // namespace isograft
