// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/closest.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/random.h"
#include "gate.h"
#include "shapes.h"

namespace isograft {
namespace {

TEST(ClosestInFace, IsNoFartherThanAnyPointOfTheTriangle) {
    const TriangleMesh mesh = gate(shapes::blob(2)).mesh();
    Random random(3);
    for (int i = 0; i < 200; ++i) {
        const int face = random.below(static_cast<int>(mesh.face.size()));
        const Eigen::Vector3d x(3.0 * random.uniform() - 1.5, 3.0 * random.uniform() - 1.5,
                                3.0 * random.uniform() - 1.5);
        const SurfacePoint p = closest_in_face(mesh, face, x);
        ASSERT_EQ(p.face, face);
        for (const double w : p.weight) EXPECT_GE(w, -1e-12);
        EXPECT_NEAR(p.weight[0] + p.weight[1] + p.weight[2], 1.0, 1e-9);
        const double found = (position(mesh, p) - x).norm();
        for (int a = 0; a <= 12; ++a) {
            for (int b = 0; a + b <= 12; ++b) {
                const SurfacePoint q{face, {a / 12.0, b / 12.0, (12 - a - b) / 12.0}};
                EXPECT_LE(found, (position(mesh, q) - x).norm() + 1e-6);
            }
        }
    }
}

TEST(ClosestFrom, WalksToTheNearestPointOfASphere) {
    const TriangleMesh mesh = gate(shapes::sphere(3)).mesh();
    Random random(4);
    for (int i = 0; i < 100; ++i) {
        const int start = random.below(mesh.vertex_count());
        const Eigen::Vector3d& at = mesh.position[start];
        // Up to a quarter of the way round, inside and outside.
        const Eigen::Vector3d aside(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
        const Eigen::Vector3d x = (0.8 + 0.4 * random.uniform()) * (at + aside).normalized();
        const Eigen::Vector3d found = position(mesh, closest_from(mesh, start, x));
        EXPECT_LT((found - x).norm(), (position(mesh, shapes::point_nearest(mesh, x)) - x).norm() + 1e-6);
    }
}

TEST(ClosestFrom, StaysOnTheSheetItStartsOn) {
    const auto sheet = shapes::grid(8, 8, 0.25, 0.25);
    const TriangleMesh mesh =
        gate(shapes::joined(sheet, shapes::moved(sheet, Eigen::Matrix3d::Identity(), {0, 0, 0.1}))).mesh();
    const int half = mesh.vertex_count() / 2;
    // Just below the upper sheet, but started on the lower.
    const Eigen::Vector3d x(1.3, 0.7, 0.09);
    const SurfacePoint p = closest_from(mesh, 5, x);
    EXPECT_LT(mesh.face[p.face][0], half);
    EXPECT_NEAR((position(mesh, p) - Eigen::Vector3d(1.3, 0.7, 0.0)).norm(), 0.0, 1e-5);
    EXPECT_GE(mesh.face[closest_from(mesh, half + 5, x).face][0], half);
}

}  // namespace
}  // namespace isograft
