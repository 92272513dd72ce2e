// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_normals.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <queue>
#include <tuple>

#include <Eigen/Eigenvalues>

namespace isograft {

namespace {

constexpr int fitted_points = 12;
constexpr int refitted_points = 24;
// Points of a part at which the winding number of the rest is asked for.
constexpr int asked = 300;

Eigen::Vector3d plane_normal(const std::vector<Eigen::Vector3d>& points, const std::vector<int>& chosen,
                             const std::vector<double>& weight) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        mean += weight[i] * points[chosen[i]];
        total += weight[i];
    }
    mean /= total;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Eigen::Vector3d d = points[chosen[i]] - mean;
        covariance += weight[i] * d * d.transpose();
    }
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
}

// How one side is carried along an edge: what the second normal should look like, and how little that is to be trusted.
struct Carried {
    Eigen::Vector3d normal;
    double doubt;
};

Carried carried(const Eigen::Vector3d& a, const Eigen::Vector3d& normal_a, const Eigen::Vector3d& b,
                const Eigen::Vector3d& normal_b) {
    const Eigen::Vector3d edge = (b - a).normalized();
    const double steep = std::max(std::abs(edge.dot(normal_a)), std::abs(edge.dot(normal_b)));
    const Eigen::Vector3d mirrored = normal_a - 2.0 * edge.dot(normal_a) * edge;
    return {mirrored, 1.0 - std::abs(mirrored.dot(normal_b)) + steep * steep};
}

void spread_side(const std::vector<Eigen::Vector3d>& points, const CloudGraph& graph,
                 std::vector<Eigen::Vector3d>& normal, Monitor& monitor) {
    struct Item {
        double doubt;
        int to, from;
        bool operator<(const Item& other) const {
            return std::tie(doubt, to, from) > std::tie(other.doubt, other.to, other.from);
        }
    };
    std::vector<char> done(points.size(), 0);
    std::priority_queue<Item> queue;
    const auto settle = [&](int a) {
        done[a] = 1;
        for (const int b : graph.neighbours[a]) {
            if (!done[b]) queue.push({carried(points[a], normal[a], points[b], normal[b]).doubt, b, a});
        }
    };
    int steps = 0;
    for (int seed = 0; seed < static_cast<int>(points.size()); ++seed) {
        if (done[seed]) continue;
        settle(seed);
        while (!queue.empty()) {
            if (++steps % 4096 == 0) monitor.check();
            const Item item = queue.top();
            queue.pop();
            if (done[item.to]) continue;
            const Carried c = carried(points[item.from], normal[item.from], points[item.to], normal[item.to]);
            if (c.normal.dot(normal[item.to]) < 0.0) normal[item.to] = -normal[item.to];
            settle(item.to);
        }
    }
}

// What the points of `members` but those around it say of the side of a point: 1/2 where they close about its inner
// side.
double winding_at(int i, const std::vector<int>& members, const std::vector<Eigen::Vector3d>& points,
                  const std::vector<Eigen::Vector3d>& normal, const CloudGraph& graph) {
    const double near = 2.0 * graph.spacing[i];
    double sum = 0.0;
    for (const int j : members) {
        const Eigen::Vector3d d = points[j] - points[i];
        const double squared = d.squaredNorm();
        if (squared < near * near) continue;
        sum += graph.spacing[j] * graph.spacing[j] * normal[j].dot(d) / (squared * std::sqrt(squared));
    }
    return sum / (4.0 * std::numbers::pi);
}

}  // namespace

std::vector<Eigen::Vector3d> fit_normals(const KdTree& tree, const CloudGraph& graph, Monitor& monitor) {
    const std::vector<Eigen::Vector3d>& points = tree.points();
    std::vector<Eigen::Vector3d> normal(points.size());
    std::vector<KdTree::Found> found;
    std::vector<int> chosen;
    std::vector<double> weight;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 1024 == 0) monitor.check();
        tree.nearest(points[i], fitted_points + 1, found);
        chosen.clear();
        weight.clear();
        const double reach = std::max(found.back().squared_distance, 4.0 * graph.spacing[i] * graph.spacing[i]);
        for (const KdTree::Found& f : found) {
            chosen.push_back(f.index);
            weight.push_back(1.0 - 0.8 * f.squared_distance / reach);
        }
        normal[i] = plane_normal(points, chosen, weight);
    }
    return normal;
}

