// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/centroid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "blend/dissimilarity.h"
#include "shapes.h"

namespace isograft {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A plane of unit cells mapped onto itself, shifted.
struct Plane {
    TriangleMesh mesh = shapes::mesh_of(shapes::grid(20, 20, 1.0, 1.0));
    VertexLevels levels;

    Plane() {
        Monitor monitor;
        levels = make_vertex_levels(mesh, 3, 2, monitor, 0.0, 1.0);
    }
    /// Vertices with keep(position) go to where they are, plus `shift`.
    template <class Keep>
    [[nodiscard]] PartialMap map(const Eigen::Vector3d& shift, Keep&& keep, float seed_distance = 1.0F) const {
        PartialMap result(mesh.vertex_count());
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            const Eigen::Vector3d x = mesh.position[v] + shift;
            if (!keep(mesh.position[v]) || x.x() < 0.0 || x.x() > 20.0 || x.y() < 0.0 || x.y() > 20.0) continue;
            const SurfacePoint p = shapes::point_nearest(mesh, x);
            const int face = levels.samples.point[v].face;
            result.put(mesh, v, p, unit(flatten(mesh, p.face, mesh.axis_x[face])));
            result.seed_distance[v] = seed_distance;
        }
        return result;
    }
    [[nodiscard]] MergedMap merge(const std::vector<const PartialMap*>& maps) const {
        Monitor monitor;
        return merge_by_centroid(levels, mesh, maps, 10.0 * levels.samples.spacing, 2, monitor, 0.0, 1.0);
    }
    [[nodiscard]] Eigen::MatrixXd dissimilarities(const std::vector<PartialMap>& maps) const {
        Monitor monitor;
        const DistanceTable table(mesh, levels.spacing(2), 2, monitor, 0.0, 1.0);
        return map_dissimilarities(levels, table, mesh, table, maps, 2, monitor, 0.0, 1.0);
    }
};

const auto all = [](const Eigen::Vector3d&) { return true; };

TEST(Centroid, OfEqualMapsIsTheMap) {
    const Plane plane;
    const PartialMap map = plane.map({2.2, 1.3, 0.0}, all);
    const MergedMap merged = plane.merge({&map, &map, &map});
    EXPECT_EQ(merged.map.mapped, map.mapped);
    for (int v = 0; v < plane.mesh.vertex_count(); ++v) {
        if (!map.mapped[v]) continue;
        EXPECT_LT((merged.map.position[v] - map.position[v]).norm(), 1e-5);
        EXPECT_LT(merged.spread[v], 1e-5);
        EXPECT_LT(std::abs(merged.map.rotation[v] - map.rotation[v]), 1e-6);
    }
}

TEST(Centroid, IsWhereTheWeightedDistancesAreLeast) {
    const Plane plane;
    // Near images go the straight way, those farther apart through a window.
    for (const double apart : {1.0, 8.0}) {
        const PartialMap a = plane.map({0.0, 0.0, 0.0}, all);
        const PartialMap b = plane.map({apart, 0.0, 0.0}, all);
        const PartialMap c = plane.map({0.0, apart, 0.0}, all);
        const MergedMap merged = plane.merge({&a, &b, &c});
        // Of the corners of half a square the point that sees all sides under 120 degrees.
        const double x = apart * (3.0 - std::sqrt(3.0)) / 6.0;
        for (int v = 0; v < plane.mesh.vertex_count(); ++v) {
            const Eigen::Vector3d& at = plane.mesh.position[v];
            if (std::min(at.x(), at.y()) < 1.0 || std::max(at.x(), at.y()) + apart > 19.0) {
                continue;
            }
            const Eigen::Vector3d expected = at + Eigen::Vector3d(x, x, 0.0);
            EXPECT_LT((merged.map.position[v] - expected).norm(), 0.02 * apart) << "vertex " << v;
        }
    }
}

