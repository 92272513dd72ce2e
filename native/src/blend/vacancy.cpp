// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/vacancy.h"

#include <algorithm>
#include <numeric>

namespace isograft {

namespace {

std::vector<char> with_neighbours(const Samples& samples, const std::vector<char>& marked) {
    std::vector<char> result = marked;
    for (int s = 0; s < samples.count(); ++s) {
        if (!marked[s]) continue;
        for (const int e : samples.base_edges_of[s]) result[samples.edges[e].other(s)] = 1;
    }
    return result;
}

}  // namespace

std::vector<std::vector<int>> vacant_parts(const Pair& pair, const PartialMap& map, double least) {
    const Samples& target = pair.target.samples;
    std::vector<char> covered(target.count(), 0);
    for (std::size_t s = 0; s < map.mapped.size(); ++s) {
        if (!map.mapped[s]) continue;
        const int home = target.nearest(pair.target.mesh, map.image[s]);
        if (home >= 0) covered[home] = 1;
    }
    // The two samplings are not the same: even where a map is whole, not every sample of T is nearest to an image.
    covered = with_neighbours(target, covered);
    std::vector<char> open(target.count());
    for (int t = 0; t < target.count(); ++t) open[t] = covered[t] ? 0 : 1;
    std::vector<std::vector<int>> parts;
    std::vector<double> areas;
    const double total = std::accumulate(target.area.begin(), target.area.end(), 0.0);
    for (int seed = 0; seed < target.count(); ++seed) {
        if (!open[seed]) continue;
        std::vector<int> part{seed};
        open[seed] = 0;
        double area = 0.0;
        for (std::size_t i = 0; i < part.size(); ++i) {
            area += target.area[part[i]];
            for (const int e : target.base_edges_of[part[i]]) {
                const int t = target.edges[e].other(part[i]);
                if (!open[t]) continue;
                open[t] = 0;
                part.push_back(t);
            }
        }
        if (area < least * total) continue;
        std::sort(part.begin(), part.end());
        parts.push_back(std::move(part));
        areas.push_back(area);
    }
    std::vector<std::size_t> order(parts.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return areas[a] > areas[b]; });
    std::vector<std::vector<int>> result;
    result.reserve(parts.size());
    for (const std::size_t i : order) result.push_back(std::move(parts[i]));
    return result;
}

namespace {

// Samples of S within `steps` edges of `sample`, into `ring`; `mark` is all false before and after.
void ring_of(const Samples& source, int sample, int steps, std::vector<int>& ring, std::vector<char>& mark) {
    ring.assign(1, sample);
    mark[sample] = 1;
    std::size_t begin = 0;
    for (int step = 0; step < steps; ++step) {
        const std::size_t end = ring.size();
        for (; begin < end; ++begin) {
            for (const int e : source.base_edges_of[ring[begin]]) {
                const int other = source.edges[e].other(ring[begin]);
                if (mark[other]) continue;
                mark[other] = 1;
                ring.push_back(other);
            }
        }
    }
    for (const int s : ring) mark[s] = 0;
}

}  // namespace

