// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "hierarchy/coarse_mesh.h"
#include "hierarchy/samples.h"
#include "shapes.h"

namespace isograft {
namespace {

void coarsen_to_a_tenth(benchmark::State& state) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(static_cast<int>(state.range(0))));
    Monitor monitor;
    for (auto _ : state) benchmark::DoNotOptimize(coarsen(mesh, 3.2 * mesh.mean_edge, monitor));
    state.SetItemsProcessed(state.iterations() * mesh.vertex_count());
}
BENCHMARK(coarsen_to_a_tenth)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond);

void samples(benchmark::State& state) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(5));
    Monitor monitor;
    const double spacing = sample_spacing(mesh.area, static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(make_samples(mesh, spacing, {}, 0, 1, monitor, 0.0, 1.0));
}
BENCHMARK(samples)->Arg(300)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
