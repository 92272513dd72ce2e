// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/match.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "isograft/errors.h"
#include "matches.h"
#include "shapes.h"

namespace isograft {
namespace {

using matches::expect_same_bits;
using matches::quick;
using matches::Score;
using matches::score;
using matches::spacing;
using shapes::bumped;

void expect_well_formed(const Correspondence& c, const Surface& source, const Surface& target) {
    const Eigen::Index n = source.vertices().rows();
    ASSERT_EQ(c.face.size(), n);
    ASSERT_EQ(c.barycentric.rows(), n);
    ASSERT_EQ(c.points.rows(), n);
    ASSERT_EQ(c.vertex.size(), n);
    ASSERT_EQ(c.confidence.size(), n);
    ASSERT_EQ(c.stretch.size(), n);
    ASSERT_EQ(c.region.size(), n);
    for (Eigen::Index v = 0; v < n; ++v) {
        if (c.face[v] < 0) {
            EXPECT_EQ(c.face[v], -1);
            EXPECT_EQ(c.vertex[v], -1);
            EXPECT_EQ(c.region[v], -1);
            EXPECT_EQ(c.confidence[v], 0.0);
            EXPECT_TRUE(std::isnan(c.stretch[v]));
            EXPECT_TRUE(c.barycentric.row(v).array().isNaN().all());
            EXPECT_TRUE(c.points.row(v).array().isNaN().all());
            continue;
        }
        ASSERT_LT(c.face[v], target.faces().rows());
        EXPECT_GE(c.barycentric.row(v).minCoeff(), 0.0);
        EXPECT_NEAR(c.barycentric.row(v).sum(), 1.0, 1e-9);
        Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
        for (int k = 0; k < 3; ++k) x += c.barycentric(v, k) * target.vertices().row(target.faces()(c.face[v], k));
        EXPECT_LT((x - c.points.row(v)).norm(), 1e-9);
        Eigen::Index largest = 0;
        c.barycentric.row(v).maxCoeff(&largest);
        EXPECT_EQ(c.vertex[v], target.faces()(c.face[v], largest));
        EXPECT_GE(c.confidence[v], 0.0);
        EXPECT_LE(c.confidence[v], 1.0);
        EXPECT_GE(c.stretch[v], 0.0);
        EXPECT_GE(c.region[v], 0);
    }
}

TEST(Match, FindsASurfaceInItselfBumpedTurnedAndRenumbered) {
    const auto other = shapes::renumbered(bumped(), 41);
    const auto target_shape = shapes::moved(other.shape, shapes::some_rotation(), {4.0, 5.0, 6.0});
    const Surface source = gate(shapes::blob(4)), target = gate(target_shape);
    const MatchOptions options = quick();
    const Match result = match(source, target, options);
    expect_well_formed(result.best(), source, target);
    Points truth(source.vertices().rows(), 3);
    for (Eigen::Index v = 0; v < truth.rows(); ++v) truth.row(v) = target.vertices().row(other.vertex[v]);
    const Score s = score(result.best(), truth, spacing(target.mesh(), options));
    EXPECT_GT(s.matched, 0.95);
    EXPECT_GT(s.right, 0.95 * s.matched);
    EXPECT_NEAR(result.report.scale, 1.0, 0.03);
    EXPECT_GT(result.report.maps_grown, 0);
    EXPECT_GE(result.report.maps_grown, result.report.maps_in_core);
}

/// A bumpy body that half a turn about the z axis takes to itself, and no mirror.
shapes::Shape twofold() {
    auto shape = shapes::sphere(4);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        const Eigen::Vector3d p = shape.vertices.row(v);
        const double bump = 0.18 * std::sin(4.0 * p.x() * p.y() + 0.4) + 0.14 * std::sin(3.0 * p.z() - 1.0) +
                            0.12 * std::cos(3.0 * (p.x() * p.x() - p.y() * p.y()) + 4.0 * p.z());
        shape.vertices.row(v) = (1.0 + bump) * Eigen::Vector3d(p.x(), 0.7 * p.y(), 1.2 * p.z()).transpose();
    }
    return shape;
}

TEST(Match, GivesBothAnswersWhereTheShapeMapsOntoItself) {
    const shapes::Shape shape = twofold();
    const Surface source = gate(shape);
    const Surface target = gate(shapes::moved(shape, shapes::some_rotation(), {1.0, 2.0, 3.0}));
    const MatchOptions options = quick();
    const Match result = match(source, target, options);
    ASSERT_EQ(result.correspondences.size(), 2U);
    const Eigen::Matrix3d half_turn = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
    const shapes::Shape other =
        shapes::moved(shapes::moved(shape, half_turn, {0.0, 0.0, 0.0}), shapes::some_rotation(), {1.0, 2.0, 3.0});
    const double radius = spacing(target.mesh(), options);
    double straight = 0.0, round = 0.0;
    for (const Correspondence& c : result.correspondences) {
        expect_well_formed(c, source, target);
        straight = std::max(straight, score(c, target.vertices(), radius).right);
        round = std::max(round, score(c, other.vertices, radius).right);
    }
    EXPECT_GT(straight, 0.9);
    EXPECT_GT(round, 0.9);
    EXPECT_TRUE(std::any_of(result.report.warnings.begin(), result.report.warnings.end(),
                            [](const std::string& w) { return w.find("alternative 1") != std::string::npos; }));
}

TEST(Match, GivesOneAnswerWhereThereIsOne) {
    const Match result = match(gate(shapes::blob(4)), gate(bumped()), quick());
    EXPECT_EQ(result.correspondences.size(), 1U);
}

shapes::Shape without_a_spot(const shapes::Shape& shape) {
    return shapes::cut(shape,
                       [](const Eigen::Vector3d& x) { return (x - Eigen::Vector3d(0.0, -1.0, 0.0)).norm() > 0.3; });
}

TEST(Match, SaysNothingOfWhatClosesAHole) {
    const Surface source = gate(shapes::blob(4)), target = gate(without_a_spot(bumped()));
    MatchOptions options = quick();
    const Correspondence through = match(source, target, options).best();
    expect_well_formed(through, source, target);
    int inside = 0, inside_matched = 0, around = 0, around_matched = 0;
    for (Eigen::Index v = 0; v < source.vertices().rows(); ++v) {
        const double distance = (bumped().vertices.row(v) - Eigen::RowVector3d(0.0, -1.0, 0.0)).norm();
        const bool matched = through.face[v] >= 0;
        if (distance < 0.2) {
            ++inside;
            inside_matched += matched;
        } else if (distance > 0.35 && distance < 0.6) {
            ++around;
            around_matched += matched;
        }
    }
    ASSERT_GT(inside, 10);
    ASSERT_GT(around, 50);
    EXPECT_EQ(inside_matched, 0);
    EXPECT_GT(around_matched, 0.95 * around);
    const Surface part = gate(without_a_spot(shapes::blob(4)));
    const Correspondence from = match(part, gate(bumped()), options).best();
    expect_well_formed(from, part, gate(bumped()));
    EXPECT_GT((from.face.array() >= 0).count(), 0.9 * part.mesh().vertex_count());
}

TEST(Match, IsTheSamePointBitForBitAfterMovingTurningAndRenumbering) {
    const auto source = without_a_spot(shapes::blob(4)), target = bumped();
    const auto other_source = shapes::renumbered(source, 51), other_target = shapes::renumbered(target, 52);
    const Eigen::Matrix3d turn = shapes::some_rotation();
    const Correspondence here = match(gate(source), gate(target), quick()).best();
    const Correspondence there = match(gate(shapes::moved(other_source.shape, turn, {7.0, -2.0, 1.0})),
                                       gate(shapes::moved(other_target.shape, turn * turn, {0.0, 5.0, -3.0})), quick())
                                     .best();
    for (Eigen::Index v = 0; v < source.vertices.rows(); ++v) {
        const int w = other_source.vertex[v];
        ASSERT_EQ(here.face[v] >= 0, there.face[w] >= 0);
        EXPECT_EQ(here.confidence[v], there.confidence[w]);
        if (here.face[v] < 0) continue;
        const int f = here.face[v];
        ASSERT_EQ(other_target.face[f], there.face[w]);
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(here.barycentric(v, (k + other_target.first_corner[f]) % 3), there.barycentric(w, k));
        }
    }
    EXPECT_GT((here.face.array() >= 0).count(), 0.9 * gate(source).mesh().vertex_count());
}

