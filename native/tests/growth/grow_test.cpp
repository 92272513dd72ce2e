// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/grow.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

Samples sample(const TriangleMesh& mesh, double spacing, std::uint64_t seed) {
    Monitor monitor;
    return make_samples(mesh, spacing, {}, seed, 2, monitor, 0.0, 1.0);
}

/// A source and a target that is the source's image under a known map of space.
struct Scene {
    TriangleMesh source_mesh;
    Samples source;
    SampledMesh target;

    Scene(const shapes::Shape& a, const shapes::Shape& b, int samples)
        : source_mesh(gate(a).mesh_with_paths()), target{gate(b).mesh_with_paths(), {}} {
        const double spacing = sample_spacing(source_mesh.area, samples);
        source = sample(source_mesh, spacing, 0);
        target.samples = sample(target.mesh, spacing, 1);
    }
    /// The map that holds sample `s` alone, put at `image` with the frame turned as `turn` of space does.
    [[nodiscard]] PartialMap seeded(int s, const Eigen::Vector3d& image, const Eigen::Matrix3d& turn) const {
        PartialMap map(source.count());
        const SurfacePoint p = shapes::point_nearest(target.mesh, image);
        const Eigen::Vector3d axis = turn * source_mesh.axis_x[source.point[s].face];
        map.put(target.mesh, s, p, unit(flatten(target.mesh, p.face, axis)));
        map.seed = s;
        return map;
    }
    /// Largest and mean distance of the images from where `where` says, in spacings.
    template <class Where>
    [[nodiscard]] std::pair<double, double> error(const PartialMap& map, Where&& where) const {
        double most = 0.0, sum = 0.0;
        for (int s = 0; s < source.count(); ++s) {
            if (!map.mapped[s]) continue;
            const double e = (map.position[s] - where(source.position[s])).norm() / source.spacing;
            most = std::max(most, e);
            sum += e / map.count;
        }
        return {most, sum};
    }
};

int counted(const PartialMap& map) { return static_cast<int>(std::count(map.mapped.begin(), map.mapped.end(), 1)); }

TEST(Grow, MapsASurfaceOntoItselfSampleBySample) {
    const Scene scene(shapes::blob(5), shapes::blob(5), 400);
    Grower grower(scene.source, scene.target, {});
    for (const int seed : {0, 100, 200}) {
        PartialMap map = scene.seeded(seed, scene.source.position[seed], Eigen::Matrix3d::Identity());
        grower.grow(map, {});
        EXPECT_EQ(map.count, counted(map));
        EXPECT_GE(map.count, 0.99 * scene.source.count());
        const auto [most, mean] = scene.error(map, [](const Eigen::Vector3d& x) { return x; });
        EXPECT_LT(mean, 0.02) << "seed " << seed;
        EXPECT_LT(most, 0.15) << "seed " << seed;
        EXPECT_LT(map.stress, 0.01);
        for (int s = 0; s < scene.source.count(); ++s) {
            if (!map.mapped[s]) continue;
            const Eigen::Vector3d before = scene.source_mesh.axis_x[scene.source.point[s].face];
            EXPECT_GT(lift(scene.target.mesh, map.image[s].face, map.rotation[s]).dot(before), 0.95);
        }
    }
}

TEST(Grow, FollowsRigidMotionAndRenumbering) {
    const Eigen::Matrix3d turn = shapes::some_rotation();
    const Eigen::Vector3d shift(3.0, -2.0, 1.0);
    const auto other = shapes::moved(shapes::renumbered(shapes::blob(5), 31).shape, turn, shift);
    const Scene scene(shapes::blob(5), other, 400);
    Grower grower(scene.source, scene.target, {});
    PartialMap map = scene.seeded(50, turn * scene.source.position[50] + shift, turn);
    grower.grow(map, {});
    EXPECT_GE(map.count, 0.99 * scene.source.count());
    const auto error = scene.error(map, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d { return turn * x + shift; });
    EXPECT_LT(error.second, 0.02);
}

