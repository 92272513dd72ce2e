// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_normals.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "clouds.h"

namespace isograft {
namespace {

std::vector<Eigen::Vector3d> rows(const Points& points) {
    std::vector<Eigen::Vector3d> list;
    for (Eigen::Index i = 0; i < points.rows(); ++i) list.emplace_back(points.row(i));
    return list;
}

struct Estimate {
    std::vector<Eigen::Vector3d> positions, normals;
    CloudSides sides;
};

Estimate estimate(const Points& points, const std::vector<Eigen::Vector3d>& given = {}) {
    Monitor monitor;
    Estimate e;
    e.positions = rows(points);
    const KdTree tree(e.positions);
    const CloudGraph graph = neighbour_graph(tree, graph_neighbours, monitor);
    e.normals = given.empty() ? fit_normals(tree, graph, monitor) : given;
    e.sides = orient_normals(tree, graph, given, e.normals, monitor);
    if (given.empty()) refit_normals(tree, graph, e.normals, monitor);
    return e;
}

double share_outward(const Estimate& e, const clouds::Analytic& surface) {
    double outward = 0.0;
    for (std::size_t i = 0; i < e.normals.size(); ++i) {
        outward += e.normals[i].dot(surface.normal(e.positions[i])) > 0.0;
    }
    return outward / static_cast<double>(e.normals.size());
}

TEST(CloudNormals, PointOutwardEverywhereOnSurfacesThatCloseAboutAnInside) {
    for (const auto& surface : {clouds::sphere(), clouds::torus()}) {
        for (const double noise : {0.0, 0.2}) {
            const Estimate e = estimate(clouds::sampled(surface, 3000, noise, 2));
            EXPECT_EQ(share_outward(e, surface), 1.0) << surface.name << noise;
            ASSERT_EQ(e.sides.closedness.size(), 1U);
            // What lies within two spacings is not asked: the share of a sphere that is missing.
            EXPECT_GT(e.sides.closedness[0], 0.8) << surface.name;
        }
    }
}

TEST(CloudNormals, OfAnOpenSheetAgreeWithEachOtherAndAreSaidToHaveNoOuterSide) {
    const Estimate e = estimate(clouds::sampled(clouds::plane(), 2000, 0.2, 2));
    const double outward = share_outward(e, clouds::plane());
    EXPECT_TRUE(outward == 0.0 || outward == 1.0) << outward;
    EXPECT_LT(e.sides.closedness[0], 0.2);
}

TEST(CloudNormals, AreAsExactAsAPlaneFittedToAsManyPointsCanBe) {
    // 24 points in a disk of radius 2.8 spacings with linear weights have a second moment of about 40 squared spacings
    // an axis: noise of 0.2 tilts the plane by 0.2 / sqrt(40) an axis, 0.04 in the mean of both; curvature is even.
    for (const auto& surface : clouds::all()) {
        const Estimate e = estimate(clouds::sampled(surface, 3000, 0.2, 3));
        double angle = 0.0;
        for (std::size_t i = 0; i < e.normals.size(); ++i) {
            const double cosine = std::abs(e.normals[i].dot(surface.normal(e.positions[i])));
            angle += std::acos(std::min(1.0, cosine)) / static_cast<double>(e.normals.size());
        }
        EXPECT_LT(angle, 0.08) << surface.name;
        RecordProperty(surface.name + "_angle_in_milliradians", static_cast<int>(1000.0 * angle));
    }
}

TEST(CloudNormals, OfTwoCloseSheetsThatFaceEachOtherKeepTheirOwnSides) {
    // A flat box: lid and floor 3 spacings apart, walls between.
    const int count = 4000;
    const double gap = 3.0 / std::sqrt(count);
    Random random(4);
    Points points(2 * count + 400, 3);
    for (int i = 0; i < 2 * count; ++i) points.row(i) << random.uniform(), random.uniform(), i < count ? 0.0 : gap;
    for (int i = 2 * count; i < points.rows(); ++i) {
        const double along = random.uniform(), up = gap * random.uniform();
        const int wall = i % 4;
        points.row(i) << (wall < 2 ? along : wall - 2.0), (wall < 2 ? wall : along), up;
    }
    const Estimate e = estimate(points);
    int wrong = 0;
    for (int i = 0; i < 2 * count; ++i) wrong += e.normals[i].z() * (i < count ? -1.0 : 1.0) <= 0.0;
    // Points at the rim lean with the walls.
    EXPECT_LT(wrong, 2 * count / 100);
}

TEST(CloudNormals, ThatWereGivenAreTurnedWhereTheyContradictTheirNeighboursAndCounted) {
    const clouds::Analytic surface = clouds::sphere();
    const Points points = clouds::sampled(surface, 2000, 0.0, 6);
    std::vector<Eigen::Vector3d> given;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        given.push_back(surface.normal(points.row(i)) * (i % 10 == 0 ? -1.0 : 1.0));
    }
    const Estimate e = estimate(points, given);
    EXPECT_EQ(share_outward(e, surface), 1.0);
    EXPECT_EQ(e.sides.turned, 200);
}

}  // namespace
}  // namespace isograft
