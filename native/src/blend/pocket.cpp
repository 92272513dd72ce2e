// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/pocket.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "blend/vacancy.h"
#include "geodesic/window.h"

namespace isograft {

namespace {

// Share of S's area up to which an unmapped part is a pocket and not a part that T lacks.
constexpr double largest_pocket = 0.05;
// Samples around a pocket whose distances tell where things are.
constexpr int most_anchors = 12;
constexpr std::size_t fewest_anchors = 4;
// How far around a pocket they may lie, in unit lengths: bodies bend at joints.
constexpr double anchor_reach = 0.25;
// Of an image from a vertex of T, in spacings: nearer ones are taken. Samples lie at least one spacing apart.
constexpr double taken = 0.75;
constexpr float unreached = std::numeric_limits<float>::infinity();

struct Anchor {
    int sample = -1;
    // Per sample of the pocket, and per vertex of T.
    std::vector<float> on_source, on_target;
};

// Mapped samples near a pocket, far from each other.
std::vector<int> anchor_samples(const Samples& source, const PartialMap& map, const std::vector<int>& pocket) {
    std::vector<double> way(source.count(), std::numeric_limits<double>::infinity());
    std::vector<int> queue;
    for (const int s : pocket) {
        way[s] = 0.0;
        queue.push_back(s);
    }
    // Label correcting: the neighbourhood is small.
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const int s = queue[i];
        for (const int e : source.base_edges_of[s]) {
            const int other = source.edges[e].other(s);
            const double through = way[s] + source.edges[e].length;
            if (!map.mapped[other] || through > anchor_reach || through >= way[other]) continue;
            way[other] = through;
            queue.push_back(other);
        }
    }
    std::vector<int> near;
    for (int s = 0; s < source.count(); ++s) {
        if (map.mapped[s] && std::isfinite(way[s])) near.push_back(s);
    }
    std::vector<int> chosen;
    std::vector<double> gap(near.size(), std::numeric_limits<double>::infinity());
    while (static_cast<int>(chosen.size()) < most_anchors && chosen.size() < near.size()) {
        std::size_t next = 0;
        // The nearest first, then the farthest from those chosen.
        for (std::size_t i = 1; i < near.size(); ++i) {
            const bool better = chosen.empty() ? way[near[i]] < way[near[next]] : gap[i] > gap[next];
            if (better) next = i;
        }
        chosen.push_back(near[next]);
        for (std::size_t i = 0; i < near.size(); ++i) {
            gap[i] = std::min(gap[i], (source.position[near[i]] - source.position[near[next]]).norm());
        }
    }
    return chosen;
}

// What lies along a boundary may be what T lacks, and distances from one side alone say little. A slit or a pinhole in
// a finger does not make it one.
bool along_boundary(const std::vector<int>& pocket, const SampledMesh& source) {
    const auto open = std::count_if(pocket.begin(), pocket.end(), [&](int s) {
        const auto& corners = source.mesh.face[source.samples.point[s].face];
        return std::any_of(corners.begin(), corners.end(), [&](int v) { return source.mesh.on_boundary[v] != 0; });
    });
    return 4 * open > static_cast<std::ptrdiff_t>(pocket.size());
}

std::vector<Anchor> measure(const std::vector<int>& samples, const std::vector<int>& pocket, const PartialMap& map,
                            const Pair& pair, std::vector<Window>& on_source, std::vector<Window>& on_target,
                            Monitor& monitor) {
    const SampledMesh& source = pair.source;
    const SampledMesh& target = pair.target;
    std::vector<Anchor> anchors(samples.size());
    parallel_for(
        static_cast<int>(samples.size()), static_cast<int>(on_source.size()),
        [&](int k, int worker) {
            const int sample = samples[k];
            Anchor anchor{sample, std::vector<float>(pocket.size(), unreached),
                          std::vector<float>(target.mesh.vertex_count(), unreached)};
            Window& window = on_source[worker];
            window.run(source.samples.point[sample], 3.0 * anchor_reach);
            float longest = 0.0F;
            for (std::size_t i = 0; i < pocket.size(); ++i) {
                const SurfacePoint& point = source.samples.point[pocket[i]];
                const auto polar = window.query(point);
                if (!polar || window.bent_at(point)) continue;
                anchor.on_source[i] = static_cast<float>(polar->distance);
                longest = std::max(longest, anchor.on_source[i]);
            }
            if (longest <= 0.0F) return;
            Window& there = on_target[worker];
            there.run(map.image[sample], 1.3 * longest + 2.0 * source.samples.spacing);
            for (const int v : there.reached()) {
                if (!there.bent(v)) anchor.on_target[v] = static_cast<float>(there.distance(v));
            }
            anchors[k] = std::move(anchor);
        },
        monitor);
    anchors.erase(std::remove_if(anchors.begin(), anchors.end(), [](const Anchor& a) { return a.sample < 0; }),
                  anchors.end());
    return anchors;
}

// Vertices of T that may still be taken: all at first, then those on which none of `samples` lies.
std::vector<int> free_vertices(const SampledMesh& target) {
    std::vector<int> result;
    for (int v = 0; v < target.mesh.vertex_count(); ++v) {
        if (target.samples.owner[v] >= 0) result.push_back(v);
    }
    return result;
}

void take(const std::vector<int>& samples, const PartialMap& map, const Pair& pair, std::vector<int>& free) {
    const SampledMesh& target = pair.target;
    std::vector<std::vector<int>> cell(target.samples.count());
    for (const int s : samples) {
        const int home = target.samples.nearest(target.mesh, map.image[s]);
        if (home >= 0) cell[home].push_back(s);
    }
    const double limit = taken * pair.source.samples.spacing;
    const auto covered = [&](int v) {
        const auto covers = [&](int c) {
            return std::any_of(cell[c].begin(), cell[c].end(),
                               [&](int s) { return (map.position[s] - target.mesh.position[v]).norm() < limit; });
        };
        const int home = target.samples.owner[v];
        const auto& around = target.samples.base_edges_of[home];
        return covers(home) || std::any_of(around.begin(), around.end(),
                                           [&](int e) { return covers(target.samples.edges[e].other(home)); });
    };
    free.erase(std::remove_if(free.begin(), free.end(), covered), free.end());
}

struct Fit {
    int vertex = -1;
    /// Mean difference of the distances beyond what is bearable; at most 0 is accepted.
    double excess = std::numeric_limits<double>::max();
};

// Where on T sample `i` of the pocket is as far from the anchors as on S.
Fit best_fit(std::size_t i, const std::vector<Anchor>& anchors, const std::vector<int>& free, double spacing) {
    Fit best;
    std::vector<double> difference;
    for (const int v : free) {
        difference.clear();
        double bearable = 0.0;
        for (const Anchor& anchor : anchors) {
            const double here = anchor.on_source[i];
            const double there = anchor.on_target[v];
            if (!std::isfinite(here)) continue;
            difference.push_back(std::isfinite(there) ? std::abs(there - here) : 1.0);
            bearable += 0.22 * spacing + 0.045 * here;
        }
        if (difference.size() < fewest_anchors) continue;
        bearable /= static_cast<double>(difference.size());
        const std::size_t kept = std::max<std::size_t>(fewest_anchors, 3 * difference.size() / 4);
        std::sort(difference.begin(), difference.end());
        double sum = 0.0;
        for (std::size_t k = 0; k < kept; ++k) sum += difference[k];
        const double excess = sum / static_cast<double>(kept) - bearable;
        if (excess < best.excess) best = {v, excess};
    }
    return best;
}

// The turn that takes the directions to mapped neighbours to those between the images.
Complex turn_of(int sample, const SurfacePoint& point, const PartialMap& map, const Pair& pair) {
    const Samples& source = pair.source.samples;
    const Eigen::Vector3d x = position(pair.target.mesh, point);
    Complex turn(0.0, 0.0);
    for (const int e : source.base_edges_of[sample]) {
        const SampleEdge& edge = source.edges[e];
        const int other = edge.other(sample);
        if (!map.mapped[other]) continue;
        const Complex to = flatten(pair.target.mesh, point.face, map.position[other] - x);
        if (std::abs(to) < 1e-9) continue;
        turn += unit(to) * std::conj(sample == edge.u ? edge.at_u : edge.at_v);
    }
    return std::abs(turn) > 1e-9 ? unit(turn) : Complex(1.0, 0.0);
}

// Parts of S to be filled. A mapped sample none of whose neighbours is mapped belongs to them, unless it is a landmark.
std::vector<std::vector<int>> pockets_of(const PartialMap& map, const SampledMesh& side, int landmarks) {
    const Samples& source = side.samples;
    const auto alone = [&](int s) {
        const auto& edges = source.base_edges_of[s];
        return s >= landmarks && !edges.empty() && std::none_of(edges.begin(), edges.end(), [&](int e) {
                   return map.mapped[source.edges[e].other(s)] != 0;
               });
    };
    std::vector<char> open(source.count());
    for (int s = 0; s < source.count(); ++s) open[s] = map.mapped[s] && !alone(s) ? 0 : 1;
    const double total = std::accumulate(source.area.begin(), source.area.end(), 0.0);
    std::vector<std::vector<int>> result;
    for (std::vector<int>& pocket : parts_by_area(source, std::move(open), 0.0)) {
        double area = 0.0;
        for (const int s : pocket) area += source.area[s];
        if (area <= largest_pocket * total && !along_boundary(pocket, side)) result.push_back(std::move(pocket));
    }
    return result;
}

// Drop samples most of whose mapped neighbours lie farther away than the edges allow, until none is left.
void drop_strays(PartialMap& map, const Samples& source, std::vector<int>& added) {
    bool changed = true;
    while (changed) {
        changed = false;
        std::vector<int> kept;
        for (const int s : added) {
            int near = 0;
            int far = 0;
            for (const int e : source.base_edges_of[s]) {
                const int other = source.edges[e].other(s);
                if (!map.mapped[other]) continue;
                const double apart = (map.position[other] - map.position[s]).norm();
                ++(apart < 1.4 * source.edges[e].length + 0.5 * source.spacing ? near : far);
            }
            if (near > far) {
                kept.push_back(s);
            } else {
                map.drop(s);
                changed = true;
            }
        }
        added = std::move(kept);
    }
}

}  // namespace

