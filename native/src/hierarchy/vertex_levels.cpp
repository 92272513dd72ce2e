// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/vertex_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "geodesic/trace.h"
#include "geodesic/window.h"

namespace isograft {

namespace {

// Disks of this radius, in spacings, put neighbouring vertices of a level about one spacing apart.
constexpr double packing = 0.8;

using Pairs = std::vector<std::pair<int, int>>;

void sort_unique(Pairs& pairs) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

SampleEdge edge_of(int u, int v, const Polar& polar) {
    SampleEdge edge;
    edge.u = u;
    edge.v = v;
    edge.length = polar.distance;
    edge.at_u = std::polar(1.0, polar.angle);
    edge.at_v = polar.back;
    return edge;
}

// The lower-numbered end of every pair of `near` vertices; mesh edges come as level 0, the others as level 1.
void join_near(const TriangleMesh& mesh, VertexLevels& levels, int threads, Monitor& monitor, double from, double to) {
    const int n = mesh.vertex_count();
    const double reach = levels.near_reach();
    std::vector<std::vector<SampleEdge>> around(n);
    std::vector<Window> windows(worker_count(threads), Window(mesh));
    parallel_for(
        n, threads,
        [&](int u, int worker) {
            std::vector<int> ring;
            double radius = reach;
            for (int i = mesh.vertex_face_begin[u]; i < mesh.vertex_face_begin[u + 1]; ++i) {
                const int f = mesh.vertex_face[i];
                for (int k = 0; k < 3; ++k) {
                    if (mesh.face[f][k] != u) ring.push_back(mesh.face[f][k]);
                    radius = std::max(radius, mesh.view[3 * f + k].length);
                }
            }
            Window& window = windows[worker];
            window.run(levels.samples.point[u], 1.1 * radius);
            for (const int v : window.reached()) {
                if (v <= u) continue;
                const bool joined = std::find(ring.begin(), ring.end(), v) != ring.end();
                if (!joined && window.distance(v) > reach) continue;
                const auto polar = window.query(levels.samples.point[v]);
                if (!polar || polar->distance <= 0.0) continue;
                // A window's path may bend at a saddle. Here it is walked as a straight one, so it has to be straight.
                const auto straight = straight_edge(mesh, levels.samples, u, v, *polar, {.tolerance = 0.001});
                if (!straight && !joined) continue;
                around[u].push_back(straight ? *straight : edge_of(u, v, *polar));
                around[u].back().level = joined ? 0 : 1;
            }
            std::sort(around[u].begin(), around[u].end(),
                      [](const SampleEdge& a, const SampleEdge& b) { return a.v < b.v; });
        },
        monitor, "hierarchy", from, to);
    Samples& samples = levels.samples;
    levels.near_of.assign(n, {});
    samples.edges_of.assign(n, {});
    samples.base_edges_of.assign(n, {});
    for (const auto& list : around) {
        for (const SampleEdge& edge : list) {
            for (const int s : {edge.u, edge.v}) levels.near_of[s].push_back(static_cast<int>(levels.near.size()));
            levels.near.push_back(edge);
            if (edge.level > 0) continue;
            for (const int s : {edge.u, edge.v}) {
                samples.edges_of[s].push_back(static_cast<int>(samples.edges.size()));
                samples.base_edges_of[s].push_back(static_cast<int>(samples.edges.size()));
            }
            samples.edges.push_back(edge);
        }
    }
}

// Choose the level's vertices among those of the one below; cells that touch across a mesh edge are neighbours.
Pairs pick_level(const TriangleMesh& mesh, VertexLevels& levels, int level, Monitor& monitor) {
    Samples& samples = levels.samples;
    const int n = mesh.vertex_count();
    const double radius = packing * levels.spacing(level);
    std::vector<double> nearest(n, std::numeric_limits<double>::max());
    std::vector<int> owner(n, -1);
    Window window(mesh);
    for (int v = 0; v < n; ++v) {
        if (samples.level[v] != level - 1 || owner[v] >= 0) continue;
        monitor.check();
        samples.level[v] = level;
        window.run(samples.point[v], radius);
        nearest[v] = 0.0;
        owner[v] = v;
        for (const int x : window.reached()) {
            const double d = window.distance(x);
            if (d >= radius || d >= nearest[x]) continue;
            nearest[x] = d;
            owner[x] = v;
        }
    }
    Pairs pairs;
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        const int a = owner[mesh.from(h)], b = owner[mesh.to(h)];
        if (a >= 0 && b >= 0 && a != b) pairs.emplace_back(std::min(a, b), std::max(a, b));
    }
    sort_unique(pairs);
    return pairs;
}

void join_level(const TriangleMesh& mesh, VertexLevels& levels, int level, const Pairs& pairs, int threads,
                Monitor& monitor, double from, double to) {
    Samples& samples = levels.samples;
    std::vector<std::size_t> begin;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        if (i == 0 || pairs[i].first != pairs[i - 1].first) begin.push_back(i);
    }
    begin.push_back(pairs.size());
    std::vector<std::vector<SampleEdge>> made(begin.size() - 1);
    std::vector<Window> windows(worker_count(threads), Window(mesh));
    parallel_for(
        static_cast<int>(made.size()), threads,
        [&](int group, int worker) {
            const int u = pairs[begin[group]].first;
            Window& window = windows[worker];
            window.run(samples.point[u], 2.2 * packing * levels.spacing(level) + 2.0 * samples.spacing);
            for (std::size_t i = begin[group]; i < begin[group + 1]; ++i) {
                const int v = pairs[i].second;
                const auto polar = window.query(samples.point[v]);
                if (!polar) continue;
                auto straight = straight_edge(mesh, samples, u, v, *polar, {});
                if (!straight) continue;
                SampleEdge& edge = *straight;
                edge.level = level;
                // What lies along it: inside a map it counts only where the whole path is mapped.
                const int steps = static_cast<int>(edge.length / levels.spacing(1));
                for (int k = 1; k < steps; ++k) {
                    const Trace t = trace(mesh, samples.point[u], edge.at_u, edge.length * k / steps);
                    const int along = nearest_corner(mesh, t.end);
                    if (along != u && along != v) edge.witnesses.push_back(along);
                }
                made[group].push_back(std::move(edge));
            }
        },
        monitor, "hierarchy", from, to);
    for (auto& list : made) {
        for (SampleEdge& edge : list) {
            for (const int s : {edge.u, edge.v}) samples.edges_of[s].push_back(static_cast<int>(samples.edges.size()));
            samples.edges.push_back(std::move(edge));
        }
    }
}

}  // namespace

