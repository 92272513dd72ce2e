// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/linkage.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace isograft {

namespace {

std::vector<int> nearest_of(const Eigen::MatrixXd& distance, int row, int neighbours) {
    std::vector<int> others;
    for (int j = 0; j < static_cast<int>(distance.cols()); ++j) {
        if (j != row && std::isfinite(distance(row, j))) others.push_back(j);
    }
    std::stable_sort(others.begin(), others.end(), [&](int a, int b) { return distance(row, a) < distance(row, b); });
    if (static_cast<int>(others.size()) > neighbours) others.resize(neighbours);
    return others;
}

double intra_affinity(const Eigen::MatrixXd& weight, const std::vector<int>& members) {
    double sum = 0.0;
    for (const int i : members) {
        double in = 0.0, out = 0.0;
        for (const int j : members) {
            in += weight(j, i);
            out += weight(i, j);
        }
        sum += in * out;
    }
    return sum / static_cast<double>(members.size());
}

}  // namespace

Eigen::MatrixXd neighbour_weights(const Eigen::MatrixXd& distance, int neighbours) {
    const Eigen::Index n = distance.rows();
    std::vector<std::vector<int>> nearest(n);
    double sum = 0.0;
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
        nearest[i] = nearest_of(distance, static_cast<int>(i), neighbours);
        for (const int j : nearest[i]) sum += distance(i, j) * distance(i, j);
        count += static_cast<Eigen::Index>(nearest[i].size());
    }
    const double variance = count > 0 ? sum / static_cast<double>(count) : 0.0;
    Eigen::MatrixXd weight = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        for (const int j : nearest[i]) {
            const double squared = distance(i, j) * distance(i, j);
            weight(i, j) = variance > 0.0 ? std::exp(-squared / variance) : 1.0;
        }
    }
    return weight;
}

double affinity(const Eigen::MatrixXd& weight, const std::vector<int>& a, const std::vector<int>& b) {
    // Both terms, each as a sum over the members of one cluster of what they give to and get from the other.
    const auto exchanged = [&](const std::vector<int>& from, const std::vector<int>& to) {
        double sum = 0.0;
        for (const int i : from) {
            double in = 0.0, out = 0.0;
            for (const int j : to) {
                in += weight(j, i);
                out += weight(i, j);
            }
            sum += in * out;
        }
        const auto size = static_cast<double>(to.size());
        return sum / (size * size);
    };
    return exchanged(b, a) + exchanged(a, b);
}

Clusters graph_degree_linkage(const Eigen::MatrixXd& distance, const LinkageOptions& options) {
    const auto n = static_cast<int>(distance.rows());
    const Eigen::MatrixXd weight = neighbour_weights(distance, options.neighbours);
    std::vector<std::vector<int>> members(n);
    for (int i = 0; i < n; ++i) members[i] = {i};
    Eigen::MatrixXd between = Eigen::MatrixXd::Zero(n, n);
    for (int i = 0; i < n; ++i) {
        for (int j = i + 1; j < n; ++j) between(i, j) = affinity(weight, members[i], members[j]);
    }
    std::vector<char> alive(n, 1);
    for (;;) {
        double most = std::max(options.threshold, least_affinity);
        int a = -1, b = -1;
        for (int i = 0; i < n; ++i) {
            if (!alive[i]) continue;
            for (int j = i + 1; j < n; ++j) {
                if (!alive[j] || between(i, j) <= most) continue;
                most = between(i, j);
                a = i;
                b = j;
            }
        }
        if (a < 0) break;
        members[a].insert(members[a].end(), members[b].begin(), members[b].end());
        std::sort(members[a].begin(), members[a].end());
        alive[b] = 0;
        for (int i = 0; i < n; ++i) {
            if (alive[i] && i != a) between(std::min(i, a), std::max(i, a)) = affinity(weight, members[i], members[a]);
        }
    }
    std::vector<std::pair<double, int>> order;
    for (int i = 0; i < n; ++i) {
        if (alive[i]) order.emplace_back(intra_affinity(weight, members[i]), i);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.first > y.first; });
    Clusters clusters;
    for (const auto& [value, i] : order) {
        clusters.members.push_back(members[i]);
        clusters.affinity.push_back(value);
    }
    return clusters;
}

std::vector<int> by_affinity_and_area(const Clusters& clusters, const std::vector<double>& area) {
    std::vector<int> order(area.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return std::make_pair(clusters.affinity[a] * area[a], area[a]) >
               std::make_pair(clusters.affinity[b] * area[b], area[b]);
    });
    return order;
}

}  // namespace isograft
