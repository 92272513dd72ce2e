// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/rigid_step.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

TEST(RigidStep, FindsTheMotionOfATrueMap) {
    const Samples& source = twins().pair().source.samples;
    const std::vector<int> some{3, 20, 41, 77, 90};
    const PartialMap map = twins().true_map(some);
    const RigidMotion motion = motion_of(map, source, some, {1.0, 0.5, 2.0, 1.0, 1.0});
    // Images lie on T's triangles, which stand in for the same surface.
    for (const int s : twins().all_samples()) EXPECT_LT(twins().error(s, motion(source.position[s])), 0.02);
}

TEST(RigidStep, StepsLayAnEllipsoidOnItself) {
    // Exact normals and heights to first order; what is left shrinks with every step.
    const Eigen::Vector3d axes(1.0, 0.7, 0.5);
    std::vector<Eigen::Vector3d> points;
    for (int i = 1; i < 12; ++i) {
        for (int j = 0; j < 16; ++j) {
            const double polar = M_PI * i / 12.0, azimuth = M_PI * j / 8.0;
            points.emplace_back(axes.x() * std::sin(polar) * std::cos(azimuth),
                                axes.y() * std::sin(polar) * std::sin(azimuth), axes.z() * std::cos(polar));
        }
    }
    RigidMotion motion;
    motion.turn = Eigen::AngleAxisd(0.2, Eigen::Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
    motion.shift = Eigen::Vector3d(0.05, -0.04, 0.03);
    double left = 0.0;
    for (int k = 0; k < 12; ++k) {
        RigidStep step(motion(Eigen::Vector3d(0.2, 0.1, 0.0)), 0.5);
        for (const Eigen::Vector3d& p : points) {
            const Eigen::Vector3d x = motion(p);
            const Eigen::Vector3d gradient = 2.0 * x.cwiseQuotient(axes.cwiseProduct(axes));
            const double value = x.cwiseQuotient(axes).squaredNorm() - 1.0;
            step.add(x, gradient.normalized(), -value / gradient.norm(), 1.0);
        }
        EXPECT_EQ(step.points(), static_cast<int>(points.size()));
        if (k > 0) {
            EXPECT_LT(step.mean_square(), left);
        }
        left = step.mean_square();
        ASSERT_TRUE(step.apply(motion));
    }
    EXPECT_LT(std::sqrt(left), 1e-3);
    EXPECT_LT((motion.turn - Eigen::Matrix3d::Identity()).norm(), 0.02);
    EXPECT_LT(motion.shift.norm(), 0.01);
}

TEST(RigidStep, AStepThatTurnsTooFarMovesNothing) {
    RigidMotion motion;
    RigidStep step(Eigen::Vector3d::Zero(), 1.0);
    for (const double x : {-1.0, -0.5, 0.5, 1.0}) {
        for (const double y : {-1.0, 1.0}) step.add({x, y, 0.0}, Eigen::Vector3d::UnitZ(), 2.0 * x, 1.0);
    }
    EXPECT_FALSE(step.apply(motion));
    EXPECT_EQ(motion.turn, Eigen::Matrix3d::Identity());
    EXPECT_EQ(motion.shift, Eigen::Vector3d::Zero());
}

TEST(RigidStep, SamplesAroundAreConnectedNearAndWanted) {
    const Samples& source = twins().pair().source.samples;
    const double reach = 3.0 * source.spacing;
    const std::vector<int> all = samples_around(source, 5, reach, [](int /*s*/) { return true; });
    EXPECT_EQ(all.front(), 5);
    EXPECT_GT(all.size(), 8U);
    for (const int s : all) EXPECT_LE((source.position[s] - source.position[5]).norm(), reach);
    const std::vector<int> even = samples_around(source, 5, reach, [](int s) { return s % 2 == 0; });
    EXPECT_LT(even.size(), all.size());
    EXPECT_TRUE(std::all_of(even.begin() + 1, even.end(), [](int s) { return s % 2 == 0; }));
    EXPECT_EQ(samples_around(source, 5, reach, [](int /*s*/) { return false; }), std::vector<int>{5});
}

TEST(RigidStep, SpreadsVerticesOverTheirSamples) {
    const std::vector<std::vector<int>> vertices = vertices_of(twins().pair().source);
    std::size_t all = 0;
    for (const int s : twins().all_samples()) all += vertices[s].size();
    EXPECT_EQ(static_cast<int>(all), twins().pair().source.mesh.vertex_count());
    int taken = 0;
    std::vector<char> heard(vertices.size(), 0);
    spread_vertices(vertices, twins().all_samples(), 0.5 * static_cast<double>(all), [&](std::size_t i, int v) {
        EXPECT_NE(std::find(vertices[i].begin(), vertices[i].end(), v), vertices[i].end());
        heard[i] = 1;
        ++taken;
    });
    EXPECT_NEAR(taken, 0.5 * static_cast<double>(all), 1.0);
    EXPECT_GT(std::count(heard.begin(), heard.end(), 1), 0.9 * static_cast<double>(heard.size()));
    spread_vertices(vertices, {0}, 1e6, [&](std::size_t /*i*/, int /*v*/) { --taken; });
    EXPECT_NEAR(taken, 0.5 * static_cast<double>(all) - static_cast<double>(vertices[0].size()), 1.0);
}

}  // namespace
}  // namespace isograft
