// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "base/random.h"
#include "clouds.h"
#include "gate.h"
#include "geodesic/window.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

constexpr int count = 3000;

struct Relative {
    double mean = 0.0, worst_hundredth = 0.0;
};

// Distances from a point of the mesh against the true ones, relative; pairs nearer than a tenth of the farthest are
// left out, since there the height of noise alone is a per cent.
Relative distance_errors(const Surface& surface, const Eigen::Vector3d& start,
                         const std::function<double(const Eigen::Vector3d&)>& truth) {
    const TriangleMesh& mesh = surface.mesh_with_paths();
    Window window(mesh);
    window.run(shapes::point_nearest(mesh, start), 1e9);
    double farthest = 0.0;
    for (const Eigen::Vector3d& x : mesh.position) farthest = std::max(farthest, truth(x));
    std::vector<double> errors;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const double d = truth(mesh.position[v]);
        if (d > 0.1 * farthest) errors.push_back(window.has(v) ? std::abs(window.distance(v) / d - 1.0) : 1.0);
    }
    std::sort(errors.begin(), errors.end());
    return {shapes::mean(errors), errors[errors.size() * 99 / 100]};
}

void expect_distances(const clouds::Analytic& surface, const Eigen::Vector3d& start,
                      const std::function<double(const Eigen::Vector3d&)>& truth) {
    for (const double noise : {0.0, 0.2}) {
        const Surface cloud = Surface::from_points(clouds::sampled(surface, count, noise, 8));
        const Relative e = distance_errors(cloud, start, truth);
        // Windows are good to a per cent on obtuse triangles. What noise is left, 0.07 spacings at vertices 1.2 apart,
        // lengthens paths by half the square of its slope, 0.4 %; one window's centre lies off by as much.
        EXPECT_LT(e.mean, 0.015) << surface.name << noise;
        EXPECT_LT(e.worst_hundredth, 0.04) << surface.name << noise;
        testing::Test::RecordProperty(surface.name + (noise > 0.0 ? "_noisy" : "_clean") + "_mean_error_in_1e-4",
                                      static_cast<int>(1e4 * e.mean));
    }
}

TEST(Cloud, HasTheDistancesOfASphere) {
    expect_distances(clouds::sphere(), {0.0, 0.6, 0.8}, [](const Eigen::Vector3d& x) {
        return std::acos(std::clamp(x.normalized().dot(Eigen::Vector3d(0.0, 0.6, 0.8)), -1.0, 1.0));
    });
}

TEST(Cloud, HasTheDistancesOfAPlane) {
    expect_distances(clouds::plane(), {0.4, 0.5, 0.0},
                     [](const Eigen::Vector3d& x) { return std::hypot(x.x() - 0.4, x.y() - 0.5); });
}

TEST(Cloud, HasTheDistancesOfACylinder) {
    expect_distances(clouds::cylinder(), {0.3, 0.0, 0.5},
                     [](const Eigen::Vector3d& x) { return std::hypot(0.3 * std::atan2(x.y(), x.x()), x.z() - 0.5); });
}

TEST(Cloud, HasTheDistancesOfATorusAlongItsMeridians) {
    const Surface cloud = Surface::from_points(clouds::sampled(clouds::torus(), count, 0.2, 8));
    Window window(cloud.mesh_with_paths());
    window.run(shapes::point_nearest(cloud.mesh_with_paths(), {1.4, 0.0, 0.0}), 1e9);
    double sum = 0.0;
    for (const double angle : {0.8, 1.6, 2.4}) {
        const Eigen::Vector3d x(1.0 + 0.4 * std::cos(angle), 0.0, 0.4 * std::sin(angle));
        const auto found = window.query(shapes::point_nearest(cloud.mesh_with_paths(), x));
        ASSERT_TRUE(found);
        // Noise is left at both ends.
        EXPECT_NEAR(found->distance / (0.4 * angle), 1.0, 0.05) << angle;
        sum += std::abs(found->distance / (0.4 * angle) - 1.0);
    }
    RecordProperty("torus_noisy_mean_error_in_1e-4", static_cast<int>(1e4 * sum / 3.0));
}

