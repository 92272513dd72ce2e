// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/relief.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "geodesic/trace.h"
#include "isograft/errors.h"
#include "tubes.h"

namespace isograft {
namespace {

void settle(const Twins& twins, PartialMap& map, int iterations, int threads = 2) {
    Monitor monitor;
    Relief(twins.pair()).relax(map, twins.options().growth, {}, iterations, threads, monitor);
}

double trace_of(const SampleTerm& term) { return term.hxx + term.hyy; }

/// Mean strength of the terms of the samples whose middle is right on the pair's source.
template <class Right>
double mean_strength(const Twins& twins, Right&& right) {
    const Relief relief(twins.pair());
    const PartialMap map = twins.true_map(twins.all_samples());
    std::vector<double> strength;
    for (const int s : twins.all_samples()) {
        if (!right(twins.pair().source.samples.position[s])) continue;
        const auto term = relief.term(map, s, {});
        if (term) strength.push_back(trace_of(*term));
    }
    EXPECT_GT(strength.size(), 20U);
    return shapes::mean(strength);
}

TEST(Relief, CuresASlideThatLengthsCannotSee) {
    const Twins& twins = tubes();
    const PartialMap start = turned(twins, 1.5);
    PartialMap settled = start, relaxed = start;
    settle(twins, settled, 8);
    RelaxSettings settings;
    settings.iterations = 8;
    relax(twins.pair().source.samples, twins.pair().target.mesh, twins.options().growth, settings, relaxed);
    EXPECT_NEAR(mean_error(twins, start), 1.5, 0.1);
    EXPECT_GT(mean_error(twins, relaxed), 1.3);
    EXPECT_LT(mean_error(twins, settled), 0.15);
}

TEST(Relief, LeavesARightMapRight) {
    const Twins& twins = Twins::of_a_blob();
    PartialMap map = twins.true_map(twins.all_samples());
    settle(twins, map, 4);
    EXPECT_EQ(map.count, twins.pair().source.samples.count());
    EXPECT_LT(mean_error(twins, map), 0.02);
}

TEST(Relief, PullsWhereItShouldAndByAsMuch) {
    const Twins& twins = Twins::of_a_blob();
    const SampledMesh& source = twins.pair().source;
    const TriangleMesh& target = twins.pair().target.mesh;
    const PartialMap right = twins.true_map(twins.all_samples());
    PartialMap map = right;
    // The whole map half a spacing off, each sample along what was the x axis.
    for (const int s : twins.all_samples()) {
        const Complex way = flatten(target, map.image[s].face, Eigen::Vector3d::UnitX());
        if (modulus(way) < 0.5) continue;
        const Trace t = trace(target, map.image[s], unit(way), 0.5 * twins.spacing());
        map.put(target, s, t.end, map.rotation[s] * t.direction * std::conj(unit(way)));
    }
    const Relief relief(twins.pair());
    std::vector<double> before, after;
    for (const int s : twins.all_samples()) {
        const auto term = relief.term(map, s, {});
        ASSERT_TRUE(term.has_value());
        Eigen::Matrix2d h;
        h << term->hxx, term->hxy, term->hxy, term->hyy;
        if (h.determinant() < 1e-6) continue;
        const Eigen::Vector2d x = -h.inverse() * Eigen::Vector2d(term->gx, term->gy);
        const Eigen::Vector3d there = map.position[s] + lift(target, map.image[s].face, {x[0], x[1]});
        before.push_back(twins.error(s, map.position[s]));
        after.push_back(twins.error(s, there));
    }
    EXPECT_GT(before.size(), 0.8 * source.samples.count());
    EXPECT_LT(shapes::mean(after), 0.5 * shapes::mean(before));
}

TEST(Relief, SaysNothingWhereThereIsNone) {
    // A flat sheet shows nothing; the middle of a round tube nothing either, along it or around it.
    const Twins flat(shapes::grid(30, 22, 0.1, 0.1));
    const auto inside = [&](const Eigen::Vector3d& x) {
        const double unit = 1.0 / flat.prepared().unit;
        return x[0] > 0.7 * unit && x[0] < 2.3 * unit && x[1] > 0.7 * unit && x[1] < 1.5 * unit;
    };
    const double of_blob = mean_strength(Twins::of_a_blob(), [](const Eigen::Vector3d&) { return true; });
    EXPECT_LT(mean_strength(flat, inside), 1e-6);
    EXPECT_GT(of_blob, 1e-3);
}

TEST(Relief, NeedsEnoughOfTheSurroundings) {
    const Twins& twins = Twins::of_a_blob();
    const PartialMap few = twins.true_map({3, 4});
    EXPECT_FALSE(Relief(twins.pair()).term(few, 3, {}).has_value());
    PartialMap nothing = twins.true_map({});
    settle(twins, nothing, 3);
    EXPECT_EQ(nothing.count, 0);
}

TEST(Relief, IsEqualBitForBitForAnyNumberOfThreads) {
    PartialMap one = turned(tubes(), 0.7), two = one;
    settle(tubes(), one, 3, 1);
    settle(tubes(), two, 3, 3);
    EXPECT_EQ(one.rotation, two.rotation);
    for (const int s : tubes().all_samples()) EXPECT_EQ(one.position[s], two.position[s]);
}

TEST(Relief, StopsWhenCancelled) {
    PartialMap map = tubes().true_map({0, 1, 2});
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(Relief(tubes().pair()).relax(map, tubes().options().growth, {}, 1, 2, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
