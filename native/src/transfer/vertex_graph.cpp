// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/vertex_graph.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

namespace isograft {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Vertices settled between two looks at the monitor.
constexpr int vertices_a_look = 4096;

// The shortest way comes out first; of equal ones that of the lowest source, then vertex.
using Entry = std::pair<double, std::pair<int, int>>;

class Heap {
  public:
    [[nodiscard]] bool empty() const { return entries_.empty(); }
    void push(const Entry& entry) {
        entries_.push_back(entry);
        std::push_heap(entries_.begin(), entries_.end(), std::greater<>());
    }
    Entry pop() {
        std::pop_heap(entries_.begin(), entries_.end(), std::greater<>());
        const Entry entry = entries_.back();
        entries_.pop_back();
        return entry;
    }

  private:
    std::vector<Entry> entries_;
};

}  // namespace

VertexGraph::VertexGraph(const Points& vertices, const Triangles& faces)
    : vertices_(vertices), first_(vertices.rows() + 1, 0) {
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) first_[faces(f, c) + 1] += 2;
    }
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) first_[v + 1] += first_[v];
    neighbour_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) {
            neighbour_[next[faces(f, c)]++] = faces(f, (c + 1) % 3);
            neighbour_[next[faces(f, c)]++] = faces(f, (c + 2) % 3);
        }
    }
}

Eigen::VectorXi VertexGraph::nearest(const std::vector<int>& sources, Monitor& monitor, double part) const {
    const Eigen::Index count = vertices_.rows();
    Eigen::VectorXi source = Eigen::VectorXi::Constant(count, -1);
    std::vector<double> reached(count, infinity);
    Heap heap;
    for (const int v : sources) {
        reached[v] = 0.0;
        source[v] = v;
        heap.push({0.0, {v, v}});
    }
    const double step = count > 0 ? part * vertices_a_look / static_cast<double>(count) : 0.0;
    double told = 0.0;
    int settled = 0;
    while (!heap.empty()) {
        const auto [done, from] = heap.pop();
        const auto [origin, v] = from;
        if (done > reached[v] || source[v] != origin) continue;
        if (++settled % vertices_a_look == 0 && told + step <= part) {
            monitor.add(step);
            told += step;
        }
        each(v, [&, origin = origin, v = v, done = done](int w) {
            const double longer = done + length(v, w);
            if (longer > reached[w] || (longer == reached[w] && source[w] <= origin)) return;
            reached[w] = longer;
            source[w] = origin;
            heap.push({longer, {origin, w}});
        });
    }
    monitor.add(part - told);
    return source;
}

std::vector<int> VertexGraph::spread_out(double radius, Monitor& monitor) const {
    std::vector<int> chosen;
    std::vector<double> nearest(vertices_.rows(), infinity);
    Heap heap;
    for (int v = 0; v < vertices_.rows(); ++v) {
        if (nearest[v] <= radius || first_[v] == first_[v + 1]) continue;
        monitor.check();
        chosen.push_back(v);
        nearest[v] = 0.0;
        heap.push({0.0, {v, v}});
        while (!heap.empty()) {
            const auto [done, from] = heap.pop();
            const int at = from.second;
            if (done > nearest[at]) continue;
            each(at, [&, done = done](int w) {
                const double longer = done + length(at, w);
                if (longer > radius || longer >= nearest[w]) return;
                nearest[w] = longer;
                heap.push({longer, {v, w}});
            });
        }
    }
    return chosen;
}

}  // namespace isograft
