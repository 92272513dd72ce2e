// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/feature_seeds.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "shapes.h"

namespace isograft {
namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

/// The same vertices of a plane and of the plane as some_rotation() turns it.
struct Scene {
    TriangleMesh source = shapes::mesh_of(shapes::grid(20, 20, 0.1, 0.1));
    TriangleMesh target =
        shapes::mesh_of(shapes::moved(shapes::grid(20, 20, 0.1, 0.1), shapes::some_rotation(), {1.0, 0.0, 2.0}));
    FeaturePlaces places;
    FeatureGeodesics on_source, on_target;

    Scene() { add({100, 320, 205}); }
    void add(const std::vector<int>& vertices) {
        places.source.insert(places.source.end(), vertices.begin(), vertices.end());
        std::vector<SurfacePoint> points;
        places.target.clear();
        for (const int v : places.source) {
            points.push_back(point_near_vertex(source, v));
            places.target.push_back(point_near_vertex(target, v));
        }
        Monitor monitor;
        on_source = feature_geodesics(source, points, everywhere, 2, monitor, 0.0, 1.0);
        on_target = feature_geodesics(target, places.target, everywhere, 2, monitor, 0.0, 1.0);
    }
};

TEST(FeatureSeeds, TurnFramesAsTheMotionOfTheSurfaceDoes) {
    const Scene scene;
    const std::vector<FeatureMatch> matches{{0, 0, 0.0, 2.0}, {1, 1, 0.0, 1.0}, {2, 2, 0.0, 3.0}};
    const auto seeds =
        feature_seeds(matches, scene.places, scene.on_source, scene.on_target, {1.0, 11.5, everywhere}, 0.2);
    ASSERT_EQ(seeds.size(), 6U);  // two directions for each
    EXPECT_EQ(seeds[0].sample, scene.places.source[1]);
    EXPECT_EQ(seeds[1].sample, scene.places.source[0]);
    EXPECT_EQ(seeds[2].sample, scene.places.source[2]);
    for (const OrientedMatch& seed : seeds) {
        const int face = point_near_vertex(scene.source, seed.sample).face;
        const Eigen::Vector3d axis = shapes::some_rotation() * scene.source.axis_x[face];
        EXPECT_LT(std::abs(seed.rotation - flatten(scene.target, seed.point.face, axis)), 1e-6);
    }
}

TEST(FeatureSeeds, TakeTheirDirectionFromTheNeighbourThatKeepsItsDistance) {
    const Scene scene;
    // A likelier match of feature 2 that lies elsewhere must not give the direction.
    const std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 1.0}, {2, 1, -0.5, 2.0}};
    const auto seeds =
        feature_seeds(matches, scene.places, scene.on_source, scene.on_target, {100.0, 11.5, everywhere}, 0.2);
    ASSERT_FALSE(seeds.empty());
    const int face = point_near_vertex(scene.source, seeds[0].sample).face;
    const Eigen::Vector3d axis = shapes::some_rotation() * scene.source.axis_x[face];
    EXPECT_LT(std::abs(seeds[0].rotation - flatten(scene.target, seeds[0].point.face, axis)), 1e-6);
}

TEST(FeatureSeeds, TakeTheDirectionThatMostNeighboursAgreeOn) {
    Scene scene;
    scene.add({55, 160, 260});
    // The likeliest neighbour by itself keeps its distance but lies in another direction, as mirror images do.
    std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 1.0}, {2, 2, 0.0, 1.0}, {3, 3, 0.0, 1.0}};
    matches.push_back({4, 1, -0.5, 2.0});
    const double on_target = scene.on_target.distance(0, 1);
    scene.on_source.distance(0, 4) = on_target;
    const auto seeds =
        feature_seeds(matches, scene.places, scene.on_source, scene.on_target, {100.0, 11.5, everywhere}, 0.2);
    ASSERT_FALSE(seeds.empty());
    EXPECT_EQ(seeds[0].sample, scene.places.source[0]);
    const int face = point_near_vertex(scene.source, seeds[0].sample).face;
    const Eigen::Vector3d axis = shapes::some_rotation() * scene.source.axis_x[face];
    EXPECT_LT(std::abs(seeds[0].rotation - flatten(scene.target, seeds[0].point.face, axis)), 1e-6);
}

TEST(FeatureSeeds, NeedANeighbourFarEnoughToPointAt) {
    const Scene scene;
    const std::vector<FeatureMatch> matches{{0, 0, 0.0, 0.0}, {1, 1, 0.0, 1.0}};
    const ClusterOptions options{1.0, 11.5, everywhere};
    EXPECT_TRUE(feature_seeds(matches, scene.places, scene.on_source, scene.on_target, options, 50.0).empty());
    EXPECT_TRUE(feature_seeds({matches[0]}, scene.places, scene.on_source, scene.on_target, options, 0.1).empty());
}

}  // namespace
}  // namespace isograft