VertexLevels make_vertex_levels(const TriangleMesh& mesh, int levels, int threads, Monitor& monitor, double from,
                                double to, double near) {
    VertexLevels result;
    result.near_spacings = near;
    Samples& samples = result.samples;
    const int n = mesh.vertex_count();
    samples.spacing = mesh.mean_edge;
    samples.position = mesh.position;
    samples.area = mesh.vertex_area;
    samples.level.assign(n, 0);
    samples.near_vertex.resize(n);
    for (int v = 0; v < n; ++v) {
        samples.point.push_back(point_near_vertex(mesh, v));
        samples.owner.push_back(v);
        // The vertex itself as its sample sees it, so that densify() finds it.
        const SurfacePoint& p = samples.point[v];
        const auto& corners = mesh.face[p.face];
        const int k = static_cast<int>(std::find(corners.begin(), corners.end(), v) - corners.begin());
        const Complex way = mesh.corner[p.face][k] - planar(mesh, p);
        samples.near_vertex[v] = {{v, static_cast<float>(std::abs(way)), static_cast<float>(std::arg(way))}};
    }
    const double step = (to - from) / levels;
    join_near(mesh, result, threads, monitor, from, from + step);
    for (int level = 1; level < levels; ++level) {
        const Pairs pairs = pick_level(mesh, result, level, monitor);
        join_level(mesh, result, level, pairs, threads, monitor, from + level * step, from + (level + 1) * step);
    }
    return result;
}

}  // namespace isograft
