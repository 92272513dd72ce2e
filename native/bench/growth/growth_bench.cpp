// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "growth/patches.h"
#include "growth/relax.h"
#include "twins.h"

namespace isograft {
namespace {

void probe(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    const Pair& pair = twins.pair();
    const PatchSettings settings = twins.settings();
    Grower grower(pair.source.samples, pair.target, settings.growth);
    int i = 0;
    for (auto _ : state) {
        const OrientedMatch match = twins.true_match(i++ % pair.source.samples.count());
        benchmark::DoNotOptimize(isograft::probe(pair, settings, grower, match, static_cast<int>(state.range(0))));
    }
}
BENCHMARK(probe)->Arg(40)->Arg(200)->Unit(benchmark::kMicrosecond);

void relax(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    const PartialMap start = twins.true_map(twins.all_samples());
    RelaxSettings settings;
    settings.iterations = static_cast<int>(state.range(0));
    for (auto _ : state) {
        PartialMap map = start;
        benchmark::DoNotOptimize(
            isograft::relax(twins.pair().source.samples, twins.pair().target.mesh, {}, settings, map));
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(twins.pair().source.samples.edges.size()));
}
BENCHMARK(relax)->Arg(0)->Arg(2)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isograft
