// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/window.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "gate.h"
#include "geodesic/trace.h"
#include "isograft/errors.h"
#include "isograft/geodesic.h"
#include "shapes.h"

namespace isograft {
namespace {

double angle_between(double a, double b) { return std::abs(wrap_angle(a - b)); }

std::vector<shapes::Shape> planes() {
    auto jittered = shapes::noisy(shapes::grid(30, 30, 0.1, 0.1), 0.04, 3);
    jittered.vertices.col(2).setZero();
    return {shapes::grid(30, 30, 0.1, 0.1), shapes::grid(60, 60, 0.1, 0.1, 1.5), shapes::grid(60, 60, 0.1, 0.1, 3.0),
            shapes::grid(30, 400, 0.1, 0.0075), jittered};
}

TEST(Window, IsExactOnThePlaneWhateverTheTriangles) {
    for (const auto& shape : planes()) {
        const TriangleMesh mesh = shapes::mesh_of(shape);
        Window window(mesh);
        const Eigen::Vector3d middle = shape.vertices.colwise().mean();
        const SurfacePoint centre = shapes::point_nearest(mesh, middle + Eigen::Vector3d(0.013, 0.007, 0.0));
        const double radius = 0.8;
        window.run(centre, 1e9);
        int count = 0;
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            const Eigen::Vector3d way = mesh.position[v] - position(mesh, centre);
            if (way.norm() > radius) continue;
            ++count;
            ASSERT_TRUE(window.has(v));
            EXPECT_NEAR(window.distance(v), way.norm(), 1e-8);
            // The foot of a height is the square root of a difference: half the digits.
            EXPECT_LT(angle_between(window.angle(v), std::arg(flatten(mesh, centre.face, way))), 1e-6);
            EXPECT_FALSE(window.bent(v));
        }
        EXPECT_GT(count, 150);
        Random random(4);
        for (int i = 0; i < 200; ++i) {
            const Complex d = std::polar(radius * std::sqrt(random.uniform()), 2.0 * M_PI * random.uniform());
            const SurfacePoint x = trace(mesh, centre, d, std::abs(d)).end;
            const auto polar = window.query(x);
            ASSERT_TRUE(polar);
            EXPECT_NEAR(polar->distance, std::abs(d), 1e-6);
            EXPECT_LT(angle_between(polar->angle, std::arg(d)) * std::abs(d), 1e-6);
            const Eigen::Vector3d back = -lift(mesh, centre.face, d / std::abs(d));
            EXPECT_LT((lift(mesh, x.face, polar->back) - back).norm() * std::abs(d), 1e-5);
        }
    }
}

TEST(Window, NeedsAMeshWithPaths) {
    const TriangleMesh mesh = gate(shapes::blob(2)).mesh();
    EXPECT_THROW(Window{mesh}, std::logic_error);
}

// What lies beyond the radius may be on the way to a corner of an obtuse triangle within it: cut off, it is a detour.
TEST(Window, BoundedIsNeverTooShortAndHardlyTooLong) {
    // Right, 124 and 162 degrees, long right ones, irregular.
    const double limit[] = {1e-9, 5e-4, 2e-3, 1e-9, 5e-4};
    for (std::size_t i = 0; i < planes().size(); ++i) {
        const shapes::Shape shape = planes()[i];
        const TriangleMesh mesh = shapes::mesh_of(shape);
        Window window(mesh);
        const Eigen::Vector3d middle = shape.vertices.colwise().mean();
        const SurfacePoint centre = shapes::point_nearest(mesh, middle + Eigen::Vector3d(0.013, 0.007, 0.0));
        const double radius = 1.0;
        window.run(centre, radius);
        std::vector<double> error;
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            const double straight = (mesh.position[v] - position(mesh, centre)).norm();
            if (straight > 0.8 * radius) continue;
            ASSERT_TRUE(window.has(v));
            error.push_back(window.distance(v) / straight - 1.0);
            EXPECT_GT(error.back(), -1e-8);
            EXPECT_LT(error.back(), 0.01);
        }
        EXPECT_LT(shapes::mean(error), limit[i]) << "plane " << i;
    }
}