TEST(Match, IsEqualBitForBitForOneAndForTwoThreads) {
    const Surface source = gate(shapes::blob(3)), target = gate(shapes::noisy(shapes::blob(3), 0.005, 1));
    MatchOptions options = quick();
    options.threads = 1;
    const Match one = match(source, target, options);
    options.threads = 2;
    const Match two = match(source, target, options);
    ASSERT_EQ(one.correspondences.size(), two.correspondences.size());
    for (std::size_t i = 0; i < one.correspondences.size(); ++i) {
        const Correspondence &a = one.correspondences[i], &b = two.correspondences[i];
        EXPECT_EQ(a.face, b.face);
        EXPECT_EQ(a.region, b.region);
        EXPECT_EQ(a.vertex, b.vertex);
        expect_same_bits(a.points, b.points);
        expect_same_bits(a.barycentric, b.barycentric);
        expect_same_bits(a.confidence, b.confidence);
        expect_same_bits(a.stretch, b.stretch);
    }
    EXPECT_EQ(one.report.scale, two.report.scale);
    EXPECT_EQ(one.report.maps_grown, two.report.maps_grown);
}

TEST(Match, LeavesUnmatchedWhatTheTargetLacks) {
    const auto keep = [](const Eigen::Vector3d& x) { return x.z() < 0.35; };
    const Surface source = gate(shapes::blob(4)), target = gate(shapes::cut(bumped(), keep));
    const MatchOptions options = quick();
    const Match result = match(source, target, options);
    expect_well_formed(result.best(), source, target);
    const double radius = spacing(source.mesh(), options);
    int kept = 0, right = 0, gone = 0, made_up = 0;
    const Points places = bumped().vertices;
    for (Eigen::Index v = 0; v < source.vertices().rows(); ++v) {
        const Eigen::Vector3d x = places.row(v);
        const bool matched = result.best().face[v] >= 0;
        if (x.z() < 0.35 - radius) {
            ++kept;
            right += matched && (result.best().points.row(v).transpose() - x).norm() < radius;
        } else if (x.z() > 0.35 + 2.0 * radius) {
            ++gone;
            made_up += matched;
        }
    }
    EXPECT_GT(kept, 1000);
    EXPECT_GT(gone, 200);
    EXPECT_GT(right, 0.9 * kept);
    EXPECT_LT(made_up, 0.05 * gone);
}

