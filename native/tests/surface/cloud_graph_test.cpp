// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_graph.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace isograft {
namespace {

using Positions = std::vector<Eigen::Vector3d>;

/// The first `count` points of a square grid of unit cells, `across` a row.
void add_grid(Positions& points, int count, int across, double z) {
    for (int i = 0; i < count; ++i) points.emplace_back(i % across, i / across, z);
}

std::vector<char> outliers(const Positions& points, int fewest) {
    Monitor monitor;
    const KdTree tree(points);
    return find_outliers(tree, neighbour_graph(tree, graph_neighbours, monitor), 3.0, fewest);
}

TEST(NeighbourGraph, JoinsEveryPointWithItsNearestAndWithThoseItIsNearestTo) {
    Random random(1);
    Positions points;
    for (int i = 0; i < 200; ++i) points.emplace_back(random.uniform(), random.uniform(), random.uniform());
    Monitor monitor;
    const KdTree tree(points);
    const CloudGraph graph = neighbour_graph(tree, graph_neighbours, monitor);
    std::vector<std::vector<int>> expected(points.size());
    for (int i = 0; i < 200; ++i) {
        std::vector<std::pair<double, int>> others;
        for (int j = 0; j < 200; ++j) {
            if (j != i) others.emplace_back((points[i] - points[j]).norm(), j);
        }
        std::sort(others.begin(), others.end());
        for (int k = 0; k < 8; ++k) {
            expected[i].push_back(others[k].second);
            expected[others[k].second].push_back(i);
        }
    }
    for (int i = 0; i < 200; ++i) {
        std::sort(expected[i].begin(), expected[i].end());
        expected[i].erase(std::unique(expected[i].begin(), expected[i].end()), expected[i].end());
        EXPECT_EQ(graph.neighbours[i], expected[i]) << "point " << i;
    }
}

TEST(FindOutliers, LeavesOutGroupsOfFewerThanAskedForAndKeepsLargerOnes) {
    for (const int group : {19, 20}) {
        Positions points;
        add_grid(points, 900, 30, 0.0);
        add_grid(points, group, 5, 40.0);
        const std::vector<char> out = outliers(points, 20);
        EXPECT_EQ(std::count(out.begin(), out.begin() + 900, 1), 0);
        EXPECT_EQ(std::count(out.begin() + 900, out.end(), 1), group < 20 ? group : 0);
    }
}

TEST(FindOutliers, LeavesOutAPointThatIsFartherAwayThanTheReach) {
    // The eighth neighbour in the grid is sqrt(2) away, which makes its spacing 0.89 and the reach 2.7.
    for (const auto& [height, is_out] : {std::pair{2.0, false}, std::pair{3.0, true}}) {
        Positions points;
        add_grid(points, 900, 30, 0.0);
        points.emplace_back(14.5, 14.5, height);
        const std::vector<char> out = outliers(points, 20);
        EXPECT_EQ(out.back() != 0, is_out) << height;
        EXPECT_EQ(std::count(out.begin(), out.end() - 1, 1), 0);
    }
}

}  // namespace
}  // namespace isograft