TEST(Window, IsExactOnADevelopableCylinder) {
    const int around = 48;
    const TriangleMesh mesh = shapes::mesh_of(shapes::cylinder(around, 40, 1.0, 6.0));
    const double side = 2.0 * std::sin(M_PI / around);
    const auto arc = [&](const Eigen::Vector3d& x) {
        const double step = 2.0 * M_PI / around;
        const double a = std::atan2(x.y(), x.x()) + (x.y() < -1e-12 ? 2.0 * M_PI : 0.0);
        const int i = static_cast<int>(a / step + 1e-9);
        return i * side + (x.head<2>() - Eigen::Vector2d(std::cos(i * step), std::sin(i * step))).norm();
    };
    Window window(mesh);
    const SurfacePoint centre = shapes::point_nearest(mesh, {0.9, 0.3, 3.02});
    const Eigen::Vector3d x = position(mesh, centre);
    const Eigen::Vector3d ring = Eigen::Vector3d::UnitZ().cross(mesh.normal[centre.face]);
    window.run(centre, 2.8);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        double across = arc(mesh.position[v]) - arc(x);
        across -= around * side * std::round(across / (around * side));
        const double along = mesh.position[v].z() - x.z();
        if (std::hypot(across, along) > 2.5) continue;
        EXPECT_NEAR(window.distance(v), std::hypot(across, along), 1e-8);
        const Eigen::Vector3d way = across * ring + along * Eigen::Vector3d::UnitZ();
        EXPECT_LT(angle_between(window.angle(v), std::arg(flatten(mesh, centre.face, way))), 1e-6);
    }
}

TEST(Window, IsExactOnAConeAlsoBehindItsTip) {
    const int around = 48, along = 24;
    for (const double angle : {2.0, 4.5}) {
        const TriangleMesh mesh = shapes::mesh_of(shapes::cone(around, along, angle));
        // Vertices sit on the sector's rays, the centre near the one of index 0.
        const SurfacePoint centre =
            shapes::point_nearest(mesh, 0.3 * mesh.position[12 * around + 1] + 0.7 * mesh.position[13 * around + 1]);
        const double slant = position(mesh, centre).norm();
        Window window(mesh);
        window.run(centre, 1.3);
        double worst = 0.0;
        for (int v = 1; v < mesh.vertex_count(); ++v) {
            const double turn = std::min((v - 1) % around, around - (v - 1) % around) * angle / around;
            const double s = mesh.position[v].norm();
            const double distance = std::sqrt(slant * slant + s * s - 2.0 * slant * s * std::cos(turn));
            if (distance < 1.1) worst = std::max(worst, std::abs(window.distance(v) - distance));
        }
        // The centre is an edge's inset off the ray.
        EXPECT_LT(worst, 1e-6) << angle;
    }
}

TEST(Window, ApproachesTheSphereInFirstOrder) {
    std::vector<double> distance_error, angle_error;
    for (const int levels : {3, 4, 5}) {
        const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(levels));
        Window window(mesh);
        Random random(5);
        std::vector<double> d, a;
        for (int i = 0; i < 30; ++i) {
            SurfacePoint centre;
            centre.face = random.below(mesh.face_count());
            window.run(centre, 1.0);
            const Eigen::Vector3d x = position(mesh, centre).normalized();
            for (const int v : window.reached()) {
                if (window.distance(v) > 1.0 || window.distance(v) < 0.2) continue;
                const Eigen::Vector3d y = mesh.position[v];
                const double exact = std::acos(std::min(1.0, x.dot(y)));
                d.push_back(std::abs(window.distance(v) - exact) / exact);
                a.push_back(angle_between(window.angle(v), std::arg(flatten(mesh, centre.face, y - y.dot(x) * x))));
            }
        }
        distance_error.push_back(shapes::mean(d));
        angle_error.push_back(shapes::mean(a));
    }
    EXPECT_LT(distance_error[0], 0.005);
    EXPECT_LT(angle_error[0], 0.01);
    for (const int i : {1, 2}) {
        EXPECT_LT(distance_error[i], 0.6 * distance_error[i - 1]);
        EXPECT_LT(angle_error[i], 0.6 * angle_error[i - 1]);
    }
}

