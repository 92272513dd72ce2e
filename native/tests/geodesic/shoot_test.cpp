// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/shoot.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geodesic/window.h"
#include "shapes.h"

namespace isograft {
namespace {

constexpr ShootOptions sharp{.max_traces = 30, .tolerance = 1e-9};

TEST(Shoot, FindsTheTraceAgainFromAPoorGuess) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(5));
    Random random(1);
    int found = 0;
    for (int i = 0; i < 100; ++i) {
        SurfacePoint start;
        start.face = random.below(mesh.face_count());
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const double length = 0.1 + 0.3 * random.uniform();
        const Trace t = trace(mesh, start, d, length);
        const double aside = 0.2 * (random.uniform() - 0.5);
        const auto shot = shoot(mesh, start, t.end, d * std::polar(2.0, aside), length * (1.0 + aside), sharp);
        if (!shot) continue;
        ++found;
        // A triangle or two of discrete curvature may lie between two straightest paths of the same ends.
        EXPECT_NEAR(shot->length, length, 2e-3 * length);
        EXPECT_LT(std::abs(shot->departure - d), 0.05);
        EXPECT_LT(std::abs(shot->arrival - t.direction), 0.05);
        const Trace again = trace(mesh, start, shot->departure, shot->length);
        EXPECT_LT((position(mesh, again.end) - position(mesh, t.end)).norm(), 1e-4 * length);
    }
    EXPECT_GE(found, 98);
}

TEST(Shoot, IsExactOnThePlaneAfterOneCorrection) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(40, 40, 0.1, 0.1, 1.5));
    Random random(2);
    const SurfacePoint from = shapes::point_nearest(mesh, {5.0, 2.03, 0.0});
    for (int i = 0; i < 50; ++i) {
        const Complex d = std::polar(0.3 + 0.4 * random.uniform(), 2.0 * M_PI * random.uniform());
        const SurfacePoint to = trace(mesh, from, d, std::abs(d)).end;
        const auto shot = shoot(mesh, from, to, d * std::polar(1.0, 0.3), 0.8 * std::abs(d), {.max_traces = 1});
        if (!shot) continue;  // missed by more than 15 % before any correction
        EXPECT_NEAR(shot->length, std::abs(d), 1e-6);
        EXPECT_LT(std::abs(shot->departure - unit(d)), 1e-5);
    }
    const Complex d = std::polar(0.5, 1.0);
    const SurfacePoint to = trace(mesh, from, d, 0.5).end;
    const auto shot = shoot(mesh, from, to, d * std::polar(1.0, 0.1), 0.52, {.max_traces = 2});
    ASSERT_TRUE(shot);
    EXPECT_NEAR(shot->length, 0.5, 1e-6);
    EXPECT_LT((lift(mesh, to.face, shot->arrival) - lift(mesh, from.face, unit(d))).norm(), 1e-5);
}

TEST(Shoot, KeepsItsPromiseWithTheDefaultTolerance) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(4));
    Random random(3);
    std::vector<double> error;
    for (int i = 0; i < 100; ++i) {
        SurfacePoint from, to;
        from.face = random.below(mesh.face_count());
        const Trace t = trace(mesh, from, std::polar(1.0, 2.0 * M_PI * random.uniform()), 0.7);
        to = t.end;
        const double exact = std::acos(position(mesh, from).normalized().dot(position(mesh, to).normalized()));
        const Complex guess = flatten(mesh, from.face, position(mesh, to) - position(mesh, from));
        const auto shot = shoot(mesh, from, to, guess * std::polar(1.0, 0.2), 0.6);
        ASSERT_TRUE(shot);
        error.push_back(std::abs(shot->length - exact) / exact);
    }
    // What is left of the miss is 2 % of the length, and corrected once more.
    EXPECT_LT(shapes::mean(error), 0.005);
}

TEST(Shoot, FollowsTheGuessRoundTheFarSideOfATube) {
    const int around = 48;
    const TriangleMesh mesh = shapes::mesh_of(shapes::cylinder(around, 40, 1.0, 4.0));
    const double girth = around * 2.0 * std::sin(M_PI / around);
    const SurfacePoint from = shapes::point_nearest(mesh, {1.0, 0.05, 2.0});
    const Complex ring = flatten(mesh, from.face, Eigen::Vector3d::UnitZ().cross(mesh.normal[from.face]));
    const SurfacePoint to = trace(mesh, from, ring, 0.3 * girth).end;
    const auto near = shoot(mesh, from, to, ring, 0.3 * girth, sharp);
    const auto far = shoot(mesh, from, to, -ring, 0.7 * girth, sharp);
    ASSERT_TRUE(near && far);
    EXPECT_NEAR(near->length, 0.3 * girth, 1e-5);
    EXPECT_NEAR(far->length, 0.7 * girth, 1e-5);
    EXPECT_LT(std::abs(near->arrival + far->arrival), 1e-4);
}

