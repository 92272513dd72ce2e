// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/coarse_mesh.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

CoarseMesh coarsened(const TriangleMesh& fine, double edge) {
    Monitor monitor;
    return coarsen(fine, edge, monitor);
}

/// Number of edges, of boundary edges, and their mean length.
struct Edges {
    int count = 0, boundary = 0;
    double length = 0.0;

    explicit Edges(const TriangleMesh& mesh) {
        std::set<std::pair<int, int>> seen;
        std::set<std::pair<int, int>> directed;
        for (const auto& f : mesh.face) {
            for (int k = 0; k < 3; ++k) directed.insert({f[k], f[(k + 1) % 3]});
        }
        for (const auto& [u, v] : directed) {
            if (!directed.count({v, u})) ++boundary;
            if (!seen.insert({std::min(u, v), std::max(u, v)}).second) continue;
            ++count;
            length += (mesh.position[u] - mesh.position[v]).norm();
        }
        length /= count;
    }
};

int euler(const TriangleMesh& mesh) {
    return mesh.vertex_count() - Edges(mesh).count + static_cast<int>(mesh.face.size());
}

TEST(CoarseMesh, HasEdgesOfTheLengthAskedForAndTheSameTopology) {
    const shapes::Shape open = shapes::cut(shapes::blob(5), [](const Eigen::Vector3d& x) { return x.y() < 0.5; });
    for (const auto& shape : {shapes::blob(5), shapes::torus(120, 60, 1.0, 0.4), open}) {
        const TriangleMesh fine = gate(shape).mesh();
        const CoarseMesh coarse = coarsened(fine, 0.16);
        expect_manifold(coarse.mesh);
        EXPECT_EQ(euler(coarse.mesh), euler(fine));
        EXPECT_EQ(Edges(coarse.mesh).boundary > 0, Edges(fine).boundary > 0);
        EXPECT_NEAR(Edges(coarse.mesh).length, 0.16, 0.05);
        EXPECT_NEAR(coarse.mesh.area / fine.area, 1.0, 0.05);
    }
}

TEST(CoarseMesh, LeavesTheVerticesThatStayWhereTheyAre) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    const CoarseMesh coarse = coarsened(fine, 0.16);
    ASSERT_EQ(static_cast<int>(coarse.fine_vertex.size()), coarse.mesh.vertex_count());
    for (int v = 0; v < coarse.mesh.vertex_count(); ++v) {
        EXPECT_EQ(coarse.mesh.position[v], fine.position[coarse.fine_vertex[v]]);
    }
}

TEST(CoarseMesh, KnowsForEveryFineVertexAPlaceNearIt) {
    const Surface surface = gate(shapes::blob(5));
    const TriangleMesh& fine = surface.mesh();
    const CoarseMesh coarse = coarsened(fine, 0.16);
    Detail detail{surface, 2.0, coarse};
    detail.coarse.mesh = scaled(coarse.mesh, 2.0);
    ASSERT_EQ(static_cast<int>(coarse.place.size()), fine.vertex_count());
    for (int v = 0; v < fine.vertex_count(); ++v) {
        const SurfacePoint& p = coarse.place[v];
        EXPECT_NEAR(p.weight[0] + p.weight[1] + p.weight[2], 1.0, 1e-9);
        EXPECT_LT((position(coarse.mesh, p) - fine.position[v]).norm(), 0.08);
        // ... and the way back.
        EXPECT_LT((position(fine, to_fine(detail, p)) - fine.position[v]).norm(), 0.08);
    }
}

TEST(CoarseMesh, CountsEveryFineVertexToOneCoarseOne) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    const CoarseMesh coarse = coarsened(fine, 0.16);
    std::vector<int> members(fine.vertex_count(), 0);
    for (const auto& list : coarse.members) {
        for (const int v : list) ++members[v];
    }
    EXPECT_EQ(std::count(members.begin(), members.end(), 1), fine.vertex_count());
}

TEST(CoarseMesh, MadeFromACoarseOneKnowsTheFineOneToo) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    Monitor monitor;
    const CoarseMesh further = coarsen_further(fine, coarsened(fine, 0.1), 0.2, monitor);
    EXPECT_NEAR(Edges(further.mesh).length, 0.2, 0.06);
    ASSERT_EQ(static_cast<int>(further.fine_vertex.size()), further.mesh.vertex_count());
    for (int v = 0; v < further.mesh.vertex_count(); ++v) {
        EXPECT_EQ(further.mesh.position[v], fine.position[further.fine_vertex[v]]);
    }
    ASSERT_EQ(static_cast<int>(further.place.size()), fine.vertex_count());
    for (int v = 0; v < fine.vertex_count(); ++v) {
        EXPECT_LT((position(further.mesh, further.place[v]) - fine.position[v]).norm(), 0.1);
    }
    std::size_t members = 0;
    for (const auto& list : further.members) members += list.size();
    EXPECT_EQ(members, static_cast<std::size_t>(fine.vertex_count()));
}

TEST(CoarseMesh, TakesOverValues) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    const CoarseMesh coarse = coarsened(fine, 0.16);
    for (const double x : at_coarse(coarse, std::vector<double>(fine.vertex_count(), 2.5))) EXPECT_NEAR(x, 2.5, 1e-12);
    std::vector<double> height(fine.vertex_count());
    for (int v = 0; v < fine.vertex_count(); ++v) height[v] = fine.position[v].z();
    const auto values = at_coarse(coarse, height);
    for (int v = 0; v < coarse.mesh.vertex_count(); ++v) EXPECT_NEAR(values[v], coarse.mesh.position[v].z(), 0.1);
}

TEST(CoarseMesh, OfAMeshThatIsCoarseEnoughIsThatMesh) {
    const TriangleMesh fine = gate(shapes::blob(3)).mesh();
    const CoarseMesh coarse = coarsened(fine, Edges(fine).length);
    EXPECT_TRUE(coarse.fine_vertex.empty());
    EXPECT_TRUE(coarse.place.empty());
    EXPECT_TRUE(coarse.mesh.has_paths());
    EXPECT_EQ(coarse.mesh.face, fine.face);
    EXPECT_EQ(coarse.mesh.position, fine.position);
}

TEST(CoarseMesh, LeavesAloneWhatIsWithinTheSlackAndNothingAboveIt) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    // A fifth more vertices than triangles of that edge have.
    const double edge = std::sqrt(fine.area / (0.866 * fine.vertex_count() / 1.2));
    Monitor monitor;
    EXPECT_TRUE(coarsen(fine, edge, monitor).fine_vertex.empty());
    EXPECT_TRUE(coarsen(fine, edge, monitor, 1.25).fine_vertex.empty());
    const CoarseMesh coarse = coarsen(fine, edge, monitor, 1.0);
    EXPECT_NEAR(coarse.mesh.vertex_count(), fine.vertex_count() / 1.2, 10.0);
}

TEST(CoarseMesh, StopsWhenCancelled) {
    const TriangleMesh fine = gate(shapes::blob(5)).mesh();
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(coarsen(fine, 0.16, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
