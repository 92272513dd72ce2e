// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "scale/find_scale.h"
#include "twins.h"

namespace isograft {
namespace {

void vote_scale(benchmark::State& state) {
    const Pair& pair = Twins::of_a_blob().pair();
    Monitor monitor;
    for (auto _ : state) {
        benchmark::DoNotOptimize(
            isograft::vote_scale(pair.source.mesh, pair.target.mesh, {}, {}, 0, 1, monitor, 0.0, 1.0));
    }
}
BENCHMARK(vote_scale)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
