// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/trace.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"
#include "surface/edges.h"

namespace isograft {
namespace {

// Points are kept off the edges by 1e-7 of a triangle.
constexpr double inset = 2e-7;

SurfacePoint random_point(const TriangleMesh& mesh, Random& random) {
    SurfacePoint p;
    p.face = random.below(mesh.face_count());
    const double a = 0.1 + random.uniform(), b = 0.1 + random.uniform(), c = 0.1 + random.uniform();
    p.weight = {a / (a + b + c), b / (a + b + c), c / (a + b + c)};
    return p;
}

TEST(Trace, IsStraightOnThePlaneWhateverTheTriangles) {
    for (const auto& shape :
         {shapes::grid(30, 30, 0.1, 0.1), shapes::grid(30, 30, 0.1, 0.1, 1.5), shapes::grid(30, 200, 0.1, 0.015)}) {
        const TriangleMesh mesh = shapes::mesh_of(shape);
        Random random(1);
        const Eigen::Vector3d middle = shape.vertices.colwise().mean();
        const SurfacePoint start = shapes::point_nearest(mesh, middle);
        for (int i = 0; i < 60; ++i) {
            const double angle = 2.0 * M_PI * random.uniform();
            const double length = 0.8 * random.uniform();
            const Complex d = std::polar(1.0, angle);
            const Eigen::Vector3d way = lift(mesh, start.face, d);
            const Trace t = trace(mesh, start, d, length);
            ASSERT_TRUE(t.complete);
            EXPECT_DOUBLE_EQ(t.length, length);
            EXPECT_LT((position(mesh, t.end) - position(mesh, start) - length * way).norm(), inset);
            EXPECT_LT((lift(mesh, t.end.face, t.direction) - way).norm(), 1e-12);
        }
    }
}

// A line of the grid: every vertex on it is met head on, or the path runs along the edges.
TEST(Trace, RunsThroughVerticesAndAlongEdges) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(30, 30, 0.1, 0.1));
    for (int f = 0; f < mesh.face_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            SurfacePoint corner;
            corner.face = f;
            corner.weight = {0.0, 0.0, 0.0};
            corner.weight[k] = 1.0;
            const Eigen::Vector3d from = position(mesh, corner);
            if ((from - Eigen::Vector3d(1.5, 1.5, 0.0)).lpNorm<Eigen::Infinity>() > 0.41) continue;
            for (int turn = 0; turn < 8; ++turn) {
                const Eigen::Vector3d way(std::cos(M_PI_4 * turn), std::sin(M_PI_4 * turn), 0.0);
                const Trace t = trace(mesh, corner, flatten(mesh, f, way), 0.93);
                ASSERT_TRUE(t.complete) << f << " " << k << " " << turn;
                EXPECT_LT((position(mesh, t.end) - from - 0.93 * way).norm(), inset);
                EXPECT_LT((lift(mesh, t.end.face, t.direction) - way).norm(), 1e-12);
            }
        }
    }
}

// Needles a thousandth as wide as long, crossed from end to end: rounding in one is not scaled up by the next.
TEST(Trace, IsStraightThroughNeedles) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(12, 600, 1.0, 0.001));
    Random random(4);
    const Eigen::Vector3d middle(6.3, 0.3, 0.0);
    const SurfacePoint start = shapes::point_nearest(mesh, middle);
    for (int i = 0; i < 60; ++i) {
        const Complex d = std::polar(1.0, 0.02 * (random.uniform() - 0.5) + (i % 2) * M_PI);
        const Eigen::Vector3d way = lift(mesh, start.face, d);
        const Trace t = trace(mesh, start, d, 5.0);
        ASSERT_TRUE(t.complete);
        EXPECT_LT((position(mesh, t.end) - position(mesh, start) - 5.0 * way).norm(), 5e-7);
        EXPECT_LT((lift(mesh, t.end.face, t.direction) - way).norm(), 1e-11);
    }
}

TEST(Trace, GoesTheSameWayOnAScaledMesh) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    const TriangleMesh larger = scaled(mesh, 4.0);
    Random random(6);
    for (int i = 0; i < 100; ++i) {
        const SurfacePoint start = random_point(mesh, random);
        const Complex d = std::polar(1.0, 6.0 * random.uniform());
        const Trace a = trace(mesh, start, d, 1.2), b = trace(larger, start, d, 4.8);
        EXPECT_EQ(a.end.face, b.end.face);
        EXPECT_LT((4.0 * position(mesh, a.end) - position(larger, b.end)).norm(), 1e-12);
    }
}