void fill_pockets(PartialMap& map, const Pair& pair, int landmarks, int threads, Monitor& monitor) {
    const Samples& source = pair.source.samples;
    const TriangleMesh& target = pair.target.mesh;
    if (map.count == 0) return;
    const std::vector<std::vector<int>> pockets = pockets_of(map, pair.source, landmarks);
    const PartialMap before = map;
    for (const std::vector<int>& pocket : pockets) {
        for (const int s : pocket) map.drop(s);
    }
    std::vector<int> mapped;
    for (int s = 0; s < source.count(); ++s) {
        if (map.mapped[s]) mapped.push_back(s);
    }
    std::vector<int> free = free_vertices(pair.target);
    take(mapped, map, pair, free);
    std::vector<Window> on_source(worker_count(threads), Window(pair.source.mesh));
    std::vector<Window> on_target(worker_count(threads), Window(target));
    for (const std::vector<int>& pocket : pockets) {
        const std::vector<int> around = anchor_samples(source, map, pocket);
        if (around.size() < fewest_anchors) {
            for (const int s : pocket) {
                if (before.mapped[s]) map.put(target, s, before.image[s], before.rotation[s]);
            }
            continue;
        }
        const std::vector<Anchor> anchors = measure(around, pocket, map, pair, on_source, on_target, monitor);
        std::vector<Fit> fits(pocket.size());
        parallel_for(
            static_cast<int>(pocket.size()), threads,
            [&](int i, int /*worker*/) { fits[i] = best_fit(i, anchors, free, source.spacing); }, monitor);
        std::vector<int> added;
        for (std::size_t i = 0; i < pocket.size(); ++i) {
            const Fit& fit = fits[i];
            if (fit.vertex < 0 || fit.excess > 0.0) continue;
            map.put(target, pocket[i], point_near_vertex(target, fit.vertex), Complex(1.0, 0.0));
            added.push_back(pocket[i]);
        }
        drop_strays(map, source, added);
        for (const int s : added) map.rotation[s] = turn_of(s, map.image[s], map, pair);
        take(added, map, pair, free);
    }
}

}  // namespace isograft
