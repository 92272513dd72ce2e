// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/drift.h"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "geodesic/trace.h"
#include "twins.h"

namespace isograft {
namespace {

// Every image moved the same way, which is not the same direction everywhere on a body: that of the source's x axis.
PartialMap slid(const Twins& twins, double way) {
    PartialMap map = twins.true_map(twins.all_samples());
    const TriangleMesh& source = twins.pair().source.mesh;
    const TriangleMesh& target = twins.pair().target.mesh;
    for (int s = 0; s < twins.pair().source.samples.count(); ++s) {
        const int face = twins.pair().source.samples.point[s].face;
        const Complex along = unit(flatten(source, face, Eigen::Vector3d::UnitX())) * map.rotation[s];
        const Trace t = trace(target, map.image[s], along, way);
        map.put(target, s, t.end, map.rotation[s] * t.direction * std::conj(along));
    }
    return map;
}

double mean_gain(const std::vector<Drift>& drifts) {
    return std::accumulate(drifts.begin(), drifts.end(), 0.0,
                           [](double sum, const Drift& d) { return sum + d.gain(); }) /
           static_cast<double>(drifts.size());
}

TEST(Drift, FindsNothingWhereTheMapIsRight) {
    const Twins& twins = Twins::of_a_blob();
    const DriftFinder finder(twins.pair(), twins.options().feature);
    Monitor monitor;
    const auto drifts = finder.find(slid(twins, 0.0), 2, monitor);
    int moved = 0;
    for (const Drift& d : drifts) moved += modulus(d.offset) > 1.5 * twins.spacing() ? 1 : 0;
    EXPECT_LT(moved, static_cast<int>(drifts.size()) / 50);
}

TEST(Drift, PointsBackWhereAMapHasSlid) {
    const Twins& twins = Twins::of_a_blob();
    const Pair& pair = twins.pair();
    const DriftFinder finder(pair, twins.options().feature);
    Monitor monitor;
    const PartialMap map = slid(twins, 3.0 * twins.spacing());
    const auto drifts = finder.find(map, 2, monitor);
    int back = 0;
    for (int s = 0; s < pair.source.samples.count(); ++s) {
        const Drift& d = drifts[s];
        const Eigen::Vector3d there =
            position(pair.target.mesh, trace(pair.target.mesh, map.image[s], d.offset, modulus(d.offset)).end);
        back += twins.error(s, there) < 0.5 * twins.error(s, map.position[s]) ? 1 : 0;
    }
    // Near the ends of the axis the shift turns round a pole and neighbours disagree.
    EXPECT_GT(back, 8 * pair.source.samples.count() / 10);
}

TEST(Drift, GainGrowsAsAMapSlides) {
    const Twins& twins = Twins::of_a_blob();
    const DriftFinder finder(twins.pair(), twins.options().feature);
    Monitor monitor;
    const double none = mean_gain(finder.find(slid(twins, 0.0), 2, monitor));
    const double some = mean_gain(finder.find(slid(twins, 2.0 * twins.spacing()), 2, monitor));
    const double much = mean_gain(finder.find(slid(twins, 4.0 * twins.spacing()), 2, monitor));
    EXPECT_LT(none, some);
    EXPECT_LT(some, much);
}

TEST(Drift, SaysNothingOfUnmappedSamples) {
    const Twins& twins = Twins::of_a_blob();
    const DriftFinder finder(twins.pair(), twins.options().feature);
    Monitor monitor;
    const auto drifts = finder.find(twins.true_map({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}), 2, monitor);
    for (std::size_t s = 10; s < drifts.size(); ++s) {
        EXPECT_EQ(drifts[s].gain(), 0.0);
        EXPECT_EQ(drifts[s].offset, Complex(0.0, 0.0));
    }
}

}  // namespace
}  // namespace isograft