TEST(Grow, StopsAtABoundaryWhereTheTargetIsCut) {
    const auto keep = [](const Eigen::Vector3d& x) { return x.z() < 0.1; };
    const Scene scene(shapes::blob(5), shapes::cut(shapes::blob(5), keep), 400);
    Grower grower(scene.source, scene.target, {});
    const int seed = static_cast<int>(std::min_element(scene.source.position.begin(), scene.source.position.end(),
                                                       [](const auto& a, const auto& b) { return a.z() < b.z(); }) -
                                      scene.source.position.begin());
    PartialMap map = scene.seeded(seed, scene.source.position[seed], Eigen::Matrix3d::Identity());
    grower.grow(map, {});
    int kept = 0, covered = 0;
    for (int s = 0; s < scene.source.count(); ++s) {
        const double z = scene.source.position[s].z();
        if (z < 0.1 - scene.source.spacing) {
            ++kept;
            covered += map.mapped[s] != 0;
        }
        if (z > 0.1 + 0.6 * scene.source.spacing) {
            EXPECT_FALSE(map.mapped[s]) << z;
        }
    }
    EXPECT_GT(kept, 100);
    EXPECT_GE(covered, 0.97 * kept);
    EXPECT_LT(scene.error(map, [](const Eigen::Vector3d& x) { return x; }).second, 0.04);
}

TEST(Grow, IsStoppedByStretchAndTheSoonerTheLowerTheLimit) {
    auto longer = shapes::blob(5);
    longer.vertices.col(0) *= 1.5;
    const Scene scene(shapes::blob(5), longer, 400);
    std::vector<int> counts;
    for (const double limit : {0.05, 0.15, 0.5}) {
        GrowthOptions options;
        options.stretch_limit = limit;
        Grower grower(scene.source, scene.target, options);
        PartialMap map = scene.seeded(10, scene.source.position[10].cwiseProduct(Eigen::Vector3d(1.5, 1, 1)),
                                      Eigen::Matrix3d::Identity());
        grower.grow(map, {});
        counts.push_back(map.count);
        // What was taken is near an isometry: not drawn out by a half.
        EXPECT_LT(map.stress, std::max(0.03, 0.4 * limit)) << limit;
    }
    EXPECT_TRUE(std::is_sorted(counts.begin(), counts.end()));
    EXPECT_LT(counts.front(), 0.8 * scene.source.count());
    EXPECT_LT(counts.back(), 0.9 * scene.source.count());
}

