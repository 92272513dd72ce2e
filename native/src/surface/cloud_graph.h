// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "surface/kd_tree.h"

namespace isograft {

/// Who is near whom in a cloud (paper section 4.1: k nearest neighbours, k = 8).
struct CloudGraph {
    /// Per point the points that are among its k nearest or have it among theirs, by rising index.
    std::vector<std::vector<int>> neighbours;
    /// Per point the local distance of points: the side of the square that one point has for itself.
    std::vector<double> spacing;
};

constexpr int graph_neighbours = 8;

/// O(n log n).
CloudGraph neighbour_graph(const KdTree& tree, int count, Monitor& monitor);

/// Points far from all others, as many times the spacing of those they are nearest to as `reach`, and groups of fewer
/// than `fewest` points that are that far from the rest.
std::vector<char> find_outliers(const KdTree& tree, const CloudGraph& graph, double reach, int fewest);

/// The connected parts of a graph, numbered by falling size (ties by the lowest point); edges for which
/// keep(a, b) does not hold are not walked.
template <class Keep>
std::vector<int> connected_parts(const std::vector<std::vector<int>>& neighbours, Keep&& keep);

/// Renumber labels 0, 1, ... by falling number of members; -1 stays.
void rank_by_size(std::vector<int>& label);

template <class Keep>
std::vector<int> connected_parts(const std::vector<std::vector<int>>& neighbours, Keep&& keep) {
    std::vector<int> label(neighbours.size(), -1), stack;
    int count = 0;
    for (int seed = 0; seed < static_cast<int>(neighbours.size()); ++seed) {
        if (label[seed] >= 0) continue;
        label[seed] = count;
        stack.assign(1, seed);
        while (!stack.empty()) {
            const int a = stack.back();
            stack.pop_back();
            for (const int b : neighbours[a]) {
                if (label[b] >= 0 || !keep(a, b)) continue;
                label[b] = count;
                stack.push_back(b);
            }
        }
        ++count;
    }
    rank_by_size(label);
    return label;
}

}  // namespace isograft
