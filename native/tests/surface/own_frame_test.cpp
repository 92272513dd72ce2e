// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/own_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

TriangleMesh in_own_frame(const shapes::Shape& shape) {
    Monitor monitor;
    return isograft::in_own_frame(gate(shape).mesh(), monitor);
}

Eigen::Matrix3d turn_by(double angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

void expect_one_place(const TriangleMesh& a, const TriangleMesh& b) {
    ASSERT_EQ(a.vertex_count(), b.vertex_count());
    int moved = 0;
    for (int v = 0; v < a.vertex_count(); ++v) moved += a.position[v] != b.position[v];
    EXPECT_EQ(moved, 0);
    EXPECT_EQ(a.face, b.face);
    EXPECT_EQ(a.twin, b.twin);
    EXPECT_EQ(a.vertex_face, b.vertex_face);
    EXPECT_EQ(a.component, b.component);
    EXPECT_EQ(a.corner, b.corner);
}

/// A body with a plane of symmetry, unlike above and below, before and behind.
shapes::Shape two_sided() {
    shapes::Shape shape = shapes::sphere(3);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        auto x = shape.vertices.row(v);
        x = Eigen::RowVector3d(x[0] * (1.0 + 0.2 * x[2]), 1.7 * x[1],
                               2.4 * x[2] + 0.5 * x[0] * x[0] * x[2] + 0.2 * x[0]);
    }
    return shape;
}

/// A corner of a sheet, longer one way.
shapes::Shape sheet() {
    shapes::Shape shape =
        shapes::cut(shapes::grid(20, 14, 0.1, 0.1), [](const Eigen::Vector3d& x) { return x[0] + 1.3 * x[1] < 1.7; });
    return shape;
}

TEST(OwnFrame, UndoesEveryMotionToTheLastBit) {
    for (const shapes::Shape& shape : {shapes::blob(4), two_sided(), sheet()}) {
        const TriangleMesh here = in_own_frame(shape);
        const Eigen::Vector3d shifts[] = {{0.0, 0.0, 0.0}, {4.0, -3.0, 2.0}, {-0.3, 11.0, 7.0}};
        const Eigen::Matrix3d turns[] = {shapes::some_rotation(), turn_by(M_PI, {0.0, 0.0, 1.0}),
                                         turn_by(2.5, {1.0, -2.0, 0.4})};
        for (int k = 0; k < 3; ++k) expect_one_place(here, in_own_frame(shapes::moved(shape, turns[k], shifts[k])));
    }
}

/// Two bodies with one vertex in common, which the gate splits.
shapes::Shape touching() {
    const shapes::Shape a = shapes::blob(3);
    const Eigen::Index first = a.vertices.rows();
    Eigen::Index tip = 0;
    a.vertices.col(0).maxCoeff(&tip);
    shapes::Shape b = shapes::blob(2);
    b.vertices.rowwise() += a.vertices.row(tip) - b.vertices.row(0);
    shapes::Shape both = shapes::joined(a, b);
    for (Eigen::Index f = 0; f < both.faces.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            if (both.faces(f, k) == first) both.faces(f, k) = static_cast<int>(tip);
        }
    }
    return both;
}

TEST(OwnFrame, UndoesEveryRenumberingToTheLastBit) {
    const shapes::Shape pieces =
        shapes::joined(shapes::blob(3), shapes::moved(shapes::blob(2), turn_by(1.0, {1, 0, 0}), {0.7, 3.0, 0.2}));
    for (const shapes::Shape& shape : {shapes::blob(4), two_sided(), sheet(), pieces, touching()}) {
        const TriangleMesh here = in_own_frame(shape);
        for (const int seed : {3, 4, 5}) {
            const auto other = shapes::renumbered(shape, seed);
            const TriangleMesh there = in_own_frame(other.shape);
            expect_one_place(here, there);
            for (int v = 0; v < here.vertex_count(); ++v) {
                EXPECT_EQ(there.input_vertex[v], other.vertex[here.input_vertex[v]]);
            }
            for (int f = 0; f < here.face_count(); ++f) EXPECT_EQ(there.input_face[f], other.face[here.input_face[f]]);
        }
    }
}