TEST(Trace, EndsAtTheBoundaryWithTheLengthWalked) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(10, 10, 0.1, 0.1));
    const SurfacePoint start = shapes::point_nearest(mesh, {0.53, 0.47, 0.0});
    const Complex right = flatten(mesh, start.face, Eigen::Vector3d(0.8, 0.6, 0.0));
    const Trace t = trace(mesh, start, right, 5.0);
    EXPECT_FALSE(t.complete);
    EXPECT_NEAR(t.length, 0.47 / 0.8, inset);
    EXPECT_LT((position(mesh, t.end) - Eigen::Vector3d(1.0, 0.47 + 0.47 * 0.75, 0.0)).norm(), inset);
}

TEST(Trace, GoesNowhereForLengthZero) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(1));
    SurfacePoint start;
    start.face = 5;
    const Trace t = trace(mesh, start, Complex(0.3, 0.4), 0.0);
    EXPECT_TRUE(t.complete);
    EXPECT_EQ(t.end.face, 5);
    EXPECT_LT((position(mesh, t.end) - position(mesh, start)).norm(), 1e-12);
}

// Arc along the polygon of a cylinder's cross section, which is what unrolls to a straight line.
double polygon_arc(const Eigen::Vector3d& x, int around) {
    const double step = 2.0 * M_PI / around;
    double a = std::atan2(x.y(), x.x());
    if (a < 0.0) a += 2.0 * M_PI;
    const int i = static_cast<int>(a / step);
    const Eigen::Vector2d corner(std::cos(i * step), std::sin(i * step));
    return i * 2.0 * std::sin(0.5 * step) + (x.head<2>() - corner).norm();
}

TEST(Trace, IsAHelixOnACylinder) {
    const int around = 36;
    const TriangleMesh mesh = shapes::mesh_of(shapes::cylinder(around, 60, 1.0, 12.0));
    const double circumference = around * 2.0 * std::sin(M_PI / around);
    const SurfacePoint start = shapes::point_nearest(mesh, {0.9, 0.35, 1.0});
    const Eigen::Vector3d x = position(mesh, start);
    for (const double slope : {0.05, 0.2, 0.7, 1.4}) {
        const Eigen::Vector3d ring = Eigen::Vector3d::UnitZ().cross(mesh.normal[start.face]);
        const Eigen::Vector3d way = std::cos(slope) * ring + std::sin(slope) * Eigen::Vector3d::UnitZ();
        const double length = 10.0;
        const Trace t = trace(mesh, start, flatten(mesh, start.face, way), length);
        ASSERT_TRUE(t.complete);
        const Eigen::Vector3d y = position(mesh, t.end);
        EXPECT_NEAR(y.z(), x.z() + length * std::sin(slope), 1e-6);
        const double turns =
            (polygon_arc(x, around) + length * std::cos(slope) - polygon_arc(y, around)) / circumference;
        EXPECT_NEAR(turns, std::round(turns), 1e-6);
        EXPECT_NEAR(lift(mesh, t.end.face, t.direction).z(), std::sin(slope), 1e-12);
    }
}

TEST(Trace, ApproachesGreatCirclesOnTheSphere) {
    std::vector<double> error;
    for (const int levels : {3, 4, 5}) {
        const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(levels));
        Random random(7);
        std::vector<double> miss;
        for (int i = 0; i < 200; ++i) {
            const SurfacePoint start = random_point(mesh, random);
            const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
            const Eigen::Vector3d x = position(mesh, start).normalized();
            const Eigen::Vector3d raw = lift(mesh, start.face, d);
            const Eigen::Vector3d way = (raw - raw.dot(x) * x).normalized();
            const Trace t = trace(mesh, start, d, 1.5);
            miss.push_back((position(mesh, t.end).normalized() - std::cos(1.5) * x - std::sin(1.5) * way).norm());
        }
        error.push_back(shapes::mean(miss));
    }
    // The polyhedron's bumps of curvature make the direction wander by less the finer it is.
    EXPECT_LT(error[0], 0.02);
    EXPECT_LT(error[1], 0.6 * error[0]);
    EXPECT_LT(error[2], 0.6 * error[1]);
}

TEST(Trace, LeadsBackTheWayItCame) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const SurfacePoint start = random_point(mesh, random);
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const Trace there = trace(mesh, start, d, 0.8);
        const Trace back = trace(mesh, there.end, -there.direction, 0.8);
        EXPECT_LT((position(mesh, back.end) - position(mesh, start)).norm(), 1e-5);
        EXPECT_LT((lift(mesh, back.end.face, back.direction) + lift(mesh, start.face, d)).norm(), 1e-4);
    }
}