TEST(Centroid, IsTheImageThatWeighsMoreThanAllOthers) {
    const Plane plane;
    const double decay = 10.0 * plane.levels.samples.spacing;
    const PartialMap a = plane.map({0.0, 0.0, 0.0}, all, 0.0F);
    const PartialMap b = plane.map({6.0, 0.0, 0.0}, all, static_cast<float>(decay * std::log(3.0)));
    const MergedMap merged = plane.merge({&b, &a});
    for (int v = 0; v < plane.mesh.vertex_count(); ++v) {
        EXPECT_LT((merged.map.position[v] - plane.mesh.position[v]).norm(), 0.02) << "vertex " << v;
    }
}

TEST(Centroid, StaysWithMostImagesHoweverFarTheOthersAre) {
    const Plane plane;
    std::vector<PartialMap> maps;
    for (const double shift : {0.0, 0.2, 0.4, 12.0}) maps.push_back(plane.map({shift, 0.0, 0.0}, all));
    const MergedMap merged = plane.merge({&maps[0], &maps[1], &maps[2], &maps[3]});
    for (int v = 0; v < plane.mesh.vertex_count(); ++v) {
        if (!maps[3].mapped[v]) continue;
        const double off = merged.map.position[v].x() - plane.mesh.position[v].x();
        EXPECT_GT(off, 0.15) << "vertex " << v;
        EXPECT_LT(off, 0.45) << "vertex " << v;
    }
}

TEST(Centroid, CoversTheUnionOfTheDomains) {
    const Plane plane;
    const PartialMap left = plane.map({0.0, 0.0, 0.0}, [](const Eigen::Vector3d& x) { return x.x() < 12.0; });
    const PartialMap right = plane.map({0.0, 0.0, 0.0}, [](const Eigen::Vector3d& x) { return x.x() > 8.0; });
    EXPECT_EQ(plane.merge({&left, &right}).map.count, plane.mesh.vertex_count());
}

TEST(MapDissimilarity, IsTwiceTheShiftOfTwoShiftedMaps) {
    const Plane plane;
    const std::vector<PartialMap> maps{plane.map({0.0, 0.0, 0.0}, all), plane.map({3.0, 0.0, 0.0}, all),
                                       plane.map({9.0, 0.0, 0.0}, all)};
    const Eigen::MatrixXd d = plane.dissimilarities(maps);
    EXPECT_EQ(d(0, 0), 0.0);
    EXPECT_EQ(d, d.transpose());
    EXPECT_NEAR(d(0, 1), 6.0, 0.1);
    // Beyond a cell of the table, distances are those by way of its centres.
    EXPECT_NEAR(d(0, 2), 18.0, 1.5);
    EXPECT_NEAR(plane.dissimilarities({maps[0], maps[0]})(0, 1), 0.0, 1e-12);
}

TEST(MapDissimilarity, IsInfiniteWithoutOverlap) {
    const Plane plane;
    const auto left = [](const Eigen::Vector3d& x) { return x.x() < 9.0; };
    const auto right = [](const Eigen::Vector3d& x) { return x.x() > 11.0; };
    // Apart on the source; and together there but apart on the target.
    EXPECT_EQ(plane.dissimilarities({plane.map({0.0, 0.0, 0.0}, left), plane.map({0.0, 0.0, 0.0}, right)})(0, 1),
              infinity);
    EXPECT_EQ(plane.dissimilarities({plane.map({0.0, 0.0, 0.0}, left), plane.map({10.0, 0.0, 0.0}, left)})(0, 1),
              infinity);
}

TEST(DistanceTable, IsWithinACellOfTheTruthAndNeverBelowTheStraightWay) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(4));
    Monitor monitor;
    const double cell = 4.0 * mesh.mean_edge;
    const DistanceTable table(mesh, cell, 2, monitor, 0.0, 1.0);
    for (int a = 0; a < mesh.vertex_count(); a += 97) {
        for (int b = 0; b < mesh.vertex_count(); b += 89) {
            const double straight = (mesh.position[a] - mesh.position[b]).norm();
            const double truth = 2.0 * std::asin(std::min(1.0, 0.5 * straight));
            EXPECT_GE(table(a, b), straight - 1e-12);
            EXPECT_NEAR(table(a, b), truth, 2.0 * cell);
            EXPECT_EQ(table(a, b), table(b, a));
        }
    }
}

}  // namespace
}  // namespace isograft