TEST(OwnFrame, KeepsEveryTrianglesCornersAndSide) {
    // Some triangles are wound against the others, which the gate turns.
    shapes::Shape shape = shapes::blob(4);
    for (const int f : {5, 70, 71, 900}) std::swap(shape.faces(f, 0), shape.faces(f, 1));
    const Surface surface = gate(shape);
    Monitor monitor;
    const TriangleMesh &before = surface.mesh(), after = isograft::in_own_frame(before, monitor);
    expect_manifold(after);
    EXPECT_EQ(after.component_count, before.component_count);
    ASSERT_EQ(after.face_count(), before.face_count());
    for (int f = 0; f < after.face_count(); ++f) {
        const int input = after.input_face[f];
        ASSERT_EQ(before.input_face[input], input);
        for (int k = 0; k < 3; ++k) {
            const int corner = after.input_corner(f, k);
            EXPECT_EQ(after.input_vertex[after.face[f][k]], shape.faces(input, corner));
            int same = 0;
            while (before.input_corner(input, same) != corner) ++same;
            EXPECT_NEAR(std::abs(after.edge(3 * f + k)), std::abs(before.edge(3 * input + same)), 1e-6);
        }
    }
    EXPECT_NEAR(volume(before), volume(after), 1e-5);
}

TEST(OwnFrame, NumbersFromOneEndToTheOther) {
    const TriangleMesh mesh = in_own_frame(shapes::renumbered(two_sided(), 9).shape);
    for (int v = 1; v < mesh.vertex_count(); ++v) EXPECT_LE(mesh.position[v - 1].z(), mesh.position[v].z());
    for (int f = 0; f < mesh.face_count(); ++f) {
        EXPECT_EQ(mesh.face[f][0], *std::min_element(mesh.face[f].begin(), mesh.face[f].end()));
        if (f > 0) {
            EXPECT_LT(mesh.face[f - 1], mesh.face[f]);
        }
    }
}

TEST(OwnFrame, PutsTheCentreInTheMiddleAndTheLongestAxisLast) {
    const TriangleMesh mesh = in_own_frame(shapes::moved(two_sided(), shapes::some_rotation(), {1.0, 2.0, 3.0}));
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), spread = Eigen::Vector3d::Zero();
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        centre += mesh.vertex_area[v] / mesh.area * mesh.position[v];
        spread += mesh.vertex_area[v] / mesh.area * mesh.position[v].cwiseAbs2();
    }
    EXPECT_LT(centre.norm(), 1e-6);
    EXPECT_LT(spread[0], spread[1]);
    EXPECT_LT(spread[1], spread[2]);
}

TEST(OwnFrame, SqueezesNoThinTriangle) {
    // Strips of a billionth of the sheet's size: far thinner than what the other vertices are rounded to.
    shapes::Shape shape = sheet();
    const Eigen::Index first = shape.vertices.rows();
    shapes::Shape needles = shapes::grid(20, 1, 0.1, 2e-9);
    needles.vertices.col(2).array() += 0.5;
    shape = shapes::moved(shapes::joined(shape, needles), shapes::some_rotation(), {0.0, 0.0, 0.0});
    const Surface surface = gate(shape);
    Monitor monitor;
    const TriangleMesh after = isograft::in_own_frame(surface.mesh(), monitor);
    int thin = 0;
    for (int f = 0; f < after.face_count(); ++f) {
        const int input = after.input_face[f];
        const double before = cross(surface.mesh().corner[input][1], surface.mesh().corner[input][2]);
        const double now = cross(after.corner[f][1], after.corner[f][2]);
        EXPECT_NEAR(now / before, 1.0, 0.05);
        thin += shape.faces(input, 0) >= first;
    }
    EXPECT_EQ(thin, 40);
}

TEST(OwnFrame, StopsWhenCancelled) {
    Monitor monitor;
    const Surface surface = gate(shapes::blob(3));
    monitor.cancel();
    EXPECT_THROW(isograft::in_own_frame(surface.mesh(), monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
