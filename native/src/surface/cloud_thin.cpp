// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_thin.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "surface/kd_tree.h"

namespace isograft {

namespace {

using Cell = std::array<int, 3>;

std::vector<Cell> cells_of(const std::vector<Eigen::Vector3d>& position, const Eigen::Vector3d& low, double side) {
    std::vector<Cell> cells(position.size());
    for (std::size_t i = 0; i < position.size(); ++i) {
        for (int k = 0; k < 3; ++k) cells[i][k] = static_cast<int>((position[i][k] - low[k]) / side);
    }
    return cells;
}

int count_cells(std::vector<Cell> cells) {
    std::sort(cells.begin(), cells.end());
    return static_cast<int>(std::unique(cells.begin(), cells.end()) - cells.begin());
}

}  // namespace

void average_in_cells(std::vector<Eigen::Vector3d>& position, std::vector<Eigen::Vector3d>& normal, int most) {
    Eigen::Vector3d low = position.front(), high = low;
    for (const Eigen::Vector3d& x : position) {
        low = low.cwiseMin(x);
        high = high.cwiseMax(x);
    }
    const double extent = (high - low).maxCoeff();
    // Cells of a surface grow with the square of their number along an axis.
    double fine = extent / 4096.0, coarse = extent / 8.0;
    while (coarse > 1.02 * fine) {
        const double side = std::sqrt(fine * coarse);
        (count_cells(cells_of(position, low, side)) > most ? fine : coarse) = side;
    }
    const std::vector<Cell> cells = cells_of(position, low, coarse);
    std::vector<int> order(position.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return cells[a] != cells[b] ? cells[a] < cells[b] : a < b; });
    std::vector<Eigen::Vector3d> means, normals;
    for (std::size_t i = 0; i < order.size();) {
        std::size_t end = i;
        while (end < order.size() && cells[order[end]] == cells[order[i]]) ++end;
        for (const bool front : {true, false}) {
            Eigen::Vector3d sum = Eigen::Vector3d::Zero(), side = Eigen::Vector3d::Zero();
            int count = 0;
            for (std::size_t k = i; k < end; ++k) {
                if (!normal.empty() && (normal[order[k]].dot(normal[order[i]]) > 0.0) != front) continue;
                if (normal.empty() && !front) continue;
                sum += position[order[k]];
                if (!normal.empty()) side += normal[order[k]];
                ++count;
            }
            if (count == 0) continue;
            means.emplace_back(sum / count);
            if (!normal.empty()) normals.push_back(side.normalized());
        }
        i = end;
    }
    position = std::move(means);
    if (!normal.empty()) normal = std::move(normals);
}

std::vector<int> pick_evenly(const std::vector<Eigen::Vector3d>& position, const std::vector<Eigen::Vector3d>& normal,
                             const std::vector<double>& spacing, double distance, double least, Monitor& monitor) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& x : position) centre += x / static_cast<double>(position.size());
    std::vector<double> out(position.size());
    for (std::size_t i = 0; i < position.size(); ++i) out[i] = (position[i] - centre).squaredNorm();
    std::vector<int> order(position.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](int a, int b) { return out[a] != out[b] ? out[a] > out[b] : a < b; });
    const KdTree tree(position);
    std::vector<KdTree::Found> found;
    std::vector<char> covered(position.size(), 0);
    std::vector<int> picked;
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (k % 1024 == 0) monitor.check();
        const int i = order[k];
        if (covered[i]) continue;
        picked.push_back(i);
        tree.within(position[i], std::max(distance * spacing[i], least), found);
        for (const KdTree::Found& f : found) {
            if (normal[f.index].dot(normal[i]) > 0.0) covered[f.index] = 1;
        }
    }
    return picked;
}

}  // namespace isograft