TEST(Trace, IsTheSameAfterRigidMotionAndRenumbering) {
    const auto shape = shapes::blob(4);
    const auto other = shapes::renumbered(shape, 11);
    const Eigen::Matrix3d rotation = shapes::some_rotation();
    const Eigen::Vector3d shift(3.0, -4.0, 5.0);
    const TriangleMesh a = shapes::mesh_of(shape);
    const TriangleMesh b = shapes::mesh_of(shapes::moved(other.shape, rotation, shift));
    Random random(3);
    for (int i = 0; i < 100; ++i) {
        const SurfacePoint p = random_point(a, random), q = shapes::same_point(other, p);
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const Trace s = trace(a, p, d, 1.0);
        const Trace t = trace(b, q, flatten(b, q.face, rotation * lift(a, p.face, d)), 1.0);
        // A little noise in the start is stretched along the way by the curvature it passes.
        EXPECT_LT((rotation * position(a, s.end) + shift - position(b, t.end)).norm(), 1e-9);
        EXPECT_LT((rotation * lift(a, s.end.face, s.direction) - lift(b, t.end.face, t.direction)).norm(), 1e-9);
    }
}

TEST(Transport, AroundAVertexTurnsByItsAngleDefect) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        double angles = 0.0;
        Complex turn(1.0, 0.0);
        const int f = mesh.vertex_face[mesh.vertex_face_begin[v]];
        const int first = 3 * f + (mesh.face[f][0] == v ? 0 : mesh.face[f][1] == v ? 1 : 2);
        int h = first;
        do {
            ASSERT_EQ(mesh.from(h), v);
            const int last = following(following(h));
            angles += std::arg(-mesh.direction[last] * std::conj(mesh.direction[h]));
            // From the half-edge's frame to that of the next one around the vertex, as a path is carried.
            turn *= std::conj(unit(mesh.view[h].apex));
            h = mesh.view[h].beyond[1];
        } while (h != first);
        EXPECT_LT(std::abs(turn - std::polar(1.0, 2.0 * M_PI - angles)), 1e-12);
    }
}

TEST(Transport, AroundTheTipOfAConeTurnsByWhatTheSectorLacks) {
    for (const double angle : {1.8, 3.0, 5.5}) {
        const int around = 48;
        const TriangleMesh mesh = shapes::mesh_of(shapes::cone(around, 12, angle));
        // Straight legs around the tip: the direction turns at the corners only, by `corners` in all.
        SurfacePoint p = shapes::point_nearest(mesh, 0.5 * (mesh.position[400] + mesh.position[401]));
        const SurfacePoint start = p;
        const int legs = 6;
        const double slant = position(mesh, p).norm();
        const double leg = 2.0 * slant * std::sin(0.5 * angle / legs);
        const double turn = angle / legs;  // exterior angle of the regular polygon in the unrolled sector
        const Eigen::Vector3d inward = -position(mesh, p).normalized();
        Complex d = flatten(mesh, p.face, inward) * std::polar(1.0, -(0.5 * M_PI - 0.5 * angle / legs));
        const Eigen::Vector3d first = lift(mesh, p.face, d);
        for (int i = 0; i < legs; ++i) {
            const Trace t = trace(mesh, p, d, leg);
            ASSERT_TRUE(t.complete);
            p = t.end;
            d = t.direction * std::polar(1.0, turn);
        }
        EXPECT_LT((position(mesh, p) - position(mesh, start)).norm(), 1e-5);
        // Turned by `angle` at the corners and by 2 pi - angle by the curvature inside: once around.
        EXPECT_LT((lift(mesh, p.face, d) - first).norm(), 1e-5);
    }
}

TEST(WalkedTo, IsThePointUnderOneNearTheSurface) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(8, 8, 0.25, 0.25));
    const SurfacePoint start = shapes::point_nearest(mesh, {0.3, 0.4, 0.0});
    const Eigen::Vector3d above(1.2, 0.9, 0.05);
    EXPECT_LT((position(mesh, walked_to(mesh, start, above)) - Eigen::Vector3d(1.2, 0.9, 0.0)).norm(), 1e-6);
    EXPECT_LT((position(mesh, walked_to(mesh, start, position(mesh, start))) - position(mesh, start)).norm(), 1e-12);
    // Not across the boundary: along the straight way to it.
    const Eigen::Vector3d end = position(mesh, walked_to(mesh, start, {-0.3, 0.4, 0.0}));
    EXPECT_LT((end - Eigen::Vector3d(0.0, 0.4, 0.0)).norm(), 1e-5);
}

}  // namespace
}  // namespace isograft