TEST(Shoot, FindsNothingAcrossABoundary) {
    const auto slit = shapes::cut(shapes::grid(20, 20, 0.1, 0.1), [](const Eigen::Vector3d& c) {
        return std::abs(c.x() - 1.05) > 0.05 || c.y() < 0.5;
    });
    const Surface surface = Surface::from_mesh(slit.vertices, slit.faces);
    const TriangleMesh& mesh = surface.mesh_with_paths();
    const SurfacePoint from = shapes::point_nearest(mesh, {0.43, 1.51, 0.0}),
                       to = shapes::point_nearest(mesh, {1.62, 1.47, 0.0});
    const Complex across = flatten(mesh, from.face, position(mesh, to) - position(mesh, from));
    EXPECT_FALSE(shoot(mesh, from, to, across, std::abs(across)));
}

TEST(Shoot, SumsTheAnglesOfATriangleToItsCurvature) {
    // Around the tip of a cone: exactly what its sector lacks. On the sphere: its area.
    const double angle = 4.2;
    const int around = 60;
    const TriangleMesh cone = shapes::mesh_of(shapes::cone(around, 30, angle));
    const auto excess = [](const TriangleMesh& mesh, const std::array<SurfacePoint, 3>& p,
                           const std::array<Complex, 3>& guess, double length) {
        std::array<Shot, 3> shot;
        for (int i = 0; i < 3; ++i) {
            const auto s = shoot(mesh, p[i], p[(i + 1) % 3], guess[i], length, sharp);
            EXPECT_TRUE(s);
            if (s) shot[i] = *s;
        }
        double sum = -M_PI;
        for (int i = 0; i < 3; ++i)
            sum += std::abs(std::arg(-shot[(i + 2) % 3].arrival * std::conj(shot[i].departure)));
        return sum;
    };
    const auto on_cone = [&](int sector) {
        const Eigen::Vector3d x = cone.position[18 * around + 1 + sector], y = cone.position[18 * around + 2 + sector];
        return shapes::point_nearest(cone, 0.55 * x + 0.45 * y);
    };
    const std::array<SurfacePoint, 3> p{on_cone(0), on_cone(20), on_cone(40)};
    std::array<Complex, 3> guess;
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d up = -position(cone, p[i]).normalized();
        const Eigen::Vector3d ring = cone.normal[p[i].face].cross(up);
        // The frame's sense decides which way round the tip is the next point.
        const double sense = (position(cone, p[(i + 1) % 3]) - position(cone, p[i])).dot(ring) > 0.0 ? 1.0 : -1.0;
        guess[i] = flatten(cone, p[i].face, std::cos(angle / 6) * sense * ring + std::sin(angle / 6) * up);
    }
    const double length = 2.0 * position(cone, p[0]).norm() * std::sin(angle / 6);
    EXPECT_NEAR(excess(cone, p, guess, length), 2.0 * M_PI - angle, 1e-4);

    std::vector<double> error;
    for (const int levels : {3, 4, 5}) {
        const TriangleMesh ball = shapes::mesh_of(shapes::sphere(levels));
        const std::array<Eigen::Vector3d, 3> x{Eigen::Vector3d(1, 0.1, 0.05).normalized(),
                                               Eigen::Vector3d(0.1, 1, 0.08).normalized(),
                                               Eigen::Vector3d(0.03, 0.07, 1).normalized()};
        std::array<SurfacePoint, 3> q;
        std::array<Complex, 3> ways;
        for (int i = 0; i < 3; ++i) q[i] = shapes::point_nearest(ball, x[i]);
        for (int i = 0; i < 3; ++i) {
            ways[i] = flatten(ball, q[i].face, position(ball, q[(i + 1) % 3]) - position(ball, q[i]));
        }
        std::array<double, 3> angles;
        for (int i = 0; i < 3; ++i) {
            const Eigen::Vector3d b = x[(i + 1) % 3] - x[i].dot(x[(i + 1) % 3]) * x[i];
            const Eigen::Vector3d c = x[(i + 2) % 3] - x[i].dot(x[(i + 2) % 3]) * x[i];
            angles[i] = std::acos(b.normalized().dot(c.normalized()));
        }
        error.push_back(std::abs(excess(ball, q, ways, 1.5) - (angles[0] + angles[1] + angles[2] - M_PI)));
    }
    EXPECT_LT(error[2], 0.02);
    EXPECT_LT(error[2], error[0]);
}

}  // namespace
}  // namespace isograft
