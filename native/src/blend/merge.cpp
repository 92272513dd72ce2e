// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/merge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>

#include "geodesic/trace.h"

namespace isograft {

namespace {

struct Vote {
    const Patch* patch;
    double weight;
};

struct Place {
    SurfacePoint point;
    Complex rotation;
};

// The place with most votes around it, if it has a fair share of all of them.
bool settle(const std::vector<Vote>& votes, int sample, double radius, const TriangleMesh& target, Place& place) {
    const auto closeness = [&](const Vote& a, const Vote& b) {
        const double r = (a.patch->map.position[sample] - b.patch->map.position[sample]).norm() / radius;
        return std::exp(-r * r);
    };
    double best = -1.0;
    double total = 0.0;
    const Vote* winner = nullptr;
    for (const Vote& a : votes) {
        total += a.weight;
        double sum = 0.0;
        for (const Vote& b : votes) sum += b.weight * closeness(a, b);
        if (sum > best) {
            best = sum;
            winner = &a;
        }
    }
    if (winner == nullptr || best < 0.4 * total) return false;
    const PartialMap& centre = winner->patch->map;
    const SurfacePoint& start = centre.image[sample];
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Complex turn(0.0, 0.0);
    double sum = 0.0;
    for (const Vote& v : votes) {
        const PartialMap& map = v.patch->map;
        if ((map.position[sample] - centre.position[sample]).norm() > radius) continue;
        const double w = v.weight * closeness(*winner, v);
        mean += w * map.position[sample];
        turn += w * carry(target, map.image[sample].face, start.face, map.rotation[sample]);
        sum += w;
    }
    mean /= sum;
    place = {start, unit(turn)};
    const Complex step = flatten(target, start.face, mean - centre.position[sample]);
    if (std::abs(step) > 1e-9) {
        const Trace t = trace(target, start, step, std::abs(step));
        place.point = t.end;
        place.rotation *= t.direction * std::conj(unit(step));
    }
    return true;
}

}  // namespace

void merge_into(PartialMap& map, const Pair& pair, const PatchSettings& settings,
                const std::vector<const Patch*>& patches, const std::vector<double>& weights) {
    constexpr double no_say = 1e-5;
    std::vector<Vote> votes;
    for (int s = 0; s < pair.source.samples.count(); ++s) {
        if (map.mapped[s]) continue;
        votes.clear();
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const PartialMap& m = patches[i]->map;
            if (weights[i] < no_say || !m.mapped[s]) continue;
            const double misfit = mismatch(pair, settings.feature, s, m.image[s], m.rotation[s]);
            votes.push_back({patches[i], weights[i] * std::exp(-m.seed_distance[s] / settings.blend.decay - misfit)});
        }
        Place place;
        if (!votes.empty() && settle(votes, s, settings.blend.agreement_radius, pair.target.mesh, place)) {
            map.put(pair.target.mesh, s, place.point, place.rotation);
        }
    }
}

bool keeps_length(const Samples& source, const SampleEdge& edge, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const double on_target = (a - b).norm();
    const double on_source = (source.position[edge.u] - source.position[edge.v]).norm();
    return std::abs(on_target - on_source) <= 0.35 * edge.length + 0.2 * source.spacing;
}

std::vector<int> continuous_parts(const PartialMap& map, const Pair& pair) {
    const Samples& source = pair.source.samples;
    std::vector<int> label(source.count(), -1);
    std::vector<double> area;
    std::vector<int> stack;
    for (int seed = 0; seed < source.count(); ++seed) {
        if (!map.mapped[seed] || label[seed] >= 0) continue;
        const int part = static_cast<int>(area.size());
        area.push_back(0.0);
        stack.assign(1, seed);
        label[seed] = part;
        while (!stack.empty()) {
            const int u = stack.back();
            stack.pop_back();
            area[part] += source.area[u];
            for (const int e : source.base_edges_of[u]) {
                const int v = source.edges[e].other(u);
                if (!map.mapped[v] || label[v] >= 0) continue;
                if (!keeps_length(source, source.edges[e], map.position[u], map.position[v])) continue;
                label[v] = part;
                stack.push_back(v);
            }
        }
    }
    std::vector<int> order(area.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return area[a] > area[b]; });
    std::vector<int> rank(area.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);
    for (int& l : label) {
        if (l >= 0) l = rank[l];
    }
    return label;
}

