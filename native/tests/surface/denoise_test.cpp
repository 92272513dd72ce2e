// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/denoise.h"

#include <cmath>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

// Standard deviation of the distance from the origin: what curvature shifts everywhere alike is no noise.
double roughness(const TriangleMesh& mesh) {
    double sum = 0.0, squares = 0.0;
    for (const Eigen::Vector3d& x : mesh.position) {
        sum += x.norm() / mesh.vertex_count();
        squares += x.squaredNorm() / mesh.vertex_count();
    }
    return std::sqrt(squares - sum * sum);
}

TEST(Denoise, TakesMostOfTheNoiseOffASphere) {
    const auto clean = shapes::sphere(4);
    const double edge = gate(clean).mesh().mean_edge;
    const Surface noisy = gate(shapes::noisy(clean, 0.3 * edge, 3));
    Monitor monitor;
    const TriangleMesh smooth = denoised(noisy.mesh(), 3.0, monitor);
    // Eleven neighbours carry the weight, which leaves 0.3 of their noise, and as much again comes from their normals.
    EXPECT_LT(roughness(smooth), 0.6 * roughness(noisy.mesh()));
    EXPECT_EQ(smooth.face, noisy.mesh().face);
    EXPECT_EQ(smooth.twin, noisy.mesh().twin);
    EXPECT_EQ(smooth.input_vertex, noisy.mesh().input_vertex);
}

TEST(Denoise, LeavesACleanSurfaceWhereItIs) {
    const TriangleMesh mesh = gate(shapes::sphere(4)).mesh();
    Monitor monitor;
    const TriangleMesh smooth = denoised(mesh, 2.5, monitor);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        // The bias of curvature: the mean squared distance of 1.04 edges by half the curvature.
        EXPECT_LT((smooth.position[v] - mesh.position[v]).norm(), 1.04 * mesh.mean_edge * mesh.mean_edge);
    }
}

TEST(Denoise, LeavesNoTriangleThatFacesAgainstTheSurface) {
    const Surface noisy = gate(shapes::noisy(shapes::torus(48, 20, 1.0, 0.3), 0.03, 5));
    Monitor monitor;
    const TriangleMesh smooth = denoised(noisy.mesh(), 4.0, monitor);
    for (int f = 0; f < smooth.face_count(); ++f) {
        const auto& [a, b, c] = smooth.face[f];
        const Eigen::Vector3d x = (smooth.position[a] + smooth.position[b] + smooth.position[c]) / 3.0;
        const Eigen::Vector3d ring = Eigen::Vector3d(x.x(), x.y(), 0.0).normalized();
        EXPECT_GT(smooth.normal[f].dot(x - ring), 0.0);
    }
}

TEST(Denoise, KeepsOpenPartsSmoothWhenTheyAreTurnedOver) {
    Monitor monitor;
    const Surface noisy = gate(shapes::noisy(shapes::grid(20, 20, 0.05, 0.05), 0.005, 7));
    const Surface smooth = noisy.denoised(2.5, monitor);
    const Surface turned = smooth.with_open_parts_reversed();
    for (int v = 0; v < turned.mesh().vertex_count(); ++v) {
        EXPECT_EQ(turned.mesh().position[v], smooth.mesh().position[v]);
    }
}

TEST(Denoise, RefusesARadiusThatReachesNoNeighbour) {
    SurfaceOptions options;
    options.denoise = 0.5;
    EXPECT_THROW(options.validate(), InvalidInput);
    options.denoise = std::nan("");
    EXPECT_THROW(options.validate(), InvalidInput);
    options.denoise = 0.0;
    EXPECT_NO_THROW(options.validate());
}

}  // namespace
}  // namespace isograft
