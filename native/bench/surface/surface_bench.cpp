// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "shapes.h"

namespace isograft {
namespace {

void gate(benchmark::State& state) {
    const shapes::Shape shape = shapes::blob(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(Surface::from_mesh(shape.vertices, shape.faces));
    state.SetItemsProcessed(state.iterations() * shape.vertices.rows());
}
BENCHMARK(gate)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
