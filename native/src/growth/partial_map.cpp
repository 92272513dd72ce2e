// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/partial_map.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace isograft {

namespace {
constexpr float far_away = 1e9F;
}

PartialMap::PartialMap(int samples)
    : mapped(samples, 0),
      image(samples),
      position(samples, Eigen::Vector3d::Zero()),
      rotation(samples, Complex(1.0, 0.0)),
      seed_distance(samples, far_away) {}

void PartialMap::put(const TriangleMesh& target, int sample, const SurfacePoint& point, Complex turn) {
    if (!mapped[sample]) ++count;
    mapped[sample] = 1;
    image[sample] = point;
    position[sample] = isograft::position(target, point);
    rotation[sample] = turn;
}

void PartialMap::drop(int sample) {
    if (mapped[sample]) --count;
    mapped[sample] = 0;
}

Overlap overlap_of(const PartialMap& a, const PartialMap& b, double radius) {
    Overlap result;
    for (std::size_t s = 0; s < a.mapped.size(); ++s) {
        if (!a.mapped[s] || !b.mapped[s]) continue;
        ++result.shared;
        result.agreed += (a.position[s] - b.position[s]).norm() < radius ? 1 : 0;
    }
    return result;
}

std::vector<int> homes_of(const PartialMap& map, const SampledMesh& target) {
    std::vector<int> homes(map.mapped.size(), -1);
    for (std::size_t s = 0; s < homes.size(); ++s) {
        if (map.mapped[s]) homes[s] = target.samples.nearest(target.mesh, map.image[s]);
    }
    return homes;
}

void measure_seed_distance(const Samples& source, PartialMap& map) {
    std::fill(map.seed_distance.begin(), map.seed_distance.end(), far_away);
    using Item = std::pair<float, int>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    if (map.seed < 0 || !map.mapped[map.seed]) return;
    map.seed_distance[map.seed] = 0.0F;
    queue.emplace(0.0F, map.seed);
    while (!queue.empty()) {
        const auto [distance, u] = queue.top();
        queue.pop();
        if (distance > map.seed_distance[u]) continue;
        for (const int e : source.base_edges_of[u]) {
            const int v = source.edges[e].other(u);
            const float d = distance + static_cast<float>(source.edges[e].length);
            if (!map.mapped[v] || d >= map.seed_distance[v]) continue;
            map.seed_distance[v] = d;
            queue.emplace(d, v);
        }
    }
}

bool is_active(const SampleEdge& edge, const PartialMap& map) {
    if (!map.mapped[edge.u] || !map.mapped[edge.v]) return false;
    return std::all_of(edge.witnesses.begin(), edge.witnesses.end(), [&](int w) { return map.mapped[w] != 0; });
}

}  // namespace isograft
