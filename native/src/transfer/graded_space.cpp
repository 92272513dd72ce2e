// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/graded_space.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "transfer/pace.h"

namespace isograft {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Edges from what is known within which every vertex is free.
constexpr int free_rings = 6;
// Distance of nodes over that from what is known, and the radius of their weights over the distance of nodes.
constexpr double spacing = 0.5;
constexpr double reach = 2.0;
// Nodes in all large holes together, so far as what is known does not ask for more: of so many vertices so many. They
// grow with the power at which factorising their matrix, O(nodes^1.65) as measured, stays linear in the vertices.
constexpr double usual_vertices = 40000.0;
constexpr double usual_nodes = 600.0;
constexpr double growth = 0.6;
// Nodes of distance 1 on an area of 1.
constexpr double density = 0.75;
// A node with fewer vertices than this in its reach would have about as many parameters as they.
constexpr std::size_t fewest = 4 * GradedSpace::most;
// Jacobi steps of the positions.
constexpr int relaxations = 40;
constexpr double relaxation = 0.6;

template <class Visit>
void each_neighbour(const RowMatrix& edges, int v, const Visit& visit) {
    for (RowMatrix::InnerIterator it(edges, v); it; ++it) {
        if (it.col() != v) visit(static_cast<int>(it.col()));
    }
}

// How far every unknown vertex is from what is known, along the edges.
struct Depth {
    // Lengths.
    std::vector<double> distance;
    // Numbers of edges.
    std::vector<int> rings;
};

Depth depth_of(const Points& vertices, const RowMatrix& laplacian, const Unknowns& unknowns, const RowMatrix& edges,
               Monitor& monitor) {
    const auto count = static_cast<int>(unknowns.count());
    Depth depth{std::vector<double>(count, infinity), std::vector<int>(count, 0)};
    const auto length = [&](int v, int w) { return (vertices.row(v) - vertices.row(w)).norm(); };
    std::vector<std::pair<double, int>> heap;
    std::vector<int> front;
    for (int i = 0; i < count; ++i) {
        const int v = unknowns.vertex[i];
        each_neighbour(laplacian, v, [&](int w) {
            if (unknowns.slot[w] < 0) depth.distance[i] = std::min(depth.distance[i], length(v, w));
        });
        if (depth.distance[i] == infinity) continue;
        heap.emplace_back(depth.distance[i], i);
        front.push_back(i);
        depth.rings[i] = 1;
    }
    for (std::size_t at = 0; at < front.size(); ++at) {
        each_neighbour(edges, front[at], [&](int other) {
            if (depth.rings[other] > 0) return;
            depth.rings[other] = depth.rings[front[at]] + 1;
            front.push_back(other);
        });
    }
    std::make_heap(heap.begin(), heap.end(), std::greater<>());
    for (int settled = 0; !heap.empty(); ++settled) {
        if (settled % rows_a_check == 0) monitor.check();
        std::pop_heap(heap.begin(), heap.end(), std::greater<>());
        const auto [done, i] = heap.back();
        heap.pop_back();
        if (done > depth.distance[i]) continue;
        each_neighbour(edges, i, [&, done = done, i = i](int other) {
            const double longer = done + length(unknowns.vertex[i], unknowns.vertex[other]);
            if (longer >= depth.distance[other]) return;
            depth.distance[other] = longer;
            heap.emplace_back(longer, other);
            std::push_heap(heap.begin(), heap.end(), std::greater<>());
        });
    }
    return depth;
}

// Twice differentiable, 1 to 0 (Wendland 1995).
double bump(double share) {
    const double rest = 1.0 - share;
    return rest * rest * rest * rest * (4.0 * share + 1.0);
}

}  // namespace

GradedSpace::GradedSpace(const Points& vertices, const Eigen::VectorXd& areas, const RowMatrix& laplacian,
                         const Unknowns& unknowns, const std::vector<Eigen::Index>& hole_sizes, Eigen::Index few,
                         Piece piece) {
    const RowMatrix edges(unknowns.block(Eigen::SparseMatrix<double>(laplacian)));
    piece.reach(0.1);
    const Depth depth = depth_of(vertices, laplacian, unknowns, edges, piece.monitor());
    piece.reach(0.3);
    // Beside what is known, and in small holes.
    std::vector<char> is_free(hole_sizes.size());
    for (std::size_t i = 0; i < is_free.size(); ++i) {
        is_free[i] = hole_sizes[i] <= few || depth.rings[i] <= free_rings ? 1 : 0;
    }
    double area = 0.0, bound = 0.0;
    for (std::size_t i = 0; i < is_free.size(); ++i) {
        if (is_free[i] != 0) continue;
        area += areas[unknowns.vertex[i]];
        bound += 1.0;
    }
    const double node_count = usual_nodes * std::pow(bound / usual_vertices, growth);
    std::vector<double> apart(is_free.size());
    const double widest = node_count > 0.0 ? std::sqrt(area / (density * node_count)) : 0.0;
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] = std::min(widest, spacing * depth.distance[i]);
    relax(vertices, laplacian, unknowns, piece.monitor());
    piece.reach(0.6);
    place_nodes(edges, apart, is_free, piece.until(1.0));
    free_.assign(is_free.size(), -1);
    first_.assign(1, 0);
    for (std::size_t i = 0; i < is_free.size(); ++i) {
        if (is_free[i] == 0) continue;
        free_[i] = free_count_++;
        first_.push_back(free_count_);
    }
    for (std::size_t node = 0; node < nodes_.size(); ++node) first_.push_back(first_.back() + most);
}