TEST(Cloud, HasTheTopologyOfItsSurfaceAndNoHolesButThose) {
    const std::vector<std::pair<clouds::Analytic, clouds::Topology>> expected{{clouds::sphere(), {0, 0, 2}},
                                                                              {clouds::torus(), {0, 0, 0}},
                                                                              {clouds::plane(), {1, 1, 1}},
                                                                              {clouds::cylinder(), {1, 2, 0}}};
    for (const auto& [surface, topology] : expected) {
        for (const double noise : {0.0, 0.2}) {
            const Surface cloud = Surface::from_points(clouds::sampled(surface, count, noise, 7));
            const clouds::Topology t = clouds::topology(cloud.mesh());
            EXPECT_EQ(t.loops, topology.loops) << surface.name << noise;
            EXPECT_EQ(t.euler, topology.euler) << surface.name << noise;
            EXPECT_EQ(t.open_edges > 0, topology.open_edges > 0) << surface.name << noise;
            EXPECT_EQ(cloud.mesh().component_count, 1) << surface.name;
            expect_manifold(cloud.mesh());
            // A rim is known to half a spacing.
            EXPECT_NEAR(cloud.mesh().area / surface.area, 1.0, 0.08) << surface.name << noise;
            EXPECT_EQ(std::count(cloud.cloud_vertex().begin(), cloud.cloud_vertex().end(), -1), 0) << surface.name;
        }
    }
}

TEST(Cloud, KeepsAHoleOfTheDataOpen) {
    const Points all = clouds::sampled(clouds::plane(), count, 0.0, 9);
    Points kept(0, 3);
    for (Eigen::Index i = 0; i < all.rows(); ++i) {
        if (std::hypot(all(i, 0) - 0.5, all(i, 1) - 0.5) > 0.1) {
            kept.conservativeResize(kept.rows() + 1, 3);
            kept.row(kept.rows() - 1) = all.row(i);
        }
    }
    const Surface surface = Surface::from_points(kept);
    const TriangleMesh& mesh = surface.mesh();
    EXPECT_EQ(clouds::topology(mesh).loops, 2);
    EXPECT_EQ(clouds::topology(mesh).euler, 0);
    for (const auto& f : mesh.face) {
        const Eigen::Vector3d centre = (mesh.position[f[0]] + mesh.position[f[1]] + mesh.position[f[2]]) / 3.0;
        // A rim triangle reaches in no deeper than the circle that may be filled is wide.
        EXPECT_GT(std::hypot(centre.x() - 0.5, centre.y() - 0.5),
                  0.1 - 2.0 * clouds::spacing_of(clouds::plane(), count));
    }
}

TEST(Cloud, DoesNotBridgeTwoCloseSheets) {
    const Points lower = clouds::sampled(clouds::plane(), count, 0.1, 10);
    Points upper = clouds::sampled(clouds::plane(), count, 0.1, 11);
    const double gap = 3.0 * clouds::spacing_of(clouds::plane(), count);
    upper.col(2).array() += gap;
    const Surface surface = Surface::from_points(clouds::joined(lower, upper));
    for (const auto& f : surface.mesh().face) {
        const double first = surface.mesh().position[f[0]].z(), second = surface.mesh().position[f[1]].z(),
                     third = surface.mesh().position[f[2]].z();
        EXPECT_LT(std::max({first, second, third}) - std::min({first, second, third}), 0.5 * gap);
    }
    EXPECT_EQ(surface.mesh().component_count, 2);
}

TEST(Cloud, LeavesOutliersOutAndSaysHowMany) {
    const Points inside = clouds::sampled(clouds::sphere(), count, 0.1, 12);
    Random random(13);
    Points stray(60, 3);
    for (Eigen::Index i = 0; i < stray.rows(); ++i) {
        // In a box twice as wide, away from the surface by more than any outlier test could forgive.
        Eigen::Vector3d x;
        do {
            x = Eigen::Vector3d(4.0 * random.uniform() - 2.0, 4.0 * random.uniform() - 2.0,
                                4.0 * random.uniform() - 2.0);
        } while (std::abs(x.norm() - 1.0) < 0.3);
        stray.row(i) = x;
    }
    const Surface surface = Surface::from_points(clouds::joined(inside, stray));
    EXPECT_TRUE(warns(surface, "outliers")) << surface.warnings().size();
    for (int i = 0; i < 60; ++i) EXPECT_EQ(surface.cloud_vertex()[count + i], -1);
    const auto lost = std::count(surface.cloud_vertex().begin(), surface.cloud_vertex().begin() + count, -1);
    EXPECT_LE(lost, count / 200);
    EXPECT_EQ(clouds::topology(surface.mesh()).euler, 2);
}

