// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/core_scale.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "scale/rescale.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

/// One patch around every fortieth sample, put where it belongs.
std::vector<Patch> true_patches() {
    std::vector<Patch> patches;
    for (int s = 0; s < twins().pair().source.samples.count(); s += 40) {
        Patch patch;
        patch.map = twins().true_map({s});
        patches.push_back(patch);
    }
    return patches;
}

Core whole(const std::vector<Patch>& patches) {
    Core core;
    core.member.assign(patches.size(), 1);
    core.count = static_cast<int>(patches.size());
    return core;
}

TEST(CoreScale, IsOneWhereTheScaleIsRight) {
    const auto patches = true_patches();
    Monitor monitor;
    const CoreScale said = measure_core_scale(twins().pair(), patches, whole(patches), monitor);
    EXPECT_NEAR(said.ratio, 1.0, 0.01);
    EXPECT_LT(said.error, 0.02);
}

TEST(CoreScale, TellsByWhatTheScaleIsOff) {
    const auto patches = true_patches();
    Monitor monitor;
    for (const double factor : {0.85, 1.2}) {
        PreparedPair prepared = twins().prepared();
        rescale(prepared, factor, twins().options(), monitor, 0.0, 1.0);
        const CoreScale said = measure_core_scale(prepared.pair, patches, whole(patches), monitor);
        EXPECT_NEAR(said.ratio * factor, 1.0, 0.01);
    }
}

TEST(CoreScale, SaysNothingOfTooFewSeeds) {
    auto patches = true_patches();
    patches.resize(2);
    Monitor monitor;
    const CoreScale said = measure_core_scale(twins().pair(), patches, whole(patches), monitor);
    EXPECT_EQ(said.ratio, 1.0);
    EXPECT_EQ(said.error, 1.0);
}

TEST(CoreScale, StopsWhenCancelled) {
    const auto patches = true_patches();
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(measure_core_scale(twins().pair(), patches, whole(patches), monitor), Cancelled);
}

TEST(Rescale, ScalesTheSourceAndLeavesTheTarget) {
    PreparedPair prepared = twins().prepared();
    const Pair before = prepared.pair;
    Monitor monitor;
    constexpr double factor = 1.25;
    rescale(prepared, factor, twins().options(), monitor, 0.0, 1.0);
    const Pair& after = prepared.pair;
    EXPECT_NEAR(after.source.mesh.area, factor * factor * before.source.mesh.area, 1e-9);
    EXPECT_EQ(after.target.mesh.area, before.target.mesh.area);
    EXPECT_NEAR(prepared.setting.scale, factor * twins().prepared().setting.scale, 1e-12);
    for (std::size_t e = 0; e < before.source.samples.edges.size(); ++e) {
        EXPECT_NEAR(after.source.samples.edges[e].length, factor * before.source.samples.edges[e].length, 1e-12);
    }
    for (std::size_t v = 0; v < before.source_curvature.size(); ++v) {
        EXPECT_NEAR(after.source_curvature[v] * factor, before.source_curvature[v], 1e-9);
    }
}

}  // namespace
}  // namespace isograft