TEST(Match, ReportsProgressThatRisesToOne) {
    const Surface source = gate(shapes::blob(3));
    std::vector<double> seen;
    std::vector<std::string> stages;
    const auto caller = std::this_thread::get_id();
    bool elsewhere = false;
    Monitor monitor([&](const std::string& stage, double fraction) {
        seen.push_back(fraction);
        stages.push_back(stage);
        elsewhere = elsewhere || std::this_thread::get_id() != caller;
        return true;
    });
    match(source, source, quick(), &monitor);
    EXPECT_FALSE(elsewhere);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_GE(seen.front(), 0.0);
    EXPECT_EQ(seen.back(), 1.0);
    EXPECT_GT(std::unique(stages.begin(), stages.end()) - stages.begin(), 3);
}

TEST(Match, ThrowsCancelledBeforeTheStartAndAtAnyPoint) {
    const Surface source = gate(shapes::blob(3));
    int calls = 0;
    Monitor before([&](const std::string&, double) { return ++calls > 0; });
    before.cancel();
    EXPECT_THROW(match(source, source, quick(), &before), Cancelled);
    EXPECT_EQ(calls, 0);
    for (const double at : {0.0, 0.2, 0.5, 0.8, 0.95}) {
        double last = 0.0;
        Monitor during([&](const std::string&, double fraction) { return (last = fraction) < at; });
        EXPECT_THROW(match(source, source, quick(), &during), Cancelled) << at;
        EXPECT_GE(last, at);
    }
}