TEST(Cloud, OfMorePointsThanAMapCanUseIsThinnedAndAllItsPointsKeepTheirPlace) {
    const Surface surface = Surface::from_points(clouds::sampled(clouds::sphere(), 70000, 0.1, 20));
    EXPECT_LT(surface.mesh().vertex_count(), 21000);
    EXPECT_GT(surface.mesh().vertex_count(), 15000);
    EXPECT_EQ(clouds::topology(surface.mesh()).euler, 2);
    ASSERT_EQ(surface.cloud_vertex().size(), 70000U);
    EXPECT_EQ(std::count(surface.cloud_vertex().begin(), surface.cloud_vertex().end(), -1), 0);
}

TEST(Cloud, DoesNotDependOnNumberingPlaceOrUnit) {
    const clouds::Analytic torus = clouds::torus();
    const Points points = clouds::sampled(torus, count, 0.2, 14);
    const Surface first = Surface::from_points(points);
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    Random(15).shuffle(order);
    const Eigen::Matrix3d rotation = shapes::some_rotation();
    Points other(count, 3);
    for (int i = 0; i < count; ++i) {
        other.row(i) =
            (1000.0 * rotation * points.row(order[i]).transpose() + Eigen::Vector3d(5e3, -2e4, 7e3)).transpose();
    }
    const Surface second = Surface::from_points(other);
    EXPECT_NEAR(second.mesh().area / first.mesh().area, 1e6, 1e6 * 1e-3);
    EXPECT_NEAR(second.mesh().vertex_count(), first.mesh().vertex_count(), 0.01 * first.mesh().vertex_count());
    EXPECT_EQ(clouds::topology(second.mesh()).euler, clouds::topology(first.mesh()).euler);
    double angle = 0.0;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d turned = rotation * first.normals().row(order[i]).transpose();
        angle += std::acos(std::clamp(turned.dot(second.normals().row(i).transpose()), -1.0, 1.0)) / count;
    }
    EXPECT_LT(angle, 1e-3);
}

TEST(Cloud, TellsTheOuterSideOfClosedSurfacesOnly) {
    EXPECT_FALSE(Surface::from_points(clouds::sampled(clouds::torus(), count, 0.1, 16)).orientation_is_ambiguous());
    const Surface open = Surface::from_points(clouds::sampled(clouds::plane(), 1000, 0.1, 16));
    EXPECT_TRUE(open.orientation_is_ambiguous());
    const Surface turned = open.with_open_parts_reversed();
    EXPECT_EQ(turned.normals(), -open.normals());
    EXPECT_EQ(turned.mesh().normal.front(), -open.mesh().normal.front());
    EXPECT_EQ(turned.cloud_vertex(), open.cloud_vertex());
}

TEST(Cloud, RefusesRepeatedPointsWithTheFirstOfThem) {
    const Points points = clouds::sampled(clouds::sphere(), 1000, 0.0, 17);
    const std::string told = clouds::refusal(clouds::joined(points, points.middleRows(5, 100)));
    EXPECT_NE(told.find("100 rows of 1100 equal an earlier one, the first is row 1000, equal to row 5"),
              std::string::npos)
        << told;
    EXPECT_NE(told.find("keep one of each"), std::string::npos);
}

TEST(Cloud, RefusesWhatMakesNoSurfaceWithWhatAndWhere) {
    const Points good = clouds::sampled(clouds::sphere(), 200, 0.0, 18);
    EXPECT_NE(clouds::refusal(good.topRows(49)).find("49 rows"), std::string::npos);
    Points bad = good;
    bad(7, 1) = bad(9, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(clouds::refusal(bad).find("2 rows, the first is row 7"), std::string::npos) << clouds::refusal(bad);
    const Points one = good.topRows(40).replicate(4, 1);
    EXPECT_NE(clouds::refusal(one).find("120 rows of 160 equal"), std::string::npos) << clouds::refusal(one);
    Points line = good;
    line.rightCols(2).setZero();
    EXPECT_NE(clouds::refusal(line).find("on a line"), std::string::npos) << clouds::refusal(line);
    EXPECT_NE(clouds::refusal(good, good.topRows(3)).find("`normals` has 3 rows, `vertices` has 200"),
              std::string::npos);
    Points normals = good;
    normals.row(5).setZero();
    EXPECT_NE(clouds::refusal(good, normals).find("no length in 1 row, the first is row 5"), std::string::npos)
        << clouds::refusal(good, normals);
    normals(3, 0) = std::numeric_limits<double>::infinity();
    EXPECT_NE(clouds::refusal(good, normals).find("row 3"), std::string::npos);
}

TEST(Cloud, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW((void)Surface::from_points(clouds::sampled(clouds::sphere(), 500, 0.0, 19), Points(0, 3), &monitor),
                 Cancelled);
}

}  // namespace
}  // namespace isograft
