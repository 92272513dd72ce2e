// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "blend/anchors.h"
#include "blend/blend.h"
#include "seed/oriented_match.h"
#include "twins.h"

namespace isograft {
namespace {

void anchors(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    const PartialMap map = twins.true_map(twins.all_samples());
    Monitor monitor;
    for (auto _ : state) {
        DistanceFields fields(twins.pair());
        Anchors fresh(fields);
        benchmark::DoNotOptimize(fresh.place(map, 14, monitor));
    }
}
BENCHMARK(anchors)->Unit(benchmark::kMillisecond);

void blend(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    PatchSettings settings = twins.settings();
    settings.threads = 1;
    Monitor monitor;
    const auto matches =
        oriented_matches(twins.pair(), settings.feature, settings.seed, settings.threads, monitor, 0.0, 0.0);
    const auto patches = grow_patches(twins.pair(), settings, matches, 0, monitor, 0.0, 0.0);
    const auto cores = find_cores(patches, settings.blend);
    for (auto _ : state) {
        benchmark::DoNotOptimize(isograft::blend(twins.pair(), settings, patches, cores, monitor, 0.0, 0.6, 1.0));
    }
}
BENCHMARK(blend)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
