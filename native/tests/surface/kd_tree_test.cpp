// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/kd_tree.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "base/random.h"

namespace isograft {
namespace {

std::vector<Eigen::Vector3d> scattered(int count) {
    Random random(1);
    std::vector<Eigen::Vector3d> points(count);
    for (auto& p : points) p = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
    points[count / 2] = points[count / 3];
    return points;
}

std::vector<int> sorted_by_distance(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& x) {
    std::vector<int> order(points.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return (points[a] - x).squaredNorm() < (points[b] - x).squaredNorm(); });
    return order;
}

TEST(KdTree, FindsWhatLookingAtAllPointsFinds) {
    const auto points = scattered(300);
    const KdTree tree(points);
    std::vector<KdTree::Found> found;
    for (int i = 0; i < 50; ++i) {
        const Eigen::Vector3d x = points[i] + Eigen::Vector3d(0.01, -0.02, 0.005);
        const std::vector<int> expected = sorted_by_distance(points, x);
        tree.nearest(x, 9, found);
        ASSERT_EQ(found.size(), 9U);
        for (int k = 0; k < 9; ++k) EXPECT_EQ(found[k].index, expected[k]);
        const double radius = 0.2;
        tree.within(x, radius, found);
        std::size_t inside = 0;
        for (const auto& p : points) inside += (p - x).norm() <= radius;
        ASSERT_EQ(found.size(), inside);
        for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k].index, expected[k]);
    }
}

TEST(KdTree, GivesAllPointsWhereFewerAreThereThanAskedFor) {
    const KdTree tree(scattered(6));
    std::vector<KdTree::Found> found;
    tree.nearest({0.5, 0.5, 0.5}, 100, found);
    EXPECT_EQ(found.size(), 6U);
}

}  // namespace
}  // namespace isograft
