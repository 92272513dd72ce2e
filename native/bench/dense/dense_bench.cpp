// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "dense/densify.h"
#include "dense/refine.h"
#include "twins.h"

namespace isograft {
namespace {

void refine(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    const PartialMap start = twins.true_map(twins.all_samples());
    Monitor monitor;
    for (auto _ : state) {
        PartialMap map = start;
        isograft::refine(map, twins.pair(), {}, {}, {}, 1, monitor, 0.0, 1.0);
    }
}
BENCHMARK(refine)->Unit(benchmark::kMillisecond);

void densify(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    const PartialMap map = twins.true_map(twins.all_samples());
    const auto count = map.mapped.size();
    const SampleNotes notes{std::vector<double>(count, 0.9), std::vector<double>(count, 0.0),
                            std::vector<int>(count, 0)};
    Monitor monitor;
    for (auto _ : state) {
        benchmark::DoNotOptimize(isograft::densify(map, twins.pair(), notes, {}, twins.prepared().source,
                                                   twins.prepared().target, 1, monitor, 0.0, 1.0));
    }
    state.SetItemsProcessed(state.iterations() * twins.prepared().source.fine().vertex_count());
}
BENCHMARK(densify)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
