// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include <benchmark/benchmark.h>

#include "base/random.h"
#include "geodesic/shoot.h"
#include "geodesic/window.h"
#include "shapes.h"
#include "twins.h"

namespace isograft {
namespace {

const TriangleMesh& body(int levels) {
    static const TriangleMesh small = shapes::mesh_of(shapes::blob(4)), large = shapes::mesh_of(shapes::blob(6));
    return levels == 4 ? small : large;
}

// The cost unit that whole matches are held to: one full window from every working-level sample of both surfaces.
void cost_unit(benchmark::State& state) {
    const Pair& pair = Twins::of_a_blob().pair();
    std::int64_t windows = 0;
    for (auto _ : state) {
        for (const SampledMesh* side : {&pair.source, &pair.target}) {
            Window window(side->mesh);
            for (const SurfacePoint& centre : side->samples.point) {
                window.run(centre, std::numeric_limits<double>::infinity());
                benchmark::DoNotOptimize(window.reached().size());
                ++windows;
            }
        }
    }
    state.SetItemsProcessed(windows);
}
BENCHMARK(cost_unit)->Unit(benchmark::kMillisecond);

// A number of these is the cost unit.
void full_window(benchmark::State& state) {
    const TriangleMesh& mesh = body(static_cast<int>(state.range(0)));
    Window window(mesh);
    Random random(0);
    for (auto _ : state) {
        SurfacePoint centre;
        centre.face = random.below(mesh.face_count());
        window.run(centre, std::numeric_limits<double>::infinity());
        benchmark::DoNotOptimize(window.reached().size());
    }
    state.SetItemsProcessed(state.iterations() * mesh.vertex_count());
}
BENCHMARK(full_window)->Arg(4)->Arg(6)->Unit(benchmark::kMicrosecond);

void bounded_window(benchmark::State& state) {
    const TriangleMesh& mesh = body(6);
    Window window(mesh);
    Random random(0);
    std::int64_t reached = 0;
    for (auto _ : state) {
        SurfacePoint centre;
        centre.face = random.below(mesh.face_count());
        window.run(centre, 10.0 * mesh.mean_edge);
        reached += static_cast<std::int64_t>(window.reached().size());
    }
    state.SetItemsProcessed(reached);
}
BENCHMARK(bounded_window)->Unit(benchmark::kMicrosecond);

void trace_of_ten_edges(benchmark::State& state) {
    const TriangleMesh& mesh = body(6);
    Random random(0);
    for (auto _ : state) {
        SurfacePoint start;
        start.face = random.below(mesh.face_count());
        benchmark::DoNotOptimize(trace(mesh, start, std::polar(1.0, 6.0 * random.uniform()), 10.0 * mesh.mean_edge));
    }
}
BENCHMARK(trace_of_ten_edges);

void shot_of_ten_edges(benchmark::State& state) {
    const TriangleMesh& mesh = body(6);
    Random random(0);
    const double length = 10.0 * mesh.mean_edge;
    for (auto _ : state) {
        SurfacePoint start;
        start.face = random.below(mesh.face_count());
        const Complex direction = std::polar(1.0, 6.0 * random.uniform());
        const Trace way = trace(mesh, start, direction, length);
        benchmark::DoNotOptimize(shoot(mesh, start, way.end, direction * std::polar(1.0, 0.1), 0.95 * length));
    }
}
BENCHMARK(shot_of_ten_edges);

}  // namespace
}  // namespace isograft
