// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/regions.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer/vertex_graph.h"

namespace isograft {

TEST(VertexGraph, SpreadsVerticesOutSoThatNoneIsNearAnotherAndAllAreNearOne) {
    // A ladder: along its rails the distance between two vertices is that of their places.
    const shapes::Shape ladder = shapes::grid(40, 1, 1.0, 10.0);
    Monitor monitor;
    const std::vector<int> chosen = VertexGraph(ladder.vertices, ladder.faces).spread_out(3.5, monitor);
    const auto distance = [&](int a, int b) { return (ladder.vertices.row(a) - ladder.vertices.row(b)).norm(); };
    for (int v = 0; v < ladder.vertices.rows(); ++v) {
        int near = 0;
        for (const int seed : chosen) near += static_cast<int>(distance(v, seed) <= 3.5);
        EXPECT_GE(near, 1) << "vertex " << v;
    }
    for (const int a : chosen) {
        for (const int b : chosen) EXPECT_TRUE(a == b || distance(a, b) > 3.5) << a << " and " << b;
    }
}

TEST(Regions, HoldEveryVertexAndTheWholeArea) {
    const shapes::Shape one = shapes::sphere(3);
    const shapes::Shape two = shapes::joined(one, shapes::moved(one, Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.1}));
    Monitor monitor;
    const Regions regions(two.vertices, two.faces, 0.3, monitor);
    EXPECT_GE(regions.of.minCoeff(), 0);
    EXPECT_NEAR(regions.area.sum(), 2.0 * 4.0 * M_PI, 0.02 * 8.0 * M_PI);
    // What does not touch is in no common region, and no heat flows between it.
    const Eigen::Index half = one.vertices.rows();
    EXPECT_LT(regions.of.head(half).maxCoeff(), regions.of.tail(half).minCoeff());
    const int first = regions.of.tail(half).minCoeff();
    EXPECT_EQ(Eigen::MatrixXd(regions.stiffness).topRightCorner(first, regions.count() - first).norm(), 0.0);
}

TEST(Regions, ConductHeatAsThePlaneDoes) {
    // The energy of a linear function with slope 1 is the area; constants have none. Pieces lie in rows, along which
    // the energy is as much too high as it is too low across them.
    const shapes::Shape plane = shapes::grid(60, 50, 0.1, 0.1, 0.3);
    Monitor monitor;
    const Regions regions(plane.vertices, plane.faces, 0.35, monitor);
    EXPECT_LE((regions.stiffness * Eigen::VectorXd::Ones(regions.count())).cwiseAbs().maxCoeff(), 1e-9);
    const Eigen::Vector3d energy = (regions.centre.transpose() * (regions.stiffness * regions.centre)).diagonal();
    EXPECT_NEAR(energy.sum() / regions.area.sum(), 2.0, 0.1);
}

TEST(Regions, StopWhenCancelled) {
    const shapes::Shape shape = shapes::sphere(3);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(Regions(shape.vertices, shape.faces, 0.3, monitor), Cancelled);
}

}  // namespace isograft