void GradedSpace::relax(const Points& vertices, const RowMatrix& laplacian, const Unknowns& unknowns,
                        Monitor& monitor) {
    Points at = vertices;
    relaxed_.resize(unknowns.count(), 3);
    for (int step = 0; step < relaxations; ++step) {
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
            if (i % rows_a_check == 0) monitor.check();
            const int v = unknowns.vertex[i];
            Eigen::RowVector3d pull = Eigen::RowVector3d::Zero();
            double diagonal = 0.0;
            for (RowMatrix::InnerIterator it(laplacian, v); it; ++it) {
                pull += it.value() * at.row(it.col());
                if (it.col() == v) diagonal = it.value();
            }
            relaxed_.row(i) = at.row(v);
            if (diagonal > 0.0) relaxed_.row(i) -= relaxation / diagonal * pull;
        }
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) at.row(unknowns.vertex[i]) = relaxed_.row(i);
    }
}

void GradedSpace::place_nodes(const RowMatrix& edges, const std::vector<double>& apart, std::vector<char>& is_free,
                              Piece piece) {
    const std::size_t count = is_free.size();
    // Those farthest from what is known first: wide nodes leave no gaps that narrow ones would have to fill.
    std::vector<int> order;
    for (std::size_t i = 0; i < count; ++i) {
        if (is_free[i] == 0) order.push_back(static_cast<int>(i));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return apart[a] > apart[b]; });
    struct Reached {
        int vertex;
        int node;
        double weight;
    };
    std::vector<Reached> all;
    std::vector<char> is_near(is_free);
    std::vector<int> seen_from(count, -1), ball;
    std::vector<double> away;
    for (std::size_t at = 0; at < order.size(); ++at) {
        const int start = order[at];
        if (is_near[start] != 0) continue;
        piece.reach(0.8 * static_cast<double>(at) / static_cast<double>(order.size()));
        const Vector3d centre = relaxed_.row(start);
        const double radius = reach * apart[start];
        // What hangs together within the radius.
        ball.assign(1, start);
        away.assign(1, 0.0);
        seen_from[start] = start;
        for (std::size_t k = 0; k < ball.size(); ++k) {
            each_neighbour(edges, ball[k], [&](int other) {
                if (seen_from[other] == start || is_free[other] == 1) return;
                const double far = (relaxed_.row(other).transpose() - centre).norm();
                if (!(far < radius)) return;
                seen_from[other] = start;
                ball.push_back(other);
                away.push_back(far);
            });
        }
        const bool is_worth = ball.size() >= fewest;
        Matrix3d spread = Matrix3d::Zero();
        for (std::size_t k = 0; k < ball.size(); ++k) {
            const Vector3d offset = relaxed_.row(ball[k]).transpose() - centre;
            spread += offset * offset.transpose();
            if (is_worth) all.push_back({ball[k], static_cast<int>(nodes_.size()), bump(away[k] / radius)});
            // 2: free, but the balls of others go on across it.
            if (away[k] > apart[start]) continue;
            if (!is_worth && is_near[ball[k]] == 0) is_free[ball[k]] = 2;
            is_near[ball[k]] = 1;
        }
        if (!is_worth) continue;
        const Matrix3d axes = Eigen::SelfAdjointEigenSolver<Matrix3d>(spread).eigenvectors();
        nodes_.push_back({centre, axes.col(2) / apart[start], axes.col(1) / apart[start]});
    }
    begin_.assign(count + 1, 0);
    std::vector<double> sum(count, 0.0);
    for (const Reached& one : all) {
        if (is_free[one.vertex] != 0) continue;
        ++begin_[one.vertex + 1];
        sum[one.vertex] += one.weight;
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    near_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const Reached& one : all) {
        if (is_free[one.vertex] == 0) near_[next[one.vertex]++] = {one.node, one.weight / sum[one.vertex]};
    }
    piece.reach(1.0);
}

CornerValues GradedSpace::spread(const CornerValues& parameters) const {
    CornerValues values = CornerValues::Zero(static_cast<Eigen::Index>(free_.size()), parameters.cols());
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
        each(i, [&](int group, const Parameters& shares) {
            for (int k = 0; k < first_[group + 1] - first_[group]; ++k) {
                values.row(i) += shares[k] * parameters.row(first_[group] + k);
            }
        });
    }
    return values;
}

CornerValues GradedSpace::gather(const CornerValues& values) const {
    CornerValues parameters = CornerValues::Zero(first_.back(), values.cols());
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
        each(i, [&](int group, const Parameters& shares) {
            for (int k = 0; k < first_[group + 1] - first_[group]; ++k) {
                parameters.row(first_[group] + k) += shares[k] * values.row(i);
            }
        });
    }
    return parameters;
}

}  // namespace isograft
