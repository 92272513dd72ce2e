// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/feature_match.h"

#include <cmath>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace isograft {
namespace {

FeatureSet on_a_line(const std::vector<double>& values) {
    FeatureSet set;
    set.descriptor = Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    set.distinctiveness = Eigen::VectorXd::Constant(set.descriptor.rows(), std::exp(1.0));
    return set;
}

FeatureGeodesics distances(const std::vector<double>& places) {
    const auto n = static_cast<Eigen::Index>(places.size());
    FeatureGeodesics result{Eigen::MatrixXd(n, n), Eigen::MatrixXd::Zero(n, n)};
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) result.distance(i, j) = std::abs(places[i] - places[j]);
    }
    return result;
}

std::vector<std::vector<int>> cluster(std::vector<FeatureMatch>& matches, const FeatureGeodesics& source,
                                      const FeatureGeodesics& target, const ClusterOptions& options) {
    Monitor monitor;
    return cluster_matches(matches, source, target, options, monitor);
}

TEST(CandidateMatches, AreTheNearestByEquationSeven) {
    const auto matches = candidate_matches(on_a_line({0.0, 1.0}), on_a_line({0.9, 0.2, 5.0}), 2, 10.0);
    ASSERT_EQ(matches.size(), 4U);
    EXPECT_EQ(matches[0].target, 1);
    EXPECT_NEAR(matches[0].dissimilarity, -1.0 + 10.0 * 0.04, 1e-12);
    EXPECT_EQ(matches[1].target, 0);
    EXPECT_NEAR(matches[1].dissimilarity, -1.0 + 10.0 * 0.81, 1e-12);
    EXPECT_EQ(matches[2].source, 1);
    EXPECT_EQ(matches[2].target, 0);
}

TEST(CandidateMatches, OfMoreDistinctFeaturesComeFirst) {
    FeatureSet source = on_a_line({0.0, 0.0});
    source.distinctiveness << 1.0, 8.0;
    const auto matches = candidate_matches(source, on_a_line({0.0}), 5, 400.0);
    ASSERT_EQ(matches.size(), 2U);
    EXPECT_NEAR(matches[0].dissimilarity - matches[1].dissimilarity, std::log(8.0), 1e-12);
}

TEST(ClusterMatches, TakesInWhatKeepsItsDistances) {
    // Features 0, 1, 2 lie in both surfaces alike; match 3 takes feature 2 elsewhere.
    std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 1.0, 0.0}, {2, 2, 1.0, 0.0}, {2, 3, 0.5, 0.0}};
    const auto clusters =
        cluster(matches, distances({0.0, 1.0, 2.0}), distances({0.0, 1.0, 2.0, 9.0}), {1.0, 11.5, 10.0});
    ASSERT_FALSE(clusters.empty());
    EXPECT_EQ(clusters.front(), (std::vector<int>{0, 1, 2}));
    EXPECT_NEAR(matches[2].priority, 1.0, 1e-12);
    EXPECT_NEAR(matches[0].priority, 0.0, 1e-12);
}

TEST(ClusterMatches, AddsEquationEightOverTheWholeCluster) {
    std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 0.0}, {2, 2, 1.0, 0.0}};
    // 2 is 0.5 too far from 0 and 0.5 too far from 1.
    cluster(matches, distances({0.0, 1.0, 2.0}), distances({0.0, 1.0, 2.5}), {4.0, 11.5, 10.0});
    EXPECT_NEAR(matches[2].priority, 1.0 + 2.0 * 4.0 * 0.25, 1e-12);
    EXPECT_NEAR(matches[0].priority, 4.0 * 0.25, 1e-12);
    std::vector<FeatureMatch> strict{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 0.0}, {2, 2, 1.0, 0.0}};
    const auto clusters =
        cluster(strict, distances({0.0, 1.0, 2.0}), distances({0.0, 1.0, 2.5}), {4.0, 1.0 + 4.0 * 0.5 - 0.01, 10.0});
    EXPECT_EQ(clusters.front(), (std::vector<int>{0, 1}));
}

TEST(ClusterMatches, HoldsNoSourceFeatureTwiceAndStopsWhenThereAreMoreMembersThanMatches) {
    std::vector<FeatureMatch> matches;
    for (int s = 0; s < 8; ++s) {
        for (int t = 0; t < 8; ++t) matches.push_back({s, t, 0.1 * std::abs(s - t), 0.0});
    }
    std::vector<double> places;
    for (int i = 0; i < 8; ++i) places.push_back(i * (1.0 + 0.1 * i));
    const auto clusters = cluster(matches, distances(places), distances(places), {1.0, 11.5, 3.0});
    std::size_t members = 0;
    for (const auto& c : clusters) {
        std::set<int> sources;
        for (const int m : c) sources.insert(matches[m].source);
        EXPECT_EQ(sources.size(), c.size());
        EXPECT_LE(members, matches.size());
        members += c.size();
    }
    EXPECT_GT(members, matches.size());
}

TEST(ClusterMatches, LooksAtNeighboursOnly) {
    std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 0.0}};
    const auto clusters = cluster(matches, distances({0.0, 5.0}), distances({0.0, 5.0}), {1.0, 11.5, 4.0});
    EXPECT_EQ(clusters.front().size(), 1U);
}

TEST(FeatureGeodesics, AreDistancesAndAnglesOfThePlane) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(20, 20, 0.1, 0.1));
    std::vector<SurfacePoint> points;
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.52, 0.41, 0.0), Eigen::Vector3d(1.63, 0.92, 0.0)}) {
        points.push_back(shapes::point_nearest(mesh, x));
    }
    Monitor monitor;
    const auto all = feature_geodesics(mesh, points, std::numeric_limits<double>::infinity(), 2, monitor, 0.0, 1.0);
    const Eigen::Vector3d way = position(mesh, points[1]) - position(mesh, points[0]);
    EXPECT_NEAR(all.distance(0, 1), way.norm(), 1e-6);
    EXPECT_NEAR(all.distance(1, 0), way.norm(), 1e-6);
    const Complex direction = unit(flatten(mesh, points[0].face, way));
    EXPECT_LT(std::abs(std::polar(1.0, all.angle(0, 1)) - direction), 1e-6);
    const auto bounded = feature_geodesics(mesh, points, 0.5, 2, monitor, 0.0, 1.0);
    EXPECT_TRUE(std::isinf(bounded.distance(0, 1)));
}

}  // namespace
}  // namespace isograft
