// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/rimls.h"

#include <cmath>

#include <gtest/gtest.h>

#include "clouds.h"
#include "surface/cloud_graph.h"

namespace isograft {
namespace {

constexpr int count = 3000;

struct Fitted {
    std::vector<Eigen::Vector3d> positions, normals;
    std::vector<double> spacing;
};

// Points with their true normals: what RIMLS itself makes of them.
Fitted prepared(const clouds::Analytic& surface, double noise) {
    const Points points = clouds::sampled(surface, count, noise, 5);
    Fitted f;
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
        f.positions.emplace_back(points.row(i));
        f.normals.push_back(surface.normal(f.positions.back()));
        f.spacing.push_back(clouds::spacing_of(surface, count));
    }
    return f;
}

struct Errors {
    double height = 0.0, angle = 0.0, converged = 0.0;
};

// Root mean square height in spacings, mean angle of the normal, share of projections that ended on the surface.
Errors errors(const clouds::Analytic& surface, double noise) {
    const Fitted f = prepared(surface, noise);
    const KdTree tree(f.positions);
    const Rimls rimls(tree, f.normals, f.spacing);
    Errors e;
    double squares = 0.0;
    for (int i = 0; i < count; ++i) {
        const Rimls::Projection p = rimls.project(f.positions[i], f.normals[i]);
        const double height = surface.height(p.position) / f.spacing[i];
        squares += height * height / count;
        e.angle += std::acos(std::min(1.0, p.normal.dot(surface.normal(p.position)))) / count;
        e.converged += p.converged ? 1.0 / count : 0.0;
    }
    e.height = std::sqrt(squares);
    return e;
}

TEST(Rimls, PutsPointsOnTheSurfaceAndAveragesNoiseAway) {
    for (const clouds::Analytic& surface : clouds::all()) {
        // Planes at distance r lie r^2 H / 2 off a surface of mean curvature H, and the mean of r^2 under the weights
        // is 1.13 squared spacings: 0.066 spacings on the outer side of the torus, the most curved place of the four.
        const Errors clean = errors(surface, 0.0);
        EXPECT_LT(clean.height, 0.09) << surface.name;
        EXPECT_LT(clean.angle, 0.03) << surface.name;
        EXPECT_GT(clean.converged, 0.999) << surface.name;
        // 7.6 points carry the weight, which leaves 0.36 of the noise; 0.6 allows for unevenness and curvature.
        const Errors noisy = errors(surface, 0.2);
        EXPECT_LT(noisy.height, 0.6 * 0.2) << surface.name;
        EXPECT_LT(noisy.angle, 0.12) << surface.name;
        EXPECT_GT(noisy.converged, 0.99) << surface.name;
        RecordProperty(surface.name + "_height_in_percent_of_spacing", static_cast<int>(100.0 * noisy.height));
        RecordProperty(surface.name + "_angle_in_milliradians", static_cast<int>(1000.0 * noisy.angle));
    }
}

TEST(Rimls, KeepsAPlaneExactly) {
    const Errors e = errors(clouds::plane(), 0.0);
    EXPECT_LT(e.height, 1e-4);
    EXPECT_LT(e.angle, 1e-6);
}

TEST(Rimls, DoesNotSeePointsThatLookTheOtherWay) {
    // Two sheets half a spacing apart.
    Fitted f = prepared(clouds::plane(), 0.0);
    const double gap = 0.5 * f.spacing.front();
    for (int i = 0; i < count; ++i) {
        f.positions.push_back(f.positions[i] - Eigen::Vector3d(0.0, 0.0, gap));
        f.normals.push_back(-f.normals[i]);
        f.spacing.push_back(f.spacing[i]);
    }
    const KdTree tree(f.positions);
    const Rimls rimls(tree, f.normals, f.spacing);
    for (int i = 0; i < 2 * count; i += 50) {
        const Rimls::Projection p = rimls.project(f.positions[i] + 0.2 * f.spacing[i] * f.normals[i], f.normals[i]);
        EXPECT_TRUE(p.converged);
        EXPECT_NEAR(p.position.z(), i < count ? 0.0 : -gap, 1e-3 * gap);
    }
}

TEST(Rimls, SaysThatThereIsNoSurfaceFarFromAllPoints) {
    const Fitted f = prepared(clouds::sphere(), 0.0);
    const KdTree tree(f.positions);
    const Rimls rimls(tree, f.normals, f.spacing);
    EXPECT_FALSE(rimls.project({0.0, 0.0, 3.0}, {0.0, 0.0, 1.0}).converged);
}

}  // namespace
}  // namespace isograft