TEST(Match, FollowsTwoLandmarksWhereTheSurfaceShowsNothing) {
    // A plane, and the same plane turned in space with a tall peak on it: two points are all there is to know.
    const auto plane = shapes::grid(36, 36, 0.05, 0.05);
    auto peaked = plane;
    for (Eigen::Index v = 0; v < peaked.vertices.rows(); ++v) {
        const double r = (peaked.vertices.row(v) - Eigen::RowVector3d(1.1, 1.2, 0.0)).norm();
        if (r < 0.2) peaked.vertices(v, 2) = 0.3 * (1.0 + std::cos(M_PI * r / 0.2));
    }
    const auto moved = shapes::moved(peaked, shapes::some_rotation(), {1.0, 2.0, 0.5});
    MatchOptions options = quick();
    options.scale.mode = ScaleMode::fixed;
    const int corner = 3 * 37 + 3;
    options.landmarks = {{corner, corner}, {corner + 29, corner + 29}};
    options.seed.landmarks_only = true;
    const Match found = match(Surface::from_mesh(plane.vertices, plane.faces),
                              Surface::from_mesh(moved.vertices, moved.faces), options);
    const Score s = score(found.correspondences.front(), moved.vertices, spacing(shapes::mesh_of(plane), options));
    EXPECT_GT(s.right, 0.8);
    EXPECT_GT(s.right, 0.95 * s.matched);
}

TEST(Match, LetsALandmarkChooseAmongTheMapsOfASymmetricSurface) {
    const shapes::Shape shape = twofold();
    const Surface source = gate(shape), target = gate(shape);
    const Eigen::Matrix3d half_turn = Eigen::Vector3d(-1.0, -1.0, 1.0).asDiagonal();
    const shapes::Shape round = shapes::moved(shape, half_turn, {0.0, 0.0, 0.0});
    int start = 0, opposite = 0;
    shape.vertices.col(0).maxCoeff(&start);
    (shape.vertices.rowwise() - round.vertices.row(start)).rowwise().norm().minCoeff(&opposite);
    for (const int end : {start, opposite}) {
        MatchOptions options = quick();
        options.landmarks = {{start, end}};
        const Match result = match(source, target, options);
        const Points& truth = end == start ? shape.vertices : round.vertices;
        EXPECT_GT(score(result.best(), truth, spacing(target.mesh(), options)).right, 0.9);
    }
}

TEST(Match, RefusesLandmarksOutOfRangeAndOptionsByName) {
    const Surface source = gate(shapes::blob(2));
    const auto refusal_of = [&](const MatchOptions& options) {
        try {
            match(source, source, options);
        } catch (const InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    MatchOptions options;
    options.landmarks = {{0, 0}, {0, 5000}};
    EXPECT_NE(refusal_of(options).find("landmark 1: target vertex 5000"), std::string::npos) << refusal_of(options);
    options.landmarks = {{-1, 0}};
    EXPECT_NE(refusal_of(options).find("landmark 0: source vertex -1"), std::string::npos);
    options.landmarks.clear();
    options.threads = -1;
    EXPECT_NE(refusal_of(options).find("threads"), std::string::npos);
    options.threads = 1;
    options.growth.huber = std::nan("");
    EXPECT_NE(refusal_of(options).find("growth.huber"), std::string::npos);
    EXPECT_THROW(preset_options("no such"), InvalidInput);
    for (const char* name : {"fast", "default", "thorough"}) EXPECT_NO_THROW(preset_options(name).validate());
}

}  // namespace
}  // namespace isograft
