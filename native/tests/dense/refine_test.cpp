// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/refine.h"

#include <vector>

#include <gtest/gtest.h>

#include "growth/relax.h"
#include "isograft/errors.h"
#include "tubes.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

void run(PartialMap& map, const DenseOptions& options = {}, int threads = 2) {
    Monitor monitor;
    refine(map, twins().pair(), twins().options().feature, twins().options().growth, options, threads, monitor, 0.0,
           1.0);
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
    DenseOptions with_coarse_options, only_fine;
    with_coarse_options.refine_relief_iterations = only_fine.refine_relief_iterations = 0;
    only_fine.refine_iterations += only_fine.refine_coarse_iterations;
    only_fine.refine_coarse_iterations = 0;
    PartialMap with_coarse = start, without = start;
    Monitor monitor;
    const auto& options = tubes.options();
    refine(with_coarse, tubes.pair(), options.feature, options.growth, with_coarse_options, 2, monitor, 0.0, 1.0);
    refine(without, tubes.pair(), options.feature, options.growth, only_fine, 2, monitor, 0.0, 1.0);
    EXPECT_NEAR(mean_error(tubes, start), 1.5, 0.1);
    EXPECT_GT(mean_error(tubes, without), 1.0);
    EXPECT_LT(mean_error(tubes, with_coarse), 0.3);
}

TEST(Refine, ReachesFartherWithReliefThanWithout) {
    const PartialMap start = turned(tubes(), 3.0);
    DenseOptions without;
    without.refine_relief_iterations = 0;
    PartialMap relieved = start, descriptors_only = start;
    Monitor monitor;
    const auto& options = tubes().options();
    refine(relieved, tubes().pair(), options.feature, options.growth, {}, 2, monitor, 0.0, 1.0);
    refine(descriptors_only, tubes().pair(), options.feature, options.growth, without, 2, monitor, 0.0, 1.0);
    EXPECT_GT(mean_error(tubes(), descriptors_only), 0.5);
    EXPECT_LT(mean_error(tubes(), relieved), 0.3);
}

TEST(Refine, ChangesNoBitWhereItIsOff) {
    const PartialMap before = twins().true_map(twins().all_samples());
    DenseOptions no_weight, no_iterations;
    no_weight.refine_weight = 0.0;
    no_iterations.refine_coarse_iterations = no_iterations.refine_relief_iterations = no_iterations.refine_iterations =
        0;
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