TEST(Window, LeavesAndArrivesAlongThePathItsDistanceBelongsTo) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(5));
    Window window(mesh);
    Random random(6);
    std::vector<double> miss, turn;
    for (int i = 0; i < 60; ++i) {
        SurfacePoint centre;
        centre.face = random.below(mesh.face_count());
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const Trace t = trace(mesh, centre, d, 0.4);
        window.run(centre, 0.6);
        const auto polar = window.query(t.end);
        ASSERT_TRUE(polar);
        if (polar->distance < 0.39) continue;  // a shorter way round a bump
        miss.push_back(angle_between(polar->angle, std::arg(d)));
        turn.push_back(std::abs(polar->back + t.direction));
        EXPECT_LT(polar->distance, 0.4 * 1.01);
    }
    EXPECT_GT(miss.size(), 50U);
    EXPECT_LT(shapes::mean(miss), 0.02);
    EXPECT_LT(shapes::mean(turn), 0.05);
}

TEST(Window, MarksVerticesInTheShadowOfAHole) {
    const auto shape = shapes::cut(shapes::grid(40, 40, 0.1, 0.1), [](const Eigen::Vector3d& c) {
        return (c - Eigen::Vector3d(2.0, 2.0, 0.0)).norm() > 0.55;
    });
    const Surface surface = gate(shape);
    const TriangleMesh& mesh = surface.mesh_with_paths();
    const SurfacePoint centre = shapes::point_nearest(mesh, {0.933, 2.017, 0.0});
    Window window(mesh);
    window.run(centre, 2.5);
    int shaded = 0, lit = 0;
    std::vector<double> error;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const Eigen::Vector3d x = mesh.position[v];
        const double straight = (x - position(mesh, centre)).norm();
        if (straight > 2.0) continue;
        const Eigen::Vector3d ahead = (x - position(mesh, centre)).normalized();
        const Eigen::Vector3d hole = Eigen::Vector3d(2.0, 2.0, 0.0) - position(mesh, centre);
        const double aside = ahead.cross(hole).norm();
        if (straight > 1.7 && aside < 0.35) {
            ++shaded;
            EXPECT_TRUE(window.bent(v));
            EXPECT_GT(window.distance(v), straight * (1.0 + 1e-6));
        } else if (aside > 0.8 || ahead.dot(hole) < 0.0) {
            ++lit;
            EXPECT_FALSE(window.bent(v));
            error.push_back(window.distance(v) / straight - 1.0);
            EXPECT_GT(error.back(), -1e-8);
        }
    }
    // Beside the shadow an edge may have one end in it: the two ends then tell of different sources.
    EXPECT_LT(shapes::mean(error), 1e-4);
    EXPECT_GT(shaded, 10);
    EXPECT_GT(lit, 100);
}

TEST(Window, StaysOnItsSheet) {
    const auto sheet = shapes::grid(20, 20, 0.1, 0.1);
    const TriangleMesh mesh =
        shapes::mesh_of(shapes::joined(sheet, shapes::moved(sheet, Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.001})));
    Window window(mesh);
    window.run(shapes::point_nearest(mesh, {1.02, 1.01, 0.0}), 5.0);
    EXPECT_EQ(window.reached().size(), 441U);
    for (const int v : window.reached()) EXPECT_EQ(mesh.position[v].z(), 0.0);
    EXPECT_FALSE(window.query(shapes::point_nearest(mesh, {1.0, 1.0, 0.001})));
}

TEST(Window, IsTheSameAfterRigidMotionAndRenumbering) {
    const auto shape = shapes::blob(4);
    const auto other = shapes::renumbered(shape, 13);
    const Eigen::Matrix3d rotation = shapes::some_rotation();
    const TriangleMesh a = shapes::mesh_of(shape);
    const TriangleMesh b = shapes::mesh_of(shapes::moved(other.shape, rotation, {1.0, 2.0, 3.0}));
    Window window_a(a), window_b(b);
    Random random(8);
    for (int i = 0; i < 20; ++i) {
        SurfacePoint p;
        p.face = random.below(a.face_count());
        const SurfacePoint q = shapes::same_point(other, p);
        window_a.run(p, 0.7);
        window_b.run(q, 0.7);
        const Complex turn = flatten(b, q.face, rotation * a.axis_x[p.face]);
        for (const int v : window_a.reached()) {
            if (window_a.distance(v) > 0.65) continue;
            const int w = other.vertex[v];
            ASSERT_TRUE(window_b.has(w));
            EXPECT_NEAR(window_b.distance(w), window_a.distance(v), 1e-9);
            EXPECT_LT(std::abs(std::polar(1.0, window_b.angle(w)) - turn * std::polar(1.0, window_a.angle(v))), 1e-9);
        }
    }
}

