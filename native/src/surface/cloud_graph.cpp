// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isograft {

CloudGraph neighbour_graph(const KdTree& tree, int count, Monitor& monitor) {
    const std::vector<Eigen::Vector3d>& points = tree.points();
    const int n = static_cast<int>(points.size());
    CloudGraph graph;
    graph.neighbours.resize(n);
    std::vector<double> reach(n);
    std::vector<KdTree::Found> found;
    for (int i = 0; i < n; ++i) {
        if (i % 1024 == 0) monitor.check();
        tree.nearest(points[i], count + 1, found);
        for (const KdTree::Found& f : found) {
            if (f.index == i) continue;
            graph.neighbours[i].push_back(f.index);
            graph.neighbours[f.index].push_back(i);
        }
        // k points share the disk to the k-th: pi r^2 = k s^2.
        reach[i] = std::sqrt(3.14159265358979323846 * found.back().squared_distance / count);
    }
    for (auto& list : graph.neighbours) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
    // The median over the neighbours: an outlier must not think that its surroundings are as thin as itself.
    graph.spacing.resize(n);
    std::vector<double> around;
    for (int i = 0; i < n; ++i) {
        around.assign(1, reach[i]);
        for (const int j : graph.neighbours[i]) around.push_back(reach[j]);
        const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
        std::nth_element(around.begin(), middle, around.end());
        graph.spacing[i] = *middle;
    }
    return graph;
}

std::vector<char> find_outliers(const KdTree& tree, const CloudGraph& graph, double reach, int fewest) {
    const std::vector<Eigen::Vector3d>& points = tree.points();
    const auto near = [&](int a, int b) {
        return (points[a] - points[b]).norm() <= reach * std::min(graph.spacing[a], graph.spacing[b]);
    };
    const std::vector<int> part = connected_parts(graph.neighbours, near);
    std::vector<int> size(points.size(), 0);
    for (const int p : part) ++size[p];
    std::vector<char> outlier(points.size(), 0);
    // Points on the surface have many neighbours that near, stray ones few.
    for (std::size_t i = 0; i < points.size(); ++i) {
        int close = 0;
        for (const int j : graph.neighbours[i]) close += near(static_cast<int>(i), j);
        outlier[i] = size[part[i]] < fewest || close < 3;
    }
    return outlier;
}

void rank_by_size(std::vector<int>& label) {
    const int count = label.empty() ? 0 : *std::max_element(label.begin(), label.end()) + 1;
    std::vector<int> size(count, 0), order(count), rank(count);
    for (const int l : label) {
        if (l >= 0) ++size[l];
    }
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return size[a] > size[b]; });
    for (int i = 0; i < count; ++i) rank[order[i]] = i;
    for (int& l : label) {
        if (l >= 0) l = rank[l];
    }
}

}  // namespace isograft
