// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/refine.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "geodesic/trace.h"
#include "growth/relax.h"
#include "isograft/errors.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

void run(PartialMap& map, const DenseOptions& options = {}, int threads = 2) {
    Monitor monitor;
    refine(map, twins().pair(), twins().options().feature, twins().options().growth, options, threads, monitor, 0.0,
           1.0);
}

double mean_error(const Twins& of, const PartialMap& map) {
    double sum = 0.0;
    for (const int s : of.all_samples()) {
        if (map.mapped[s]) sum += of.error(s, map.position[s]);
    }
    return sum / map.count;
}

/// A tube whose cross-section is neither round nor symmetric. Unrolled it is a rectangle, so that a map which turns it
/// keeps every length, and only curvature tells. \param ripple height of 15 grooves along it: fine shape that nearly
/// repeats.
Twins make_tubes(double ripple) {
    shapes::Shape tube = shapes::cylinder(90, 24, 1.0, 1.6);
    for (Eigen::Index v = 0; v < tube.vertices.rows(); ++v) {
        const double angle = std::atan2(tube.vertices(v, 1), tube.vertices(v, 0));
        tube.vertices.row(v).head<2>() *=
            1.0 + 0.14 * std::cos(2.0 * angle) + 0.1 * std::cos(3.0 * angle + 1.0) + ripple * std::cos(15.0 * angle);
    }
    return Twins(tube);
}

const Twins& tubes() {
    static const Twins once = make_tubes(0.0);
    return once;
}

const Twins& grooved_tubes() {
    static const Twins once = make_tubes(0.01);
    return once;
}

/// The true map of tubes, turned by `way` spacings.
PartialMap turned(const Twins& tubes, double way) {
    PartialMap map = tubes.true_map(tubes.all_samples());
    const SampledMesh& source = tubes.pair().source;
    const TriangleMesh& target = tubes.pair().target.mesh;
    for (const int s : tubes.all_samples()) {
        const int face = source.samples.point[s].face;
        const Eigen::Vector3d around =
            Eigen::Vector3d::UnitZ().cross(source.mesh.axis_x[face].cross(source.mesh.axis_y[face]));
        const Complex along = unit(flatten(source.mesh, face, around)) * map.rotation[s];
        const Trace t = trace(target, map.image[s], along, way * tubes.spacing());
        map.put(target, s, t.end, map.rotation[s] * t.direction * std::conj(along));
    }
    return map;
}

TEST(Refine, LeavesARightMapRight) {
    PartialMap map = twins().true_map(twins().all_samples());
    run(map);
    EXPECT_EQ(map.count, twins().pair().source.samples.count());
    EXPECT_LT(mean_error(twins(), map), 0.05);
}

TEST(Refine, CuresDriftThatLengthsCannotSee) {
    const PartialMap start = turned(tubes(), 0.6);
    PartialMap refined = start, relaxed = start;
    const auto& options = tubes().options();
    Monitor monitor;
    refine(refined, tubes().pair(), options.feature, options.growth, {}, 2, monitor, 0.0, 1.0);
    RelaxSettings settings;
    settings.iterations = DenseOptions().refine_coarse_iterations + DenseOptions().refine_iterations;
    relax(tubes().pair().source.samples, tubes().pair().target.mesh, options.growth, settings, relaxed);
    EXPECT_NEAR(mean_error(tubes(), start), 0.6, 0.05);
    EXPECT_GT(mean_error(tubes(), relaxed), 0.5);
    EXPECT_LT(mean_error(tubes(), refined), 0.2);
}

TEST(Refine, IsNotCaughtByFineShapeThatRepeats) {
    const Twins& tubes = grooved_tubes();
    const PartialMap start = turned(tubes, 1.5);
    DenseOptions only_fine;
    only_fine.refine_iterations += only_fine.refine_coarse_iterations;
    only_fine.refine_coarse_iterations = 0;
    PartialMap with_coarse = start, without = start;
    Monitor monitor;
    const auto& options = tubes.options();
    refine(with_coarse, tubes.pair(), options.feature, options.growth, {}, 2, monitor, 0.0, 1.0);
    refine(without, tubes.pair(), options.feature, options.growth, only_fine, 2, monitor, 0.0, 1.0);
    EXPECT_NEAR(mean_error(tubes, start), 1.5, 0.1);
    EXPECT_GT(mean_error(tubes, without), 1.0);
    EXPECT_LT(mean_error(tubes, with_coarse), 0.3);
}

TEST(Refine, ChangesNoBitWhereItIsOff) {
    const PartialMap before = twins().true_map(twins().all_samples());
    DenseOptions no_weight, no_iterations;
    no_weight.refine_weight = 0.0;
    no_iterations.refine_coarse_iterations = no_iterations.refine_iterations = 0;
    for (const DenseOptions& options : {no_weight, no_iterations}) {
        PartialMap map = before;
        run(map, options);
        EXPECT_EQ(map.rotation, before.rotation);
        for (const int s : twins().all_samples()) EXPECT_EQ(map.position[s], before.position[s]);
    }
}

TEST(Refine, MapsNothingThatWasNotMapped) {
    PartialMap map = twins().true_map({0, 5, 10, 15, 20, 25, 30});
    const std::vector<char> before = map.mapped;
    run(map);
    EXPECT_EQ(map.mapped, before);
    PartialMap nothing = twins().true_map({});
    run(nothing);
    EXPECT_EQ(nothing.count, 0);
}

TEST(Refine, IsEqualBitForBitForAnyNumberOfThreads) {
    PartialMap one = twins().true_map(twins().all_samples()), two = one;
    run(one, {}, 1);
    run(two, {}, 2);
    EXPECT_EQ(one.rotation, two.rotation);
    for (const int s : twins().all_samples()) EXPECT_EQ(one.position[s], two.position[s]);
}

TEST(Refine, StopsWhenCancelled) {
    PartialMap map = twins().true_map({0, 1, 2});
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(
        refine(map, twins().pair(), twins().options().feature, twins().options().growth, {}, 2, monitor, 0.0, 1.0),
        Cancelled);
}

}  // namespace
}  // namespace isograft
