// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include <benchmark/benchmark.h>

#include "isograft/bake.h"
#include "isograft/fill.h"
#include "isograft/frames.h"
#include "isograft/invert.h"
#include "isograft/locate.h"
#include "isograft/transfer.h"
#include "shapes.h"
#include "transfer_maps.h"

namespace isograft {
namespace {

/// A body of 10,242 vertices and the same renumbered, the map between them, and UVs of the second with one seam.
struct Scene {
    shapes::Shape receiver = shapes::blob(5);
    shapes::Renumbered other = shapes::renumbered(receiver, 3);
    Correspondence map = maps::to_renumbered(receiver, other);
    Eigen::VectorXi no_polygons;
    CornerUV uv = unrolled(other.shape);
    CornerUV own_uv = unrolled(receiver);

    [[nodiscard]] ReceiverMesh own() const { return {receiver.vertices, receiver.faces, no_polygons}; }
    [[nodiscard]] DonorMesh donor() const { return {other.shape.vertices, other.shape.faces}; }

    static CornerUV unrolled(const shapes::Shape& shape) {
        CornerUV uv(3 * shape.faces.rows(), 2);
        for (Eigen::Index f = 0; f < shape.faces.rows(); ++f) {
            for (int c = 0; c < 3; ++c) {
                const Eigen::Vector3d x = shape.vertices.row(shape.faces(f, c)).transpose().normalized();
                uv.row(3 * f + c) << 0.5 + std::atan2(x.y(), x.x()) / (2.0 * M_PI), std::acos(x.z()) / M_PI;
            }
            // Across the seam the triangle stays whole.
            auto u = uv.col(0).segment<3>(3 * f);
            if (u.maxCoeff() - u.minCoeff() > 0.5) u = (u.array() < 0.5).select(u.array() + 1.0, u.array());
        }
        return uv;
    }

    static const Scene& get() {
        static const Scene scene;
        return scene;
    }
};

void items(benchmark::State& state) { state.SetItemsProcessed(state.iterations() * Scene::get().map.face.rows()); }

void transfer_uv(benchmark::State& state) {
    const Scene& s = Scene::get();
    for (auto _ : state) {
        benchmark::DoNotOptimize(transfer_corner_uv(s.map, s.own(), s.donor(), s.uv, {1e-6, 1.0, 1}));
    }
    items(state);
}
BENCHMARK(transfer_uv)->Unit(benchmark::kMillisecond);

void transfer_40_groups(benchmark::State& state) {
    const Scene& s = Scene::get();
    const CornerValues weights = CornerValues::Constant(s.other.shape.vertices.rows(), 40, 0.5);
    for (auto _ : state) {
        benchmark::DoNotOptimize(transfer_point(s.map, s.other.shape.faces, weights, TransferMode::barycentric));
    }
    items(state);
}
BENCHMARK(transfer_40_groups)->Unit(benchmark::kMillisecond);

void transfer_frames(benchmark::State& state) {
    const Scene& s = Scene::get();
    for (auto _ : state) benchmark::DoNotOptimize(local_frames(s.map, s.own(), s.donor(), {2, 1}));
    items(state);
}
BENCHMARK(transfer_frames)->Unit(benchmark::kMillisecond);

void transfer_inverse(benchmark::State& state) {
    const Scene& s = Scene::get();
    for (auto _ : state) benchmark::DoNotOptimize(invert(s.map, s.own(), s.donor(), 1));
    items(state);
}
BENCHMARK(transfer_inverse)->Unit(benchmark::kMillisecond);

void transfer_bake(benchmark::State& state) {
    const Scene& s = Scene::get();
    const auto size = static_cast<int>(state.range(0));
    const std::vector<std::uint8_t> image(4 * 256 * 256, 100);
    std::vector<std::uint8_t> result(4 * size * size), mask(size * size);
    BakeChannel channel;
    channel.images = {Pixels{image.data(), nullptr, 256, 256}};
    channel.uv = s.uv;
    channel.bytes = result.data();
    for (auto _ : state) {
        bake(s.map, s.own(), s.own_uv, {}, s.donor(), Eigen::VectorXi::Zero(s.donor().faces.rows()), {channel},
             {size, size, 16, 1}, mask.data());
    }
    state.SetItemsProcessed(state.iterations() * size * size);
}
BENCHMARK(transfer_bake)->Arg(512)->Arg(2048)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isograft
