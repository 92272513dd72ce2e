// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/curvature.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace isograft {
namespace {

TEST(MeanCurvature, OfASphereIsOneOverItsRadius) {
    for (const double radius : {0.01, 1.0, 300.0}) {
        const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(4, radius));
        // Unsmoothed, a vertex of five triangles has the wrong area to itself.
        for (const double time : {0.01, 0.3}) {
            for (const double h : mean_curvature(mesh, time * radius * radius)) EXPECT_NEAR(h * radius, 1.0, 0.01);
        }
    }
}

TEST(MeanCurvature, OfASphereApproachesOneWithTheMesh) {
    std::vector<double> error;
    for (const int levels : {2, 3, 4}) {
        const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(levels));
        double sum = 0.0;
        for (const double h : mean_curvature(mesh, 0.0)) sum += std::abs(h - 1.0) / mesh.vertex_count();
        error.push_back(sum);
    }
    EXPECT_LT(error[1], 0.5 * error[0]);
    EXPECT_LT(error[2], 0.5 * error[1]);
}

TEST(MeanCurvature, HasTheSignOfTheSideItIsSeenFrom) {
    const auto inside = shapes::grid(20, 20, 0.1, 0.1);
    for (const double sense : {1.0, -1.0}) {
        auto bowl = inside;
        for (Eigen::Index v = 0; v < bowl.vertices.rows(); ++v) {
            const double x = bowl.vertices(v, 0) - 1.0, y = bowl.vertices(v, 1) - 1.0;
            bowl.vertices(v, 2) = sense * 0.5 * (x * x + y * y);
        }
        const TriangleMesh mesh = shapes::mesh_of(bowl);
        // At the bottom both principal curvatures are 1, and the normal is +z: hollow where it opens upward.
        EXPECT_NEAR(mean_curvature(mesh, 0.0)[220], -sense, 0.02);
    }
}

TEST(MeanCurvature, OfATubeIsHalfOfOneOverItsRadius) {
    const double radius = 0.7;
    const TriangleMesh mesh = shapes::mesh_of(shapes::cylinder(60, 60, radius, 4.0));
    const auto h = mean_curvature(mesh, 0.01);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        if (std::abs(mesh.position[v].z() - 2.0) < 1.4) {
            EXPECT_NEAR(h[v], 0.5 / radius, 0.005);
        }
    }
}

TEST(MeanCurvature, OfATorusVariesAcrossTheTube) {
    const double radius = 1.0, tube = 0.4;
    const TriangleMesh mesh = shapes::mesh_of(shapes::torus(120, 60, radius, tube));
    const auto h = mean_curvature(mesh, 0.0);
    std::vector<double> error;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const double c = (mesh.position[v].head<2>().norm() - radius) / tube;
        error.push_back(std::abs(h[v] - 0.5 * (1.0 / tube + c / (radius + tube * c))));
    }
    EXPECT_LT(shapes::mean(error), 0.01);
}

TEST(MeanCurvature, OfAPlaneIsZeroUpToItsBoundary) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(20, 20, 0.1, 0.05, 1.5));
    for (const double h : mean_curvature(mesh, 0.02)) EXPECT_NEAR(h, 0.0, 1e-9);
}

TEST(MeanCurvature, SmoothsAlikeWhateverTheTriangulation) {
    const auto fine = shapes::mesh_of(shapes::blob(5)), coarse = shapes::mesh_of(shapes::blob(4));
    const auto a = mean_curvature(fine, 0.02), b = mean_curvature(coarse, 0.02);
    // Vertices of the coarse mesh come first in the fine one.
    double most = 0.0, least = 1e9;
    std::vector<double> error;
    for (int v = 0; v < coarse.vertex_count(); ++v) {
        error.push_back(std::abs(a[v] - b[v]));
        most = std::max(most, a[v]);
        least = std::min(least, a[v]);
    }
    EXPECT_LT(shapes::mean(error), 0.01 * (most - least));
}

TEST(MeanCurvature, IsTheSameAfterRigidMotionAndRenumbering) {
    const auto shape = shapes::noisy(shapes::blob(3), 0.01, 2);
    const auto other = shapes::renumbered(shape, 17);
    const auto a = mean_curvature(shapes::mesh_of(shape), 0.01);
    const auto b =
        mean_curvature(shapes::mesh_of(shapes::moved(other.shape, shapes::some_rotation(), {1, 2, 3})), 0.01);
    for (std::size_t v = 0; v < a.size(); ++v) EXPECT_NEAR(b[other.vertex[v]], a[v], 1e-9);
}

TEST(CoarseCurvatures, AgreeWithThoseOfTheFineMeshWhetherHeatFlowsThereOrNot) {
    const TriangleMesh fine = shapes::mesh_of(shapes::blob(5));
    Monitor monitor;
    const double time = 0.03;
    const auto truth = mean_curvature(fine, time);
    double previous = 1.0;
    for (const double edge : {0.05, 0.12}) {  // half the vertices, and a tenth of them
        const CoarseMesh coarse = coarsen(fine, edge, monitor);
        ASSERT_FALSE(coarse.fine_vertex.empty());
        const auto fields = coarse_curvatures(fine, coarse, {0.5 * time, time}, monitor);
        ASSERT_EQ(fields.size(), 2U);
        double difference = 0.0, size = 0.0;
        for (int v = 0; v < coarse.mesh.vertex_count(); ++v) {
            difference += std::abs(fields[1][v] - truth[coarse.fine_vertex[v]]);
            size += std::abs(truth[coarse.fine_vertex[v]]);
        }
        EXPECT_LT(difference, 0.05 * size) << edge;
        const double share = static_cast<double>(coarse.mesh.vertex_count()) / fine.vertex_count();
        EXPECT_LT(share, previous);
        previous = share;
    }
    EXPECT_LT(previous, 1.0 / 3.0);
}

}  // namespace
}  // namespace isograft
