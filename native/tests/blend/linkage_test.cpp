// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/linkage.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace isograft {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Groups of items `near` apart inside a group and `far` between groups.
Eigen::MatrixXd groups(const std::vector<int>& sizes, double near, double far) {
    std::vector<int> group;
    for (std::size_t g = 0; g < sizes.size(); ++g) group.insert(group.end(), sizes[g], static_cast<int>(g));
    const auto n = static_cast<Eigen::Index>(group.size());
    Eigen::MatrixXd distance = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (Eigen::Index j = 0; j < n; ++j) {
            if (i != j) distance(i, j) = group[i] == group[j] ? near : far;
        }
    }
    return distance;
}

TEST(Affinity, OfTwoItemsThatPointAtEachOtherIsTwo) {
    Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(2, 2);
    weight(0, 1) = weight(1, 0) = 1.0;
    EXPECT_DOUBLE_EQ(affinity(weight, {0}, {1}), 2.0);
    weight(1, 0) = 0.0;  // one way only is no affinity
    EXPECT_DOUBLE_EQ(affinity(weight, {0}, {1}), 0.0);
}

TEST(Affinity, IsSymmetricAndAsInZhangsFormula) {
    Eigen::MatrixXd weight(4, 4);
    weight << 0.0, 0.5, 0.2, 0.1, 0.6, 0.0, 0.3, 0.7, 0.4, 0.2, 0.0, 0.9, 0.8, 0.1, 0.3, 0.0;
    const std::vector<int> a{0, 3}, b{1, 2};
    const Eigen::MatrixXd ab = weight(a, b), ba = weight(b, a);
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(2);
    const double expected = one.dot(ab * (ba * one)) / 4.0 + one.dot(ba * (ab * one)) / 4.0;
    EXPECT_NEAR(affinity(weight, a, b), expected, 1e-12);
    EXPECT_NEAR(affinity(weight, b, a), expected, 1e-12);
}

TEST(GraphDegreeLinkage, FindsGroupsAndPutsTheTightestFirst) {
    const Clusters clusters = graph_degree_linkage(groups({3, 6, 1}, 0.1, 5.0), {20, 0.5});
    ASSERT_EQ(clusters.members.size(), 3U);
    EXPECT_EQ(clusters.members[0], (std::vector<int>{3, 4, 5, 6, 7, 8}));
    EXPECT_EQ(clusters.members[1], (std::vector<int>{0, 1, 2}));
    EXPECT_EQ(clusters.members[2], (std::vector<int>{9}));
    EXPECT_GT(clusters.affinity[0], clusters.affinity[1]);
    EXPECT_DOUBLE_EQ(clusters.affinity[2], 0.0);
}

TEST(GraphDegreeLinkage, PutsALargeGroupBeforeASmallOneThatIsNoTighter) {
    // Two rings, so that every item is among the nearest of as many as it points at.
    const std::vector<int> sizes{6, 18};
    Eigen::MatrixXd distance = groups(sizes, 0.1, 5.0);
    int begin = 0;
    for (const int size : sizes) {
        for (int i = 0; i < size; ++i) {
            for (int j = 0; j < size; ++j) {
                const int apart = std::min(std::abs(i - j), size - std::abs(i - j));
                if (i != j) distance(begin + i, begin + j) += 0.001 * apart;
            }
        }
        begin += size;
    }
    const Clusters clusters = graph_degree_linkage(distance, {8, 0.1});
    ASSERT_EQ(clusters.members.size(), 2U);
    EXPECT_EQ(clusters.members[0].size(), 18U);
}

TEST(GraphDegreeLinkage, ClustersOfAPartComeAfterThoseOfTheWholeUnlessTheyAreMuchTighter) {
    const Clusters clusters{{{0, 1}, {2, 3}, {4}, {5}}, {4.0, 3.0, 0.0, 0.0}};
    EXPECT_EQ(by_affinity_and_area(clusters, {1.0, 2.0, 1.0, 2.0}), (std::vector<int>{1, 0, 3, 2}));
    EXPECT_EQ(by_affinity_and_area(clusters, {2.0, 2.0, 1.0, 1.0}), (std::vector<int>{0, 1, 2, 3}));
}

TEST(GraphDegreeLinkage, WithThresholdZeroJoinsGroupsThatAreNear) {
    Eigen::MatrixXd distance = groups({3, 4}, 0.1, 0.5);
    EXPECT_EQ(graph_degree_linkage(distance, {20, 0.0}).members.size(), 1U);
    distance = groups({3, 4}, 0.1, infinity);
    EXPECT_EQ(graph_degree_linkage(distance, {20, 0.0}).members.size(), 2U);
}

TEST(GraphDegreeLinkage, WithThresholdZeroStillPartsWhatHardlyTouches) {
    // One item of each group has one of the other among its nearest.
    Eigen::MatrixXd distance = groups({9, 9}, 0.1, 5.0);
    for (const auto& [i, j] : {std::pair{0, 1}, std::pair{9, 10}}) distance(i, j) = distance(j, i) = 0.4;
    distance(0, 9) = distance(9, 0) = 0.14;
    const double between = affinity(neighbour_weights(distance, 8), {0}, {9});
    ASSERT_GT(between, least_affinity);
    const Clusters clusters = graph_degree_linkage(distance, {8, 0.0});
    ASSERT_EQ(clusters.members.size(), 2U);
    EXPECT_EQ(clusters.members[0], (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
}

TEST(GraphDegreeLinkage, AHigherThresholdNeverMakesFewerClusters) {
    const Eigen::MatrixXd distance = groups({2, 3, 4}, 0.3, 1.0);
    std::size_t fewest = 0;
    for (const double threshold : {0.0, 0.5, 1.0, 1.9, 10.0}) {
        const std::size_t count = graph_degree_linkage(distance, {20, threshold}).members.size();
        EXPECT_GE(count, fewest);
        fewest = count;
    }
    EXPECT_EQ(fewest, 9U);
}

TEST(GraphDegreeLinkage, LeavesItemsWithoutNeighboursAlone) {
    const Clusters clusters = graph_degree_linkage(groups({1, 1, 1}, 0.0, infinity), {20, 0.0});
    EXPECT_EQ(clusters.members.size(), 3U);
    EXPECT_EQ(graph_degree_linkage(Eigen::MatrixXd::Zero(1, 1), {20, 1.0}).members.size(), 1U);
}

TEST(NeighbourWeights, FallWithTheSquareOfTheDistanceOverItsMean) {
    Eigen::MatrixXd distance(3, 3);
    distance << 0.0, 1.0, 3.0, 1.0, 0.0, 2.0, 3.0, 2.0, 0.0;
    const Eigen::MatrixXd weight = neighbour_weights(distance, 1);
    const double variance = (1.0 + 1.0 + 4.0) / 3.0;
    EXPECT_NEAR(weight(0, 1), std::exp(-1.0 / variance), 1e-12);
    EXPECT_NEAR(weight(2, 1), std::exp(-4.0 / variance), 1e-12);
    EXPECT_EQ(weight(1, 2), 0.0);
    EXPECT_EQ(weight(0, 2), 0.0);
}

}  // namespace
}  // namespace isograft
