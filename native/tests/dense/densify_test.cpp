// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/densify.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

SampleNotes notes(double confidence) {
    const auto count = static_cast<std::size_t>(twins().pair().source.samples.count());
    return {std::vector<double>(count, confidence), std::vector<double>(count, 0.02), std::vector<int>(count, 0)};
}

Correspondence dense(const PartialMap& map, int threads = 2) {
    const PreparedPair& prepared = twins().prepared();
    Monitor monitor;
    return densify(map, twins().pair(), notes(0.75), {}, prepared.source, prepared.target, threads, monitor, 0.0, 1.0);
}

/// Distance of a vertex's image from where it belongs, in sample spacings.
double error(const Correspondence& c, Eigen::Index v) {
    const PreparedPair& prepared = twins().prepared();
    const Eigen::Vector3d x = prepared.source.surface.vertices().row(v).transpose() / prepared.unit;
    const Eigen::Vector3d image = c.points.row(v).transpose() / prepared.unit;
    return (image - twins().truth(x)).norm() / twins().spacing();
}

TEST(Densify, CarriesARightMapToEveryVertex) {
    const Correspondence c = dense(twins().true_map(twins().all_samples()));
    double sum = 0.0;
    for (Eigen::Index v = 0; v < c.face.size(); ++v) {
        ASSERT_GE(c.face[v], 0);
        EXPECT_LT(error(c, v), 0.6);
        EXPECT_NEAR(c.confidence[v], 0.75, 1e-6);
        EXPECT_NEAR(c.stretch[v], 0.02, 1e-6);
        EXPECT_EQ(c.region[v], 0);
        sum += error(c, v);
    }
    EXPECT_LT(sum / static_cast<double>(c.face.size()), 0.15);
}

TEST(Densify, LeavesUnmatchedWhatIsFarFromEveryMappedSample) {
    const Pair& pair = twins().pair();
    std::vector<int> low;
    for (const int s : twins().all_samples()) {
        if (pair.source.samples.position[s].y() < 0.0) low.push_back(s);
    }
    const Correspondence c = dense(twins().true_map(low));
    const Surface& surface = twins().prepared().source.surface;
    const double spacing = twins().spacing() * twins().prepared().unit;
    for (Eigen::Index v = 0; v < c.face.size(); ++v) {
        const double y = surface.vertices()(v, 1);
        if (y < -spacing) {
            EXPECT_GE(c.face[v], 0);
        }
        if (y > DenseOptions().reach * spacing * 1.1) {
            EXPECT_EQ(c.face[v], -1);
        }
        if (c.face[v] >= 0) {
            EXPECT_LT(error(c, v), 0.8);
        }
    }
}

TEST(Densify, OfNothingIsNothing) {
    const Correspondence c = dense(twins().true_map({}));
    EXPECT_EQ((c.face.array() == -1).count(), c.face.size());
}

TEST(Densify, IsEqualBitForBitForAnyNumberOfThreads) {
    const PartialMap map = twins().true_map(twins().all_samples());
    const Correspondence one = dense(map, 1);
    const Correspondence two = dense(map, 2);
    EXPECT_EQ(one.face, two.face);
    EXPECT_EQ(one.barycentric, two.barycentric);
    EXPECT_EQ(one.points, two.points);
}

TEST(Densify, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    const PreparedPair& prepared = twins().prepared();
    EXPECT_THROW(densify(twins().true_map(twins().all_samples()), twins().pair(), notes(0.5), {}, prepared.source,
                         prepared.target, 2, monitor, 0.0, 1.0),
                 Cancelled);
}

TEST(Collisions, LoseTheRiskierOfTwoSamplesThatLieApartOnTheSource) {
    const Pair& pair = twins().pair();
    const Samples& samples = pair.source.samples;
    int far = 0;
    for (const int s : twins().all_samples()) {
        if ((samples.position[s] - samples.position[0]).norm() > (samples.position[far] - samples.position[0]).norm()) {
            far = s;
        }
    }
    for (const bool first_is_riskier : {false, true}) {
        PartialMap map = twins().true_map({0});
        map.put(pair.target.mesh, far, map.image[0], map.rotation[0]);
        std::vector<double> risk(samples.count(), 0.0);
        risk[first_is_riskier ? 0 : far] = 1.0;
        drop_collisions(map, pair, risk, 0.45);
        EXPECT_EQ(map.count, 1);
        EXPECT_EQ(map.mapped[0] != 0, !first_is_riskier);
        EXPECT_EQ(map.mapped[far] != 0, first_is_riskier);
    }
}

TEST(Collisions, AreNotFoundInARightMap) {
    PartialMap map = twins().true_map(twins().all_samples());
    drop_collisions(map, twins().pair(), std::vector<double>(map.mapped.size(), 0.3), 0.45);
    EXPECT_EQ(map.count, twins().pair().source.samples.count());
}

}  // namespace
}  // namespace isograft
