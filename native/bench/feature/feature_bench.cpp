// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "feature/curvature.h"
#include "feature/descriptor.h"
#include "twins.h"

namespace isograft {
namespace {

void curvature(benchmark::State& state) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(static_cast<int>(state.range(0))));
    for (auto _ : state) benchmark::DoNotOptimize(mean_curvature(mesh, 0.005));
    state.SetItemsProcessed(state.iterations() * mesh.vertex_count());
}
BENCHMARK(curvature)->Arg(4)->Arg(5)->Unit(benchmark::kMillisecond);

void window_descriptor(benchmark::State& state) {
    const Pair& pair = Twins::of_a_blob().pair();
    Window window(pair.source.mesh);
    int i = 0;
    for (auto _ : state) {
        const SurfacePoint& centre = pair.source.samples.point[i++ % pair.source.samples.count()];
        benchmark::DoNotOptimize(
            isograft::window_descriptor(pair.source.mesh, window, centre, pair.source_curvature, 1.0, {}));
    }
}
BENCHMARK(window_descriptor)->Unit(benchmark::kMicrosecond);

void ray_descriptor(benchmark::State& state) {
    const Pair& pair = Twins::of_a_blob().pair();
    int i = 0;
    for (auto _ : state) {
        const SurfacePoint& centre = pair.source.samples.point[i++ % pair.source.samples.count()];
        benchmark::DoNotOptimize(
            isograft::ray_descriptor(pair.source.mesh, centre, pair.source_curvature, 0.2, 1.0, 0.0, {}));
    }
}
BENCHMARK(ray_descriptor)->Unit(benchmark::kMicrosecond);

void best_shift(benchmark::State& state) {
    const Pair& pair = Twins::of_a_blob().pair();
    int i = 0;
    for (auto _ : state) {
        const auto& a = pair.source_descriptor[i % pair.source.samples.count()];
        const auto& b = pair.target_descriptor[7 * i++ % pair.target.samples.count()];
        benchmark::DoNotOptimize(isograft::best_shift(a, b, {}));
    }
}
BENCHMARK(best_shift);

}  // namespace
}  // namespace isograft