namespace {

/// The way from the largest part to a sample over unmapped ones, and where it began.
struct Bridge {
    double length = std::numeric_limits<double>::max();
    int from = -1;
};

// Shortest bridges to every sample within `reach`; they end at the first mapped sample of another part.
std::vector<Bridge> bridges(const Samples& source, const std::vector<int>& part, double reach) {
    std::vector<Bridge> bridge(source.count());
    using Item = std::pair<double, int>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
    for (int s = 0; s < source.count(); ++s) {
        if (part[s] != 0) continue;
        bridge[s] = {0.0, s};
        queue.emplace(0.0, s);
    }
    while (!queue.empty()) {
        const auto [length, u] = queue.top();
        queue.pop();
        if (length > bridge[u].length || part[u] > 0) continue;
        for (const int e : source.base_edges_of[u]) {
            const int v = source.edges[e].other(u);
            const double through = length + source.edges[e].length;
            if (part[v] == 0 || through > reach || through >= bridge[v].length) continue;
            bridge[v] = {through, bridge[u].from};
            queue.emplace(through, v);
        }
    }
    return bridge;
}

// Per part whether most of its bridges are shorter on S than the straight line between their ends' images: no path of
// that length leads there on T.
std::vector<char> out_of_reach(const PartialMap& map, const Samples& source, const std::vector<int>& part, int count) {
    // Both in spacings.
    constexpr double widest_gap = 10.0;
    // Right limbs beyond a joint that stretched lie one to four too far off. Of 1,162 parts beside the largest one,
    // which was right, of 20 pairs, a slack of one dropped 57 % of the right samples and kept 21 % of the wrong ones;
    // this one, with the limits of drop_torn_parts(), drops 25 % and keeps 22 %.
    constexpr double slack = 3.0;
    std::vector<int> said(count, 0);
    std::vector<int> denied(count, 0);
    const std::vector<Bridge> bridge = bridges(source, part, widest_gap * source.spacing);
    for (int s = 0; s < source.count(); ++s) {
        if (part[s] <= 0 || bridge[s].from < 0) continue;
        const double apart = (map.position[s] - map.position[bridge[s].from]).norm();
        ++said[part[s]];
        denied[part[s]] += apart > 1.2 * bridge[s].length + slack * source.spacing ? 1 : 0;
    }
    std::vector<char> result(count, 0);
    for (int p = 1; p < count; ++p) result[p] = 2 * denied[p] > said[p] ? 1 : 0;
    return result;
}

// By more than a bad ring of samples, which also parts a limb from the body.
bool is_torn(const SampleEdge& e, const PartialMap& map, const Samples& source) {
    return (map.position[e.u] - map.position[e.v]).norm() >= e.length + 2.0 * source.spacing;
}

}  // namespace

int drop_torn_parts(PartialMap& map, const Pair& pair, const Anchors& anchors) {
    // Torn edges of a part, as a share of its samples: a small part has a torn edge or two, and a right limb a few.
    constexpr double most_torn = 0.2;
    constexpr double most_misfit = 0.2;
    const std::vector<int> part = continuous_parts(map, pair);
    const int count = part.empty() ? 0 : 1 + *std::max_element(part.begin(), part.end());
    if (count < 2) return 0;
    const Samples& source = pair.source.samples;
    std::vector<int> size(count, 0);
    std::vector<int> torn(count, 0);
    std::vector<double> misfit(count, 0.0);
    const std::vector<char> unreachable = out_of_reach(map, source, part, count);
    for (std::size_t s = 0; s < part.size(); ++s) {
        if (part[s] < 0) continue;
        ++size[part[s]];
        if (part[s] > 0) misfit[part[s]] += anchors.incompatibility(static_cast<int>(s), map.image[s]);
    }
    for (const SampleEdge& e : source.edges) {
        if (e.level > 0 || part[e.u] < 0 || part[e.v] < 0 || part[e.u] == part[e.v]) continue;
        if (is_torn(e, map, source)) ++torn[std::max(part[e.u], part[e.v])];
    }
    const auto was_another_limb = [&](int p) {
        return unreachable[p] || torn[p] > 1 + most_torn * size[p] || misfit[p] > most_misfit * size[p];
    };
    int dropped = 0;
    for (std::size_t s = 0; s < part.size(); ++s) {
        if (part[s] <= 0 || !was_another_limb(part[s])) continue;
        map.drop(static_cast<int>(s));
        ++dropped;
    }
    return dropped;
}

double torn_share(const PartialMap& map, const Samples& source) {
    int torn = 0;
    int count = 0;
    for (const SampleEdge& e : source.edges) {
        if (e.level > 0 || !map.mapped[e.u] || !map.mapped[e.v]) continue;
        ++count;
        torn += is_torn(e, map, source) ? 1 : 0;
    }
    return static_cast<double>(torn) / std::max(1, count);
}

}  // namespace isograft
