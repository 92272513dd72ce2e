// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/parallel.h"
#include "base/random.h"
#include "geodesic/shoot.h"
#include "geodesic/window.h"
#include "isograft/errors.h"

namespace isograft {

void HierarchyOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("hierarchy." + what);
    };
    require(samples >= 50 && samples <= 20000, "samples must be in [50, 20000]");
    require(min_samples >= 10 && min_samples <= samples, "min_samples must be in [10, samples]");
    require(levels >= 1 && levels <= 10, "levels must be in [1, 10]");
    require(base_reach >= 1.0 && base_reach <= 5.0, "base_reach must be in [1, 5]");
    require(level_reach >= 1.0 && level_reach <= 5.0, "level_reach must be in [1, 5]");
    require(reshoot_tolerance > 0.0 && reshoot_tolerance < 1.0, "reshoot_tolerance must be in (0, 1)");
    require(coarse_edge >= 0.0 && coarse_edge <= 1.0, "coarse_edge must be in [0, 1]");
}

std::optional<SampleEdge> straight_edge(const TriangleMesh& mesh, const Samples& samples, int u, int v,
                                        const Polar& polar, const StraightEdgeOptions& options) {
    const auto shot = shoot(mesh, samples.point[u], samples.point[v], std::polar(1.0, polar.angle), polar.distance,
                            {.max_traces = 6, .tolerance = options.tolerance});
    if (!shot || std::abs(shot->length - polar.distance) > options.same_path * polar.distance) return std::nullopt;
    SampleEdge edge;
    edge.u = u;
    edge.v = v;
    edge.length = shot->length;
    edge.at_u = shot->departure;
    edge.at_v = -shot->arrival;
    return edge;
}

double sample_spacing(double area, int samples) {
    // Random Poisson disks fill 0.72 of what a hexagonal packing of their centres would.
    return std::sqrt(0.72 * area / samples);
}

int Samples::nearest(const TriangleMesh& mesh, const SurfacePoint& p) const {
    const Eigen::Vector3d x = isograft::position(mesh, p);
    int best = -1;
    double best_distance = std::numeric_limits<double>::max();
    const auto consider = [&](int s) {
        const double d = (position[s] - x).squaredNorm();
        if (d < best_distance || (d == best_distance && s < best)) {
            best_distance = d;
            best = s;
        }
    };
    const int start = owner[nearest_corner(mesh, p)];
    if (start < 0) return -1;
    consider(start);
    for (const int e : base_edges_of[start]) consider(edges[e].other(start));
    return best;
}

std::int64_t Samples::bytes() const {
    std::int64_t total = static_cast<std::int64_t>(point.size() * (sizeof(SurfacePoint) + sizeof(Eigen::Vector3d)));
    total += static_cast<std::int64_t>(edges.size() * (sizeof(SampleEdge) + 4 * sizeof(int)));
    for (const auto& list : near_vertex) total += static_cast<std::int64_t>(list.size() * sizeof(NearSample));
    return total + static_cast<std::int64_t>(owner.size() * sizeof(int));
}

namespace {

// Points from which samples are picked: every triangle gives one, large triangles more.
std::vector<SurfacePoint> candidate_points(const TriangleMesh& mesh, double spacing, Random& random) {
    std::vector<SurfacePoint> candidates;
    const double cell = spacing * spacing / 8.0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        const double area = 0.5 * mesh.corner[f][1].real() * mesh.corner[f][2].imag();
        const int count = std::min(1000, std::max(1, static_cast<int>(area / cell)));
        SurfacePoint p;
        p.face = f;
        candidates.push_back(p);
        for (int i = 1; i < count; ++i) {
            const double r = std::sqrt(random.uniform());
            const double s = random.uniform();
            p.weight = {1.0 - r, r * (1.0 - s), r * s};
            for (double& w : p.weight) w = 0.94 * w + 0.02;
            candidates.push_back(p);
        }
    }
    return candidates;
}

std::vector<std::vector<int>> group_by_face(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points) {
    std::vector<std::vector<int>> group(mesh.face_count());
    for (std::size_t i = 0; i < points.size(); ++i) group[points[i].face].push_back(static_cast<int>(i));
    return group;
}