TEST(Grow, DoesNotCoverTheTargetTwice) {
    // A sheet wraps round a tube without any stretch, three times if it may.
    const double girth = 60 * 2.0 * std::sin(M_PI / 60);
    const Scene scene(shapes::grid(180, 20, girth / 60, 0.1), shapes::cylinder(60, 24, 1.0, 2.4), 500);
    const int seed = static_cast<int>(std::min_element(scene.source.position.begin(), scene.source.position.end(),
                                                       [&](const auto& a, const auto& b) {
                                                           const Eigen::Vector3d m(1.5 * girth, 1.0, 0.0);
                                                           return (a - m).norm() < (b - m).norm();
                                                       }) -
                                      scene.source.position.begin());
    const Eigen::Matrix3d turn = (Eigen::Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
    PartialMap map = scene.seeded(seed, {1.0, 0.0, 1.2}, turn);
    Grower grower(scene.source, scene.target, {});
    grower.grow(map, {});
    // Once round is a third of the sheet.
    EXPECT_GT(map.count, 0.25 * scene.source.count());
    EXPECT_LT(map.count, 0.40 * scene.source.count());
    std::vector<std::vector<char>> joined(scene.source.count(), std::vector<char>(scene.source.count(), 0));
    for (const SampleEdge& e : scene.source.edges) joined[e.u][e.v] = joined[e.v][e.u] = 1;
    for (int s = 0; s < scene.source.count(); ++s) {
        for (int t = 0; t < s; ++t) {
            if (!map.mapped[s] || !map.mapped[t] || joined[s][t]) continue;
            EXPECT_GT((map.position[s] - map.position[t]).norm(), 0.3 * scene.source.spacing);
        }
    }
}

TEST(Grow, TakesNoMoreSamplesThanAskedForAndNoneThatAreRefused) {
    const Scene scene(shapes::blob(4), shapes::blob(4), 300);
    Grower grower(scene.source, scene.target, {});
    GrowthRun run;
    run.max_samples = 40;
    PartialMap map = scene.seeded(7, scene.source.position[7], Eigen::Matrix3d::Identity());
    grower.grow(map, run);
    EXPECT_GE(map.count, 35);
    EXPECT_LE(map.count, 40);
    run.max_samples = 1 << 30;
    run.refuse = [&](int s, const SurfacePoint&, Complex) { return s % 8 == 1; };
    PartialMap refusing = scene.seeded(7, scene.source.position[7], Eigen::Matrix3d::Identity());
    grower.grow(refusing, run);
    int refused = 0;
    for (int s = 0; s < scene.source.count(); ++s) refused += refusing.mapped[s] && s % 8 == 1;
    // A map of six samples has no choice yet.
    EXPECT_LE(refused, 6);
    EXPECT_GT(refusing.count, 0.8 * scene.source.count());
}

TEST(Grow, GivesTheSameBitsFromUsedAndFromFreshMemory) {
    const Scene scene(shapes::blob(4), shapes::blob(4), 300);
    Grower used(scene.source, scene.target, {}), fresh(scene.source, scene.target, {});
    PartialMap first = scene.seeded(3, scene.source.position[3], Eigen::Matrix3d::Identity());
    used.grow(first, {});
    PartialMap a = scene.seeded(90, scene.source.position[90], Eigen::Matrix3d::Identity()), b = a;
    used.grow(a, {});
    fresh.grow(b, {});
    EXPECT_EQ(a.mapped, b.mapped);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.rotation, b.rotation);
    EXPECT_EQ(a.stress, b.stress);
}

TEST(PartialMap, MeasuresTheWayFromItsSeedInsideItself) {
    const Scene scene(shapes::grid(40, 40, 0.1, 0.1), shapes::grid(4, 4, 1.0, 1.0), 300);
    PartialMap map(scene.source.count());
    int seed = -1;
    for (int s = 0; s < scene.source.count(); ++s) {
        const Eigen::Vector3d x = scene.source.position[s];
        // An L, the seed at one end.
        if (x.x() < 1.0 || x.y() < 1.0) map.put(scene.target.mesh, s, scene.target.samples.point[0], Complex(1.0, 0.0));
        if (x.x() < 1.0 && (seed < 0 || x.y() > scene.source.position[seed].y())) seed = s;
    }
    map.seed = seed;
    measure_seed_distance(scene.source, map);
    for (int s = 0; s < scene.source.count(); ++s) {
        const double straight = (scene.source.position[s] - scene.source.position[seed]).norm();
        if (!map.mapped[s]) {
            EXPECT_GT(map.seed_distance[s], 1e6F);
        } else {
            EXPECT_GE(map.seed_distance[s], straight * 0.999);
            if (scene.source.position[s].x() > 3.0) {
                EXPECT_GT(map.seed_distance[s], 1.15 * straight);
            }
        }
    }
}

TEST(GrowthOptions, AreRefusedByName) {
    EXPECT_NO_THROW(GrowthOptions{}.validate());
    const auto refused = [](auto change) {
        GrowthOptions bad;
        change(bad);
        try {
            bad.validate();
        } catch (const InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    const auto names = [&](const std::string& text, const std::string& name) {
        return text.find("growth." + name) != std::string::npos;
    };
    const double nan = std::nan("");
    EXPECT_TRUE(names(refused([&](auto& o) { o.stretch_limit = nan; }), "stretch_limit"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.rotation_weight = -1.0; }), "rotation_weight"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.min_neighbours = 0; }), "min_neighbours"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.collision_radius = nan; }), "collision_radius"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.huber = 0.0; }), "huber"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.max_step = nan; }), "max_step"));
    EXPECT_TRUE(names(refused([&](auto& o) { o.iterations = 1000000; }), "iterations"));
}

}  // namespace
}  // namespace isograft
