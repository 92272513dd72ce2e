// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/fingerprint.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace isograft {
namespace {

Eigen::MatrixXd fingerprints_of(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points,
                                const std::vector<double>& radii, int threads = 2) {
    Monitor monitor;
    return fingerprints(mesh, points, radii, threads, monitor, 0.0, 1.0);
}

TEST(Fingerprint, IsOneOnAPlaneAwayFromTheBoundary) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(40, 40, 0.05, 0.05));
    const auto prints = fingerprints_of(
        mesh, {shapes::point_nearest(mesh, {1.0, 1.0, 0.0}), shapes::point_nearest(mesh, {0.83, 1.21, 0.0})},
        even_radii(0.2, 0.6, 10));
    ASSERT_EQ(prints.cols(), 10);
    EXPECT_LT((prints.array() - 1.0).abs().maxCoeff(), 0.01);
}

TEST(Fingerprint, IsHalfOnAStraightBoundary) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(40, 40, 0.05, 0.05));
    const auto prints = fingerprints_of(mesh, {shapes::point_nearest(mesh, {1.0, 0.0, 0.0})}, even_radii(0.3, 0.6, 4));
    EXPECT_LT((prints.array() - 0.5).abs().maxCoeff(), 0.01);
}

TEST(Fingerprint, IsTheSineLawOnASphere) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(4));
    const auto radii = even_radii(0.4, 2.0, 9);
    const auto prints = fingerprints_of(mesh, {shapes::point_nearest(mesh, {0.3, -0.5, 0.8})}, radii);
    for (Eigen::Index k = 0; k < prints.cols(); ++k) {
        EXPECT_NEAR(prints(0, k), std::sin(radii[k]) / radii[k], 0.015) << "radius " << radii[k];
    }
}

TEST(Fingerprint, IsInvariantToRigidMotionAndToCommonScale) {
    const auto shape = shapes::blob(3);
    const TriangleMesh mesh = shapes::mesh_of(shape);
    const TriangleMesh other = shapes::mesh_of(shapes::moved(shape, shapes::some_rotation(), {1.0, 2.0, 3.0}, 2.5));
    std::vector<SurfacePoint> points;
    for (int v = 0; v < mesh.vertex_count(); v += 50) points.push_back(point_near_vertex(mesh, v));
    const auto a = fingerprints_of(mesh, points, even_radii(0.2, 0.5, 5));
    const auto b = fingerprints_of(other, points, even_radii(0.5, 1.25, 5));
    EXPECT_LT((a - b).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Fingerprint, IsEqualBitForBitForAnyNumberOfThreads) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    std::vector<SurfacePoint> points;
    for (int v = 0; v < mesh.vertex_count(); v += 7) points.push_back(point_near_vertex(mesh, v));
    EXPECT_EQ(fingerprints_of(mesh, points, even_radii(0.2, 0.5, 5), 1),
              fingerprints_of(mesh, points, even_radii(0.2, 0.5, 5), 3));
}

TEST(GeodesicDiameter, IsTheDiagonalOfASquareAndOfAnUnrolledTube) {
    Monitor monitor;
    EXPECT_NEAR(geodesic_diameter(shapes::mesh_of(shapes::grid(20, 20, 0.1, 0.1)), monitor), std::sqrt(8.0), 0.01);
    constexpr int around = 24;
    const double half = around * std::sin(M_PI / around);  // half the polygon's circumference, radius 1
    EXPECT_NEAR(geodesic_diameter(shapes::mesh_of(shapes::cylinder(around, 20, 1.0, 4.0)), monitor),
                std::hypot(half, 4.0), 0.02);
}

}  // namespace
}  // namespace isograft