// Call visit(item, polar) for each grouped item in the triangles a window reached.
template <class Visit>
void visit_reached(const TriangleMesh& mesh, const Window& window, const std::vector<std::vector<int>>& group,
                   const std::vector<SurfacePoint>& points, std::vector<int>& seen, int stamp, Visit&& visit) {
    for (const int v : window.reached()) {
        for (int i = mesh.vertex_face_begin[v]; i < mesh.vertex_face_begin[v + 1]; ++i) {
            const int f = mesh.vertex_face[i];
            if (seen[f] == stamp) continue;
            seen[f] = stamp;
            for (const int item : group[f]) {
                if (const auto polar = window.query(points[item])) visit(item, *polar);
            }
        }
    }
}

void pick_samples(const TriangleMesh& mesh, const std::vector<SurfacePoint>& fixed, Samples& samples, Random& random,
                  Monitor& monitor) {
    std::vector<SurfacePoint> candidates = candidate_points(mesh, samples.spacing, random);
    std::vector<int> order(candidates.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    random.shuffle(order);
    for (std::size_t i = fixed.size(); i-- > 0;) {
        order.insert(order.begin(), static_cast<int>(candidates.size()));
        candidates.push_back(fixed[i]);
    }
    const auto group = group_by_face(mesh, candidates);
    std::size_t picked = 0;
    std::vector<char> covered(candidates.size(), 0);
    std::vector<int> seen(mesh.face_count(), -1);
    Window window(mesh);
    for (const int c : order) {
        if (picked++ >= fixed.size() && covered[c]) continue;
        monitor.check();
        window.run(candidates[c], 1.1 * samples.spacing);
        visit_reached(mesh, window, group, candidates, seen, samples.count(), [&](int item, const Polar& polar) {
            if (polar.distance < samples.spacing) covered[item] = 1;
        });
        covered[c] = 1;
        samples.point.push_back(candidates[c]);
        samples.position.push_back(position(mesh, candidates[c]));
    }
}

void number_levels(const TriangleMesh& mesh, Samples& samples, int levels, Monitor& monitor) {
    const int n = samples.count();
    const auto group = group_by_face(mesh, samples.point);
    samples.level.assign(n, 0);
    std::vector<int> seen(mesh.face_count(), -1);
    int stamp = 0;
    Window window(mesh);
    for (int level = 1; level < levels; ++level) {
        const double radius = samples.spacing * (1 << level);
        std::vector<char> covered(n, 0);
        for (int i = 0; i < n; ++i) {
            if (samples.level[i] != level - 1 || covered[i]) continue;
            monitor.check();
            samples.level[i] = level;
            window.run(samples.point[i], 1.05 * radius);
            visit_reached(mesh, window, group, samples.point, seen, stamp++, [&](int j, const Polar& polar) {
                if (polar.distance < radius) covered[j] = 1;
            });
        }
    }
}

struct Neighbourhood {
    std::vector<SampleEdge> edges;
    std::vector<NearSample> near;  // `sample` holds the vertex here
};

class EdgeMaker {
  public:
    EdgeMaker(const TriangleMesh& mesh, const Samples& samples, const HierarchyOptions& options)
        : mesh_(mesh), samples_(samples), options_(options), group_(group_by_face(mesh, samples.point)) {}

    [[nodiscard]] double reach(int level) const {
        return (level == 0 ? options_.base_reach : options_.level_reach) * samples_.spacing * (1 << level);
    }

    Neighbourhood around(int u, Window& window, std::vector<int>& seen) const {
        Neighbourhood result;
        const double radius = std::max(reach(samples_.level[u]), reach(0));
        window.run(samples_.point[u], 1.02 * radius + mesh_.mean_edge);
        visit_reached(mesh_, window, group_, samples_.point, seen, u, [&](int v, const Polar& polar) {
            if (v > u) add_edge(u, v, polar, result.edges);
        });
        for (const int x : window.reached()) {
            if (window.distance(x) > 2.2 * samples_.spacing) continue;
            result.near.push_back({x, static_cast<float>(window.distance(x)), static_cast<float>(window.angle(x))});
        }
        return result;
    }

  private:
    void add_edge(int u, int v, const Polar& polar, std::vector<SampleEdge>& edges) const {
        const int level = std::min(samples_.level[u], samples_.level[v]);
        if (polar.distance > reach(level)) return;
        auto edge = straight_edge(mesh_, samples_, u, v, polar, {.same_path = options_.reshoot_tolerance});
        if (!edge) return;
        while (edge->level < level && polar.distance > reach(edge->level)) ++edge->level;
        edges.push_back(std::move(*edge));
    }

    const TriangleMesh& mesh_;
    const Samples& samples_;
    const HierarchyOptions& options_;
    std::vector<std::vector<int>> group_;
};

void collect(const TriangleMesh& mesh, Samples& samples, std::vector<Neighbourhood>& around) {
    const int n = samples.count();
    samples.edges_of.assign(n, {});
    samples.base_edges_of.assign(n, {});
    samples.owner.assign(mesh.vertex_count(), -1);
    samples.near_vertex.assign(mesh.vertex_count(), {});
    std::vector<float> nearest(mesh.vertex_count(), std::numeric_limits<float>::max());
    for (int u = 0; u < n; ++u) {
        for (auto& edge : around[u].edges) {
            const int index = static_cast<int>(samples.edges.size());
            for (const int s : {edge.u, edge.v}) {
                samples.edges_of[s].push_back(index);
                if (edge.level == 0) samples.base_edges_of[s].push_back(index);
            }
            samples.edges.push_back(std::move(edge));
        }
        for (const NearSample& near : around[u].near) {
            const int x = near.sample;
            const bool nearer = near.distance < nearest[x];
            if (near.distance < 1.6 * samples.spacing || nearer) {
                samples.near_vertex[x].push_back({u, near.distance, near.angle});
            }
            if (nearer) {
                nearest[x] = near.distance;
                samples.owner[x] = u;
            }
        }
    }
    samples.area.assign(n, 0.0);
    for (int x = 0; x < mesh.vertex_count(); ++x) {
        if (samples.owner[x] >= 0) samples.area[samples.owner[x]] += mesh.vertex_area[x];
    }
    // A coarse mesh has samples that own no vertex; they still stand for some area.
    const double share = mesh.area / std::max(1, n);
    for (double& a : samples.area) a = std::max(a, 0.2 * share);
}

void find_witnesses(const TriangleMesh& mesh, Samples& samples) {
    for (auto& edge : samples.edges) {
        if (edge.level == 0) continue;
        const int count = static_cast<int>(edge.length / (1.5 * samples.spacing));
        for (int k = 1; k <= count; ++k) {
            const Trace t = trace(mesh, samples.point[edge.u], edge.at_u, edge.length * k / (count + 1));
            const int owner = samples.nearest(mesh, t.end);
            if (owner >= 0 && owner != edge.u && owner != edge.v) edge.witnesses.push_back(owner);
        }
    }
}

}  // namespace

