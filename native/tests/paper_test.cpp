// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"
#include "surface/cloud_graph.h"

namespace isograft {
namespace {

MatchOptions small() {
    MatchOptions options = preset_options("paper");
    options.paper.matches = 24;
    options.scale.mode = ScaleMode::fixed;
    options.threads = 2;
    return options;
}

/// Share of all source vertices within `radius` of where `truth` puts them.
double right(const Correspondence& c, const Points& truth, double radius) {
    int count = 0;
    for (Eigen::Index v = 0; v < c.face.size(); ++v) {
        if (c.face[v] >= 0 && (c.points.row(v) - truth.row(v)).norm() < radius) ++count;
    }
    return count / static_cast<double>(c.face.size());
}

bool told(const MatchReport& report, const std::string& text) {
    return std::any_of(report.warnings.begin(), report.warnings.end(),
                       [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

TEST(Paper, HasThePrintedParameters) {
    const PaperOptions p = preset_options("paper").paper;
    EXPECT_TRUE(p.steps);
    EXPECT_FALSE(preset_options("default").paper.steps);
    EXPECT_EQ(p.levels, 5);
    EXPECT_EQ(p.contours, 10);
    EXPECT_EQ(p.radius_min, 0.9);
    EXPECT_EQ(p.radius_max, 1.7);
    EXPECT_EQ(p.candidates, 10);
    EXPECT_EQ(p.descriptor_weight, 400.0);
    EXPECT_EQ(p.distance_weight, 1.0 / 8.0);
    EXPECT_EQ(p.cluster_limit, 11.5);
    EXPECT_EQ(p.matches, 200);
    EXPECT_EQ(p.stretch_limit, 0.5);
    EXPECT_EQ(p.threshold, 1.0);
    EXPECT_EQ(p.decay, 5.0);
    EXPECT_EQ(graph_neighbours, 8);
}

TEST(Paper, MeasuresInTheUnitsThatArePrinted) {
    PaperOptions p = preset_options("paper").paper;
    // R is 5 % of a diameter of 20, so 1.
    std::vector<double> radii = contour_radii(p, 20.0);
    ASSERT_EQ(radii.size(), 10U);
    for (int k = 0; k < 10; ++k) EXPECT_NEAR(radii[k], 0.9 + k * 0.8 / 9.0, 1e-12);
    p.radius_min = 1.5;
    p.radius_max = 3.4;
    radii = contour_radii(p, 40.0);
    EXPECT_NEAR(radii.front(), 3.0, 1e-12);
    EXPECT_NEAR(radii.back(), 6.8, 1e-12);
    // w_C = 1 / (8 e0^2), 1 / k_ds = 5 e1 = 10 e0.
    EXPECT_DOUBLE_EQ(stretch_weight(p, 0.5), 0.5);
    EXPECT_DOUBLE_EQ(merge_decay(p, 0.5), 5.0);
}

TEST(Paper, MapsABodyOntoItsMovedSelf) {
    const auto shape = shapes::blob(3);
    const auto moved = shapes::moved(shape, shapes::some_rotation(), {1.0, 2.0, 3.0});
    const Surface source = gate(shape), target = gate(moved);
    const Match found = match(source, target, small());
    EXPECT_GT(right(found.best(), moved.vertices, 0.5 * source.mesh().mean_edge), 0.95);
    EXPECT_GT(found.report.maps_grown, 0);
    ASSERT_EQ(found.report.stages.size(), 6U);
    EXPECT_EQ(found.report.stages[3].name, "growth");
}

TEST(Paper, IsEqualBitForBitForAnyNumberOfThreads) {
    const Surface source = gate(shapes::blob(3)), target = gate(shapes::noisy(shapes::blob(3), 0.003, 1));
    MatchOptions options = small();
    options.paper.matches = 12;
    options.threads = 1;
    const Match one = match(source, target, options);
    options.threads = 3;
    const Match three = match(source, target, options);
    EXPECT_EQ(one.best().face, three.best().face);
    for (Eigen::Index v = 0; v < one.best().face.size(); ++v) {
        if (one.best().face[v] < 0) continue;
        EXPECT_EQ(one.best().points.row(v), three.best().points.row(v));
    }
}

TEST(Paper, DecimatesLargeInputsAndSaysSo) {
    const Surface source = gate(shapes::blob(4));
    MatchOptions options = small();
    options.paper.matches = 8;
    options.paper.vertices = 500;
    const Match found = match(source, source, options);
    EXPECT_TRUE(told(found.report, "source: decimated from 2562 to "));
    EXPECT_LT(found.report.source_samples, 700);
    EXPECT_EQ(found.best().face.size(), source.vertices().rows());
    options.paper.vertices = 10000;
    options.paper.matches = 1;
    EXPECT_FALSE(told(match(source, source, options).report, "decimated"));
}

TEST(Paper, WorksOnTenThousandVerticesAtMostUnlessToldOtherwise) {
    MatchOptions options = preset_options("paper");
    options.scale.mode = ScaleMode::fixed;
    options.threads = 2;
    // What contradicts itself is not grown: only the size is of interest here.
    options.seed.landmarks_only = true;
    options.landmarks = {{0, 0}, {50, 5000}};
    const Surface larger = gate(shapes::grid(104, 99, 1.0, 1.0)), largest = gate(shapes::grid(99, 99, 1.0, 1.0));
    const Match decimated = match(larger, largest, options), whole = match(largest, larger, options);
    EXPECT_TRUE(told(decimated.report, "source: decimated from 10500 to "));
    EXPECT_FALSE(told(decimated.report, "target: decimated"));
    EXPECT_NEAR(decimated.report.source_samples, 10000, 10);
    EXPECT_EQ(decimated.report.target_samples, 10000);
    EXPECT_TRUE(told(whole.report, "target: decimated from 10500 to "));
    EXPECT_FALSE(told(whole.report, "source: decimated"));
    EXPECT_EQ(whole.report.source_samples, 10000);
}

TEST(Paper, StartsFromLandmarksAlone) {
    const auto shape = shapes::blob(3);
    const Surface surface = gate(shape);
    MatchOptions options = small();
    options.seed.landmarks_only = true;
    options.landmarks = {{10, 10}, {400, 400}};
    const Match found = match(surface, surface, options);
    EXPECT_LE(found.report.seeds_tried, 2);
    EXPECT_GT(right(found.best(), shape.vertices, 0.5 * surface.mesh().mean_edge), 0.9);
    options.landmarks.pop_back();
    EXPECT_THROW(match(surface, surface, options), InvalidInput);
}

TEST(Paper, MixesLandmarksWithItsOwnFeatures) {
    const auto shape = shapes::blob(3);
    const auto moved = shapes::moved(shape, shapes::some_rotation(), {1.0, 2.0, 3.0});
    MatchOptions options = small();
    options.landmarks = {{10, 10}, {400, 400}};
    const Surface source = gate(shape);
    const Match found = match(source, gate(moved), options);
    // Two landmarks give six oriented matches at most, with three directions each.
    EXPECT_EQ(found.report.seeds_tried, 24);
    EXPECT_GT(right(found.best(), moved.vertices, 0.5 * source.mesh().mean_edge), 0.95);
}

TEST(Paper, LeavesAllUnmatchedWhereNothingGrows) {
    // Twelve vertices are fewer than one neighbourhood.
    const Surface surface = gate(shapes::sphere(0));
    const Match found = match(surface, surface, small());
    ASSERT_EQ(found.correspondences.size(), 1U);
    EXPECT_EQ(found.best().matched(), 0);
    EXPECT_TRUE(told(found.report, "no feature match could be grown"));
}

TEST(Paper, RefusesParametersOutOfRangeByName) {
    MatchOptions options = small();
    options.paper.radius_min = 2.0;
    try {
        options.validate();
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("paper.radius_min"), std::string::npos);
    }
}

TEST(Paper, StopsWhenCancelled) {
    const Surface surface = gate(shapes::blob(4));
    Monitor monitor([](const std::string& stage, double) { return stage != "growth"; });
    EXPECT_THROW(match(surface, surface, small(), &monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
