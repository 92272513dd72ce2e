// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/flood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "geodesic/trace.h"
#include "shapes.h"

namespace isograft {
namespace {

/// A source, and a target that is the same mesh as `turn` of space moves it, perhaps reshaped.
struct Scene {
    TriangleMesh source, target;
    Eigen::Matrix3d turn;
    VertexLevels levels;

    Scene(const shapes::Shape& a, const shapes::Shape& b, const Eigen::Matrix3d& rotation, double near = 1.0)
        : source(shapes::mesh_of(a)), target(shapes::mesh_of(b)), turn(rotation) {
        Monitor monitor;
        levels = make_vertex_levels(source, 5, 2, monitor, 0.0, 1.0, near);
    }
    [[nodiscard]] OrientedMatch match(int s, int t, double angle = 0.0) const {
        const SurfacePoint p = point_near_vertex(target, t);
        const Eigen::Vector3d axis = turn * source.axis_x[levels.samples.point[s].face];
        return {s, p, unit(flatten(target, p.face, axis)) * std::polar(1.0, angle), 0.0};
    }
    [[nodiscard]] PartialMap grow(const OrientedMatch& match) const {
        Monitor monitor;
        return flood(levels, target, match, {}, monitor);
    }
    /// Largest distance of an image from the same vertex of the target, in e0.
    [[nodiscard]] double worst(const PartialMap& map) const {
        double most = 0.0;
        for (int v = 0; v < source.vertex_count(); ++v) {
            if (map.mapped[v]) most = std::max(most, (map.position[v] - target.position[v]).norm());
        }
        return most / levels.samples.spacing;
    }
};

Scene moved_blob() {
    const auto blob = shapes::blob(3);
    return {blob, shapes::moved(blob, shapes::some_rotation(), {1.0, 2.0, 0.5}), shapes::some_rotation()};
}

/// A plane, and the same plane with a tall bump in the middle.
Scene plane_and_hill() {
    const auto plane = shapes::grid(40, 40, 0.05, 0.05);
    auto hill = plane;
    for (Eigen::Index v = 0; v < hill.vertices.rows(); ++v) {
        const double r = (hill.vertices.row(v) - Eigen::RowVector3d(1.0, 1.0, 0.0)).norm();
        if (r < 0.3) hill.vertices(v, 2) = 0.5 * (1.0 + std::cos(M_PI * r / 0.3));
    }
    return {plane, hill, Eigen::Matrix3d::Identity(), 1.5};
}

TEST(Flood, MapsASurfaceOntoItselfVertexByVertex) {
    const Scene scene = moved_blob();
    for (const int seed : {0, 200, 500}) {
        const PartialMap map = scene.grow(scene.match(seed, seed));
        EXPECT_EQ(map.count, scene.source.vertex_count());
        EXPECT_LT(scene.worst(map), 0.3) << "seed " << seed;
    }
}

TEST(Flood, StopsWhereThePlaneWouldHaveToStretchOverTheHill) {
    const Scene scene = plane_and_hill();
    const int corner = 5 * 41 + 5;
    const PartialMap map = scene.grow(scene.match(corner, corner));
    int inside = 0, outside = 0, inside_mapped = 0, outside_mapped = 0;
    for (int v = 0; v < scene.source.vertex_count(); ++v) {
        const double r = (scene.source.position[v] - Eigen::Vector3d(1.0, 1.0, 0.0)).norm();
        if (r < 0.2) ++inside, inside_mapped += map.mapped[v];
        if (r > 0.45) ++outside, outside_mapped += map.mapped[v];
    }
    // Behind the hill fronts that came by different ways meet in cracks.
    EXPECT_GT(outside_mapped, 0.85 * outside);
    EXPECT_LT(inside_mapped, 0.6 * inside);
}

TEST(Flood, FromTheOppositeAngleStopsEarlierOrStrains) {
    const Scene scene = moved_blob();
    const PartialMap right = scene.grow(scene.match(100, 100)), wrong = scene.grow(scene.match(100, 100, M_PI));
    EXPECT_LT(wrong.count, right.count);
    EXPECT_GT(wrong.stress, 5.0 * right.stress);
}

TEST(Flood, TurnsRoundFromAWrongAngleWhereTheShapeTells) {
    const Scene scene = moved_blob();
    for (const double angle : {0.4, 0.8, -0.8}) {
        const PartialMap map = scene.grow(scene.match(100, 100, angle));
        EXPECT_EQ(map.count, scene.source.vertex_count()) << "angle " << angle;
        EXPECT_LT(scene.worst(map), 0.3) << "angle " << angle;
    }
}

TEST(Flood, MeasuresTheWayFromTheSeedInsideTheMap) {
    const Scene scene = moved_blob();
    const PartialMap map = scene.grow(scene.match(7, 7));
    EXPECT_EQ(map.seed_distance[7], 0.0F);
    for (int v = 0; v < scene.source.vertex_count(); ++v) {
        EXPECT_GE(map.seed_distance[v], (scene.source.position[v] - scene.source.position[7]).norm() * 0.95);
    }
}

TEST(FloodAll, TriesMatchesThatAMapExplainsAfterTheOthers) {
    const Scene scene = moved_blob();
    std::vector<OrientedMatch> matches;
    for (int v = 0; v < 40; ++v) matches.push_back(scene.match(v, v));
    matches.push_back(scene.match(50, 50, 2.0));  // the same place under another angle is another map
    Monitor monitor;
    const Floods few = flood_all(scene.levels, scene.target, matches, 9, {}, 2, monitor, 0.0, 1.0);
    ASSERT_EQ(few.maps.size(), 9U);  // the first batch, of which nothing was known, and the other angle
    EXPECT_EQ(few.maps.back().seed, 50);
    const Floods more = flood_all(scene.levels, scene.target, matches, 11, {}, 2, monitor, 0.0, 1.0);
    ASSERT_EQ(more.maps.size(), 11U);
    EXPECT_EQ(more.redundant, 32);
    EXPECT_EQ(more.maps.back().seed, 9);  // the second of those that waited
    // What no cluster holds comes after what is redundant.
    matches.back().score = std::numeric_limits<double>::infinity();
    EXPECT_NE(flood_all(scene.levels, scene.target, matches, 11, {}, 2, monitor, 0.0, 1.0).maps.back().seed, 50);
}

TEST(FloodAll, KeepsNoMapThatEndsAtOnce) {
    // Where T ends after a few edges every map does, whatever it is worth.
    const Scene scene(shapes::grid(40, 40, 0.05, 0.05), shapes::grid(6, 6, 0.05, 0.05), Eigen::Matrix3d::Identity());
    std::vector<OrientedMatch> matches;
    for (int v = 400; v < 900; v += 50) matches.push_back(scene.match(v, 24));
    Monitor monitor;
    const Floods floods = flood_all(scene.levels, scene.target, matches, 200, {}, 2, monitor, 0.0, 1.0);
    EXPECT_EQ(floods.tried, 10);
    EXPECT_TRUE(floods.maps.empty());
}

TEST(FloodAll, TriesNoMoreThanAskedFor) {
    const Scene scene = moved_blob();
    std::vector<OrientedMatch> matches;
    for (int v = 0; v < 40; ++v) matches.push_back(scene.match(v, v + 200));
    Monitor monitor;
    EXPECT_LE(flood_all(scene.levels, scene.target, matches, 11, {}, 2, monitor, 0.0, 1.0).tried, 11);
}

TEST(FloodAll, IsEqualBitForBitForAnyNumberOfThreads) {
    const Scene scene = plane_and_hill();
    std::vector<OrientedMatch> matches;
    for (int v = 0; v < 12; ++v) matches.push_back(scene.match(130 * v, 130 * v + v % 3, 0.1 * v));
    Monitor monitor;
    const Floods one = flood_all(scene.levels, scene.target, matches, 200, {}, 1, monitor, 0.0, 1.0);
    const Floods three = flood_all(scene.levels, scene.target, matches, 200, {}, 3, monitor, 0.0, 1.0);
    ASSERT_EQ(one.maps.size(), three.maps.size());
    for (std::size_t i = 0; i < one.maps.size(); ++i) {
        EXPECT_EQ(one.maps[i].mapped, three.maps[i].mapped);
        for (std::size_t s = 0; s < one.maps[i].position.size(); ++s) {
            EXPECT_EQ(one.maps[i].position[s], three.maps[i].position[s]);
        }
    }
}

TEST(FitMetric, BringsJitteredImagesBackToTheirDistances) {
    const Scene scene = moved_blob();
    PartialMap map(scene.source.vertex_count());
    Random random(3);
    for (int v = 0; v < scene.source.vertex_count(); ++v) {
        const OrientedMatch exact = scene.match(v, v);
        const Trace t = trace(scene.target, exact.point, std::polar(1.0, 2.0 * M_PI * random.uniform()),
                              0.25 * scene.levels.samples.spacing * random.uniform());
        map.put(scene.target, v, t.end, carry(scene.target, exact.point.face, t.end.face, exact.rotation));
    }
    Monitor monitor;
    MetricFitOptions options;
    options.iterations = 0;
    fit_metric(scene.levels.samples, scene.target, options, map, monitor);
    const double before = map.stress;
    options.iterations = 8;
    fit_metric(scene.levels.samples, scene.target, options, map, monitor);
    EXPECT_LT(map.stress, 0.25 * before);
    EXPECT_LT(scene.worst(map), 0.6);
}

TEST(FitMetric, TakesBackADriftThatGrewOverTheSurface) {
    const Scene scene = moved_blob();
    const Eigen::Vector3d up = scene.turn.col(2);
    std::vector<double> height;
    for (int v = 0; v < scene.target.vertex_count(); ++v) height.push_back(up.dot(scene.target.position[v]));
    const auto [bottom, top] = std::minmax_element(height.begin(), height.end());
    PartialMap drifted(scene.source.vertex_count());
    for (int v = 0; v < scene.source.vertex_count(); ++v) {
        const OrientedMatch exact = scene.match(v, v);
        // Towards the top, up to four spacings of the way round the axis.
        const Complex round = flatten(scene.target, exact.point.face, up.cross(scene.turn * scene.source.position[v]));
        const double length = 4.0 * scene.levels.samples.spacing * (height[v] - *bottom) / (*top - *bottom);
        const Trace t = trace(scene.target, exact.point, round, length);
        drifted.put(scene.target, v, t.end, carry(scene.target, exact.point.face, t.end.face, exact.rotation));
    }
    const auto fitted = [&](int iterations) {
        PartialMap map = drifted;
        Monitor monitor;
        fit_metric(scene.levels.samples, scene.target, {.iterations = iterations}, map, monitor);
        return map;
    };
    const PartialMap few = fitted(3), many = fitted(30), more = fitted(100);
    EXPECT_LT(many.stress, 0.5 * few.stress);
    EXPECT_LT(scene.worst(many), 0.5 * scene.worst(few));
    EXPECT_EQ(more.stress, many.stress) << "it ends by itself";
}

TEST(FitMetric, LeavesAnIsometryWhereItIs) {
    const Scene scene = moved_blob();
    PartialMap map(scene.source.vertex_count());
    for (int v = 0; v < scene.source.vertex_count(); ++v) {
        const OrientedMatch exact = scene.match(v, v);
        map.put(scene.target, v, exact.point, exact.rotation);
    }
    Monitor monitor;
    fit_metric(scene.levels.samples, scene.target, {}, map, monitor);
    EXPECT_LT(scene.worst(map), 0.05);
    EXPECT_LT(map.stress, 0.02);
}

}  // namespace
}  // namespace isograft