Samples spread_samples(const TriangleMesh& mesh, double spacing, const HierarchyOptions& options, std::uint64_t seed,
                       Monitor& monitor, const std::vector<SurfacePoint>& fixed) {
    Samples samples;
    samples.spacing = spacing;
    Random random(seed);
    pick_samples(mesh, fixed, samples, random, monitor);
    number_levels(mesh, samples, options.levels, monitor);
    return samples;
}

void join_samples(const TriangleMesh& mesh, Samples& samples, const HierarchyOptions& options, int threads,
                  Monitor& monitor, double from, double to) {
    const EdgeMaker maker(mesh, samples, options);
    std::vector<Neighbourhood> around(samples.count());
    const int workers = worker_count(threads);
    std::vector<Window> windows(workers, Window(mesh));
    std::vector<std::vector<int>> seen(workers, std::vector<int>(mesh.face_count(), -1));
    parallel_for(
        samples.count(), threads,
        [&](int u, int worker) { around[u] = maker.around(u, windows[worker], seen[worker]); }, monitor, "samples",
        from, to);
    collect(mesh, samples, around);
    find_witnesses(mesh, samples);
}

Samples make_samples(const TriangleMesh& mesh, double spacing, const HierarchyOptions& options, std::uint64_t seed,
                     int threads, Monitor& monitor, double from, double to, const std::vector<SurfacePoint>& fixed) {
    Samples samples = spread_samples(mesh, spacing, options, seed, monitor, fixed);
    join_samples(mesh, samples, options, threads, monitor, from, to);
    return samples;
}

}  // namespace isograft