std::vector<char> doubled(const Pair& pair, const PartialMap& map, const std::vector<double>& doubts) {
    constexpr int near = 4;           // edges on S: nearer samples are one part that is only squeezed
    constexpr double together = 0.8;  // spacings on T
    constexpr int fewest = 4;         // samples of a part
    const Samples& source = pair.source.samples;
    const Samples& target = pair.target.samples;
    std::vector<std::vector<int>> cell(target.count());
    std::vector<int> home(source.count(), -1);
    for (int s = 0; s < source.count(); ++s) {
        if (!map.mapped[s]) continue;
        home[s] = target.nearest(pair.target.mesh, map.image[s]);
        if (home[s] >= 0) cell[home[s]].push_back(s);
    }
    std::vector<std::vector<int>> rivals(source.count());
    std::vector<int> ring;
    std::vector<char> mark(source.count(), 0);
    for (int s = 0; s < source.count(); ++s) {
        if (home[s] < 0) continue;
        std::vector<int> there = cell[home[s]];
        for (const int e : target.base_edges_of[home[s]]) {
            const auto& beside = cell[target.edges[e].other(home[s])];
            there.insert(there.end(), beside.begin(), beside.end());
        }
        ring_of(source, s, near, ring, mark);
        for (const int r : ring) mark[r] = 1;
        for (const int other : there) {
            if (mark[other]) continue;
            if ((map.position[other] - map.position[s]).norm() < together * source.spacing) rivals[s].push_back(other);
        }
        for (const int r : ring) mark[r] = 0;
    }
    // Connected parts of S in conflict.
    std::vector<int> part(source.count(), -1);
    std::vector<double> sum;
    std::vector<int> size;
    for (int seed = 0; seed < source.count(); ++seed) {
        if (part[seed] >= 0 || rivals[seed].empty()) continue;
        const int label = static_cast<int>(size.size());
        std::vector<int> stack{seed};
        part[seed] = label;
        sum.push_back(0.0);
        size.push_back(0);
        while (!stack.empty()) {
            const int u = stack.back();
            stack.pop_back();
            sum[label] += doubts[u];
            ++size[label];
            for (const int e : source.base_edges_of[u]) {
                const int v = source.edges[e].other(u);
                if (part[v] >= 0 || rivals[v].empty()) continue;
                part[v] = label;
                stack.push_back(v);
            }
        }
    }
    std::vector<char> loses(source.count(), 0);
    for (int s = 0; s < source.count(); ++s) {
        if (part[s] < 0 || size[part[s]] < fewest) continue;
        for (const int other : rivals[s]) {
            if (part[other] == part[s] || size[part[other]] < fewest) continue;
            const double mine = sum[part[s]] / size[part[s]];
            const double theirs = sum[part[other]] / size[part[other]];
            if (mine > theirs || (mine == theirs && part[s] > part[other])) loses[s] = 1;
        }
    }
    return loses;
}

namespace {

bool compatible(const Samples& source, const PartialMap& a, const PartialMap& b, double radius) {
    constexpr double far = 3.0;  // radii on S that are no longer one place
    int shared = 0;
    int agreed = 0;
    int together = 0;
    int doubled = 0;
    for (int s = 0; s < source.count(); ++s) {
        if (!a.mapped[s]) continue;
        if (b.mapped[s]) {
            ++shared;
            agreed += (a.position[s] - b.position[s]).norm() < radius ? 1 : 0;
        }
        for (int r = 0; r < source.count(); ++r) {
            if (!b.mapped[r] || (a.position[s] - b.position[r]).norm() >= radius) continue;
            ++together;
            doubled += (source.position[s] - source.position[r]).norm() > far * radius ? 1 : 0;
        }
    }
    return 2 * agreed >= shared && 4 * doubled <= together;
}

}  // namespace

std::vector<std::vector<std::size_t>> compatible_sets(const Samples& source, const std::vector<const PartialMap*>& maps,
                                                      const std::vector<double>& weights, double radius,
                                                      std::size_t count) {
    std::vector<std::size_t> order(maps.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return weights[a] > weights[b]; });
    std::vector<char> taken(maps.size(), 0);
    std::vector<std::vector<std::size_t>> sets;
    for (const std::size_t first : order) {
        if (taken[first]) continue;
        if (sets.size() == count) break;
        std::vector<std::size_t> set;
        for (const std::size_t i : order) {
            if (taken[i]) continue;
            const bool fits = std::all_of(
                set.begin(), set.end(), [&](std::size_t k) { return compatible(source, *maps[k], *maps[i], radius); });
            if (!fits) continue;
            taken[i] = 1;
            set.push_back(i);
        }
        sets.push_back(std::move(set));
    }
    return sets;
}

}  // namespace isograft
