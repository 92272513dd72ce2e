// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/vertex_levels.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "geodesic/trace.h"
#include "shapes.h"

namespace isograft {
namespace {

VertexLevels levels_of(const TriangleMesh& mesh, int levels = 4, int threads = 2) {
    Monitor monitor;
    return make_vertex_levels(mesh, levels, threads, monitor, 0.0, 1.0);
}

TEST(VertexLevels, HaveTheMeshItselfAsLevelZero) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    const VertexLevels levels = levels_of(mesh);
    ASSERT_EQ(levels.samples.count(), mesh.vertex_count());
    EXPECT_DOUBLE_EQ(levels.samples.spacing, mesh.mean_edge);
    int edges = 0;
    for (const SampleEdge& e : levels.samples.edges) {
        if (e.level > 0) continue;
        ++edges;
        const double straight = (mesh.position[e.u] - mesh.position[e.v]).norm();
        // The points lie a hundredth inside their triangles.
        EXPECT_NEAR(e.length, straight, 0.05 * straight);
    }
    EXPECT_EQ(edges, mesh.face_count() * 3 / 2);
}

TEST(VertexLevels, DoubleTheirSpacingAndNest) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(5));
    const VertexLevels levels = levels_of(mesh);
    std::vector<double> length(4, 0.0);
    std::vector<int> edges(4, 0), vertices(4, 0);
    for (const int level : levels.samples.level) {
        for (int l = 0; l <= level; ++l) ++vertices[l];
    }
    for (const SampleEdge& e : levels.samples.edges) {
        EXPECT_GE(levels.samples.level[e.u], e.level);
        EXPECT_GE(levels.samples.level[e.v], e.level);
        length[e.level] += e.length;
        ++edges[e.level];
    }
    for (int l = 1; l < 4; ++l) {
        const double ratio = length[l] / edges[l] / (length[l - 1] / edges[l - 1]);
        EXPECT_GT(ratio, 1.6) << "level " << l;
        EXPECT_LT(ratio, 2.6) << "level " << l;
        // Every vertex of a closed level has about six neighbours.
        EXPECT_GT(edges[l], 2 * vertices[l]) << "level " << l;
        EXPECT_LE(edges[l], 3 * vertices[l]) << "level " << l;
    }
}

TEST(VertexLevels, EdgesAreStraightPathsBetweenTheirEnds) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    const VertexLevels levels = levels_of(mesh);
    int checked = 0;
    for (const auto* list : {&levels.samples.edges, &levels.near}) {
        for (const SampleEdge& e : *list) {
            if (++checked % 17 != 0) continue;
            const Trace t = trace(mesh, levels.samples.point[e.u], e.at_u, e.length);
            EXPECT_LT((position(mesh, t.end) - position(mesh, levels.samples.point[e.v])).norm(), 0.05 * e.length);
            const Trace back = trace(mesh, levels.samples.point[e.v], e.at_v, e.length);
            EXPECT_LT((position(mesh, back.end) - position(mesh, levels.samples.point[e.u])).norm(), 0.05 * e.length);
        }
    }
    EXPECT_GT(checked, 1000);
}

TEST(VertexLevels, NearVerticesAreThoseWithinReach) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(12, 12, 1.0, 1.0));
    const VertexLevels levels = levels_of(mesh);
    const double reach = levels.near_reach();
    std::vector<int> count(mesh.vertex_count(), 0), expected(mesh.vertex_count(), 0);
    for (const SampleEdge& e : levels.near) ++count[e.u], ++count[e.v];
    for (int u = 0; u < mesh.vertex_count(); ++u) {
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            if (u != v && (mesh.position[u] - mesh.position[v]).norm() <= reach) ++expected[u];
        }
    }
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        EXPECT_EQ(count[v], expected[v]) << "vertex " << v;
        EXPECT_EQ(count[v], static_cast<int>(levels.near_of[v].size()));
    }
}

TEST(VertexLevels, DoNotJoinSheetsThatOnlyPassCloseToEachOther) {
    const auto sheet = shapes::grid(10, 10, 1.0, 1.0);
    const TriangleMesh mesh =
        shapes::mesh_of(shapes::joined(sheet, shapes::moved(sheet, Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.1})));
    const VertexLevels levels = levels_of(mesh);
    for (const auto* list : {&levels.samples.edges, &levels.near}) {
        for (const SampleEdge& e : *list) EXPECT_EQ(mesh.position[e.u].z(), mesh.position[e.v].z());
    }
}

TEST(VertexLevels, AreEqualBitForBitForAnyNumberOfThreads) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    const VertexLevels a = levels_of(mesh, 4, 1), b = levels_of(mesh, 4, 3);
    ASSERT_EQ(a.samples.edges.size(), b.samples.edges.size());
    for (std::size_t i = 0; i < a.samples.edges.size(); ++i) {
        EXPECT_EQ(a.samples.edges[i].v, b.samples.edges[i].v);
        EXPECT_EQ(a.samples.edges[i].length, b.samples.edges[i].length);
    }
}

}  // namespace
}  // namespace isograft
