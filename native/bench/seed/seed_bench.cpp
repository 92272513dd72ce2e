// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "seed/oriented_match.h"
#include "twins.h"

namespace isograft {
namespace {

void oriented_matches(benchmark::State& state) {
    const Twins& twins = Twins::of_a_blob();
    Monitor monitor;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            isograft::oriented_matches(twins.pair(), twins.options().feature, {}, 1, monitor, 0.0, 1.0));
    }
}
BENCHMARK(oriented_matches)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