TEST(Window, ForgetsTheRunBefore) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    Window used(mesh), fresh(mesh);
    SurfacePoint p, q;
    p.face = 17;
    q.face = 900;
    used.run(p, 1.5);
    used.run(q, 0.5);
    fresh.run(q, 0.5);
    EXPECT_EQ(used.reached(), fresh.reached());
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        ASSERT_EQ(used.has(v), fresh.has(v));
        if (!fresh.has(v)) continue;
        EXPECT_EQ(used.distance(v), fresh.distance(v));
        EXPECT_EQ(used.angle(v), fresh.angle(v));
    }
}

TEST(GeodesicDistances, AreInfiniteWhereNoPathLeadsAndReachWeldedVertices) {
    const auto sheet = shapes::grid(6, 6, 0.5, 0.5);
    auto shape = shapes::joined(shapes::soup(sheet), shapes::moved(sheet, Eigen::Matrix3d::Identity(), {0, 0, 9}));
    const Eigen::Index n = shape.vertices.rows();
    shape.vertices.conservativeResize(n + 1, 3);
    shape.vertices.row(n).setZero();
    const Surface surface = gate(shape);
    const Eigen::VectorXd d = geodesic_distances(surface, 30, {0.2, 0.3, 0.5});
    ASSERT_EQ(d.size(), n + 1);
    Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) x += Eigen::RowVector3d(0.2, 0.3, 0.5)[k] * shape.vertices.row(shape.faces(30, k));
    for (Eigen::Index v = 0; v < n + 1; ++v) {
        if (v < 3 * sheet.faces.rows()) {
            EXPECT_NEAR(d[v], (shape.vertices.row(v) - x).norm(), 1e-6);
        } else {
            EXPECT_TRUE(std::isinf(d[v]));
        }
    }
}

TEST(GeodesicDistances, TakeTheInputsCornersOfTurnedTriangles) {
    auto shape = shapes::grid(6, 6, 0.5, 0.5);
    shape.faces.row(30).reverseInPlace();
    const Surface surface = gate(shape);
    const Eigen::VectorXd d = geodesic_distances(surface, 30, {0.0, 1.0, 0.0});
    EXPECT_NEAR(d[shape.faces(30, 1)], 0.0, 1e-6);
    EXPECT_NEAR(d[shape.faces(30, 0)],
                (shape.vertices.row(shape.faces(30, 0)) - shape.vertices.row(shape.faces(30, 1))).norm(), 1e-6);
}

TEST(GeodesicDistances, AreTheSameWithinARadiusAndInfiniteBeyond) {
    const Surface surface = gate(shapes::grid(20, 20, 0.5, 0.5));
    const Eigen::VectorXd whole = geodesic_distances(surface, 400, {0.2, 0.3, 0.5});
    const Eigen::VectorXd part = geodesic_distances(surface, 400, {0.2, 0.3, 0.5}, 3.0);
    int near = 0;
    for (Eigen::Index v = 0; v < whole.size(); ++v) {
        if (whole[v] > 3.0) {
            EXPECT_TRUE(std::isinf(part[v]));
        } else if (whole[v] <= 2.7) {
            EXPECT_NEAR(part[v], whole[v], 1e-9);
            ++near;
        }
    }
    EXPECT_GT(near, 50);
}

TEST(GeodesicDistances, RefuseARadiusThatIsNotPositive) {
    const Surface surface = gate(shapes::grid(2, 2, 0.5, 0.5));
    for (const double radius : {0.0, -1.0, std::nan("")}) {
        EXPECT_THROW(geodesic_distances(surface, 0, {1, 0, 0}, radius), InvalidInput);
    }
}

TEST(GeodesicDistances, RefuseATriangleThatIsNotThere) {
    auto shape = shapes::grid(2, 2, 0.5, 0.5);
    shape.faces.row(3) << 1, 1, 2;
    const Surface surface = gate(shape);
    for (const int face : {-1, 8, 3}) EXPECT_THROW(geodesic_distances(surface, face, {1, 0, 0}), InvalidInput);
}

}  // namespace
}  // namespace isograft
