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

// The marked samples, sorted into parts joined by level-0 edges.
std::vector<std::vector<int>> connected_parts(const Samples& samples, std::vector<char> marked) {
    std::vector<std::vector<int>> parts;
    for (int seed = 0; seed < samples.count(); ++seed) {
        if (!marked[seed]) continue;
        std::vector<int> part{seed};
        marked[seed] = 0;
        for (std::size_t i = 0; i < part.size(); ++i) {
            for (const int e : samples.base_edges_of[part[i]]) {
                const int other = samples.edges[e].other(part[i]);
                if (!marked[other]) continue;
                marked[other] = 0;
                part.push_back(other);
            }
        }
        parts.push_back(std::move(part));
    }
    return parts;
}

}  // namespace

std::vector<std::vector<int>> parts_by_area(const Samples& samples, std::vector<char> marked, double least) {
    std::vector<std::vector<int>> parts;
    std::vector<double> areas;
    const double total = std::accumulate(samples.area.begin(), samples.area.end(), 0.0);
    for (std::vector<int>& part : connected_parts(samples, std::move(marked))) {
        double area = 0.0;
        for (const int t : part) area += samples.area[t];
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

std::vector<std::vector<int>> vacant_parts(const Pair& pair, const PartialMap& map, double least) {
    const Samples& target = pair.target.samples;
    std::vector<char> covered(target.count(), 0);
    for (const int home : homes_of(map, pair.target)) {
        if (home >= 0) covered[home] = 1;
    }
    // The two samplings are not the same: even where a map is whole, not every sample of T is nearest to an image.
    covered = with_neighbours(target, covered);
    std::vector<char> open(target.count());
    for (int t = 0; t < target.count(); ++t) open[t] = covered[t] ? 0 : 1;
    return parts_by_area(target, std::move(open), least);
}

namespace {

// Samples of S within `steps` edges of `sample`, into `ring`, and marked.
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
}

}  // namespace

std::vector<char> doubled(const Pair& pair, const PartialMap& map, const std::vector<double>& doubts) {
    constexpr int near = 4;            // edges on S: nearer samples are one part that is only squeezed
    constexpr double together = 0.8;   // spacings on T
    constexpr std::size_t fewest = 4;  // samples of a part
    const Samples& source = pair.source.samples;
    const Samples& target = pair.target.samples;
    std::vector<std::vector<int>> cell(target.count());
    const std::vector<int> home = homes_of(map, pair.target);
    for (int s = 0; s < source.count(); ++s) {
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
        for (const int other : there) {
            if (mark[other]) continue;
            if ((map.position[other] - map.position[s]).norm() < together * source.spacing) rivals[s].push_back(other);
        }
        for (const int r : ring) mark[r] = 0;
    }
    std::vector<char> disputed(source.count());
    for (int s = 0; s < source.count(); ++s) disputed[s] = rivals[s].empty() ? 0 : 1;
    // Per sample its part of S in conflict, none if that is too small, and per part its mean doubt.
    std::vector<int> part(source.count(), -1);
    std::vector<double> mean;
    for (const std::vector<int>& members : connected_parts(source, disputed)) {
        if (members.size() < fewest) continue;
        double sum = 0.0;
        for (const int s : members) {
            part[s] = static_cast<int>(mean.size());
            sum += doubts[s];
        }
        mean.push_back(sum / static_cast<double>(members.size()));
    }
    std::vector<char> loses(source.count(), 0);
    for (int s = 0; s < source.count(); ++s) {
        if (part[s] < 0) continue;
        for (const int other : rivals[s]) {
            if (part[other] < 0 || part[other] == part[s]) continue;
            const double mine = mean[part[s]];
            const double theirs = mean[part[other]];
            if (mine > theirs || (mine == theirs && part[s] > part[other])) loses[s] = 1;
        }
    }
    return loses;
}

namespace {

bool compatible(const Samples& source, const PartialMap& a, const PartialMap& b, double radius) {
    constexpr double far = 3.0;  // radii on S that are no longer one place
    const Overlap overlap = overlap_of(a, b, radius);
    if (2 * overlap.agreed < overlap.shared) return false;
    std::vector<int> of_b;
    for (int r = 0; r < source.count(); ++r) {
        if (b.mapped[r]) of_b.push_back(r);
    }
    int together = 0;
    int doubled = 0;
    for (int s = 0; s < source.count(); ++s) {
        if (!a.mapped[s]) continue;
        for (const int r : of_b) {
            if ((a.position[s] - b.position[r]).squaredNorm() >= radius * radius) continue;
            ++together;
            doubled += (source.position[s] - source.position[r]).norm() > far * radius ? 1 : 0;
        }
    }
    return 4 * doubled <= together;
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