void refit_normals(const KdTree& tree, const CloudGraph& graph, std::vector<Eigen::Vector3d>& normal,
                   Monitor& monitor) {
    const std::vector<Eigen::Vector3d>& points = tree.points();
    std::vector<Eigen::Vector3d> refitted = normal;
    std::vector<KdTree::Found> found;
    std::vector<int> chosen;
    std::vector<double> weight;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % 1024 == 0) monitor.check();
        tree.nearest(points[i], refitted_points + 1, found);
        chosen.clear();
        weight.clear();
        const double reach = 3.0 * graph.spacing[i];
        for (const KdTree::Found& f : found) {
            const double share = f.squared_distance / (reach * reach);
            const double same = normal[f.index].dot(normal[i]);
            if (share >= 1.0 || same < 0.3) continue;
            chosen.push_back(f.index);
            weight.push_back((1.0 - share) * (1.0 - share) * same);
        }
        if (chosen.size() < 5) continue;
        const Eigen::Vector3d fitted = plane_normal(points, chosen, weight);
        const double turn = fitted.dot(normal[i]);
        // A fit that stands across is one of a rim or a needle: no better.
        if (std::abs(turn) > 0.5) refitted[i] = turn < 0.0 ? Eigen::Vector3d(-fitted) : fitted;
    }
    normal = std::move(refitted);
}

CloudSides orient_normals(const KdTree& tree, const CloudGraph& graph, const std::vector<Eigen::Vector3d>& given,
                          std::vector<Eigen::Vector3d>& normal, Monitor& monitor) {
    const std::vector<Eigen::Vector3d>& points = tree.points();
    const int count = static_cast<int>(points.size());
    spread_side(points, graph, normal, monitor);
    CloudSides sides;
    sides.part = connected_parts(graph.neighbours, [](int, int) { return true; });
    const int parts = *std::max_element(sides.part.begin(), sides.part.end()) + 1;
    std::vector<std::vector<int>> members(parts);
    for (int i = 0; i < count; ++i) members[sides.part[i]].push_back(i);
    sides.doubtful.assign(count, 0);
    for (const std::vector<int>& part : members) {
        const int size = static_cast<int>(part.size());
        const int step = std::max(1, size / asked);
        std::vector<double> winding;
        std::vector<int> at;
        for (int k = step / 2; k < size; k += step) {
            monitor.check();
            at.push_back(part[k]);
            winding.push_back(winding_at(part[k], part, points, normal, graph));
        }
        double mean = 0.0;
        for (const double w : winding) mean += w / static_cast<double>(winding.size());
        double closedness = std::min(2.0 * std::abs(mean), 1.0);
        bool turn = mean < 0.0;
        if (!given.empty()) {
            int same = 0;
            for (const int i : part) same += normal[i].dot(given[i]) > 0.0;
            if (closedness < closed_enough) turn = 2 * same < size;
            sides.turned += turn ? same : size - same;
        }
        for (const int i : part) {
            if (turn) normal[i] = -normal[i];
        }
        sides.closedness.push_back(closedness);
    }
    for (int i = 0; i < count; ++i) {
        int for_it = 0, against = 0;
        for (const int j : graph.neighbours[i]) {
            const Carried c = carried(points[j], normal[j], points[i], normal[i]);
            if (c.doubt > 0.5) continue;
            (c.normal.dot(normal[i]) > 0.0 ? for_it : against)++;
        }
        // Beside a seam between two sides about three of eight neighbours lie beyond it, hardly ever most of them.
        sides.doubtful[i] = 3 * against > for_it + against;
    }
    return sides;
}

}  // namespace isograft
