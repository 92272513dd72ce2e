// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/seams.h"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <utility>

#include "base/sorting.h"

namespace isograft {

namespace {

// A half-edge with its ends in ascending order, so that both directions of an edge sort together.
struct EdgeKey {
    int low;
    int high;
    int half_edge;

    bool operator<(const EdgeKey& other) const {
        if (low != other.low) return low < other.low;
        if (high != other.high) return high < other.high;
        return half_edge < other.half_edge;
    }
};

std::vector<EdgeKey> sorted_edges(const Triangles& faces, Monitor& monitor) {
    std::vector<EdgeKey> edges;
    edges.reserve(3 * static_cast<std::size_t>(faces.rows()));
    for (int f = 0; f < faces.rows(); ++f) {
        if (f % often == 0) monitor.check();
        for (int c = 0; c < 3; ++c) {
            const auto [low, high] = std::minmax({faces(f, c), faces(f, (c + 1) % 3)});
            // The collapsed edge of a degenerate triangle leads nowhere.
            if (low != high) edges.push_back({low, high, 3 * f + c});
        }
    }
    sort_watched(edges.begin(), edges.end(), std::less<>(), monitor);
    return edges;
}

// The corners of a half-edge at its lower and its higher vertex.
std::pair<int, int> ends(const Triangles& faces, int half_edge) {
    const int f = half_edge / 3;
    const int from = half_edge % 3;
    const int to = (from + 1) % 3;
    return faces(f, from) < faces(f, to) ? std::pair(3 * f + from, 3 * f + to) : std::pair(3 * f + to, 3 * f + from);
}

bool agree(const CornerValues& values, double tolerance, int one, int other) {
    return values.cols() == 0 || (values.row(one) - values.row(other)).cwiseAbs().maxCoeff() <= tolerance;
}

void number_islands(SeamGraph& graph, Monitor& monitor) {
    const int count = static_cast<int>(graph.has_seam.size());
    graph.island = Eigen::VectorXi::Constant(count, -1);
    int islands = 0, seen = 0;
    std::vector<int> front;
    for (int first = 0; first < count; ++first) {
        if (graph.island[first] >= 0) continue;
        graph.island[first] = islands;
        front.assign(1, first);
        while (!front.empty()) {
            if (++seen % often == 0) monitor.check();
            const int f = front.back();
            front.pop_back();
            for (int h = 3 * f; h < 3 * f + 3; ++h) {
                for (int g = graph.next[h]; g != h; g = graph.next[g]) {
                    if (graph.side[g] != graph.side[h] || graph.island[g / 3] >= 0) continue;
                    graph.island[g / 3] = islands;
                    front.push_back(g / 3);
                }
            }
        }
        ++islands;
    }
}

}  // namespace

Triangles weld(const Points& vertices, const Triangles& faces, Monitor* monitor) {
    if (vertices.rows() == 0) return faces;
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    std::vector<int> order(vertices.rows());
    std::iota(order.begin(), order.end(), 0);
    const auto place = [&](int v) { return std::array{vertices(v, 0), vertices(v, 1), vertices(v, 2)}; };
    const auto before = [&](int a, int b) {
        const auto x = place(a);
        const auto y = place(b);
        return x != y ? x < y : a < b;
    };
    sort_watched(order.begin(), order.end(), before, watched);
    watched.check();
    std::vector<int> first(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && place(order[i]) == place(order[i - 1]);
        first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    return faces.unaryExpr([&](int v) { return first[v]; });
}

SeamGraph build_seam_graph(const Triangles& faces, const CornerValues& values, double tolerance, Monitor* monitor) {
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    SeamGraph graph;
    graph.next.resize(3 * faces.rows());
    std::iota(graph.next.begin(), graph.next.end(), 0);
    graph.side = graph.next;
    graph.has_seam.assign(faces.rows(), 0);
    const std::vector<EdgeKey> edges = sorted_edges(faces, watched);
    int seen = 0;
    for (std::size_t from = 0, to = 0; from < edges.size(); from = to) {
        if (++seen % often == 0) watched.check();
        while (to < edges.size() && edges[to].low == edges[from].low && edges[to].high == edges[from].high) ++to;
        bool seam = false;
        for (std::size_t i = from; i < to; ++i) {
            const int h = edges[i].half_edge;
            graph.next[h] = edges[i + 1 < to ? i + 1 : from].half_edge;
            const auto [low, high] = ends(faces, h);
            for (std::size_t j = from; j < i; ++j) {
                const int g = edges[j].half_edge;
                const auto [other_low, other_high] = ends(faces, g);
                if (!agree(values, tolerance, low, other_low) || !agree(values, tolerance, high, other_high)) continue;
                graph.side[h] = graph.side[g];
                break;
            }
            seam = seam || graph.side[h] != graph.side[edges[from].half_edge];
        }
        for (std::size_t i = from; seam && i < to; ++i) graph.has_seam[edges[i].half_edge / 3] = 1;
    }
    number_islands(graph, watched);
    return graph;
}

Eigen::VectorXi group_corners(const SeamGraph& graph, const Triangles& faces,
                              const std::function<bool(int f, int g)>& together, Monitor* monitor) {
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    // A forest whose roots are the lowest corners.
    std::vector<int> parent(graph.next.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    const auto join = [&](int a, int b) {
        a = root(a);
        b = root(b);
        parent[std::max(a, b)] = std::min(a, b);
    };
    for (int h = 0; h < static_cast<int>(parent.size()); ++h) {
        if (h % often == 0) watched.check();
        for (int g = graph.next[h]; g != h; g = graph.next[g]) {
            const int f = h / 3, other = g / 3;
            if (graph.side[g] != graph.side[h] || !together(f, other)) continue;
            // The two ends of the edge, in either winding.
            const int from = h % 3, to = (from + 1) % 3, there = g % 3, ahead = (there + 1) % 3;
            const bool against = faces(f, from) == faces(other, ahead);
            join(3 * f + from, 3 * other + (against ? ahead : there));
            join(3 * f + to, 3 * other + (against ? there : ahead));
        }
    }
    Eigen::VectorXi group(static_cast<Eigen::Index>(parent.size()));
    int count = 0;
    for (int i = 0; i < static_cast<int>(parent.size()); ++i) group[i] = root(i) == i ? count++ : group[root(i)];
    return group;
}

}  // namespace isograft
