// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/normal_equations.h"

#include <algorithm>
#include <cmath>

namespace isograft {

namespace {
constexpr int most_steps = 500;
}

NormalEquations::NormalEquations(int points, const std::vector<std::array<int, 2>>& pairs)
    : count_(points), pair_(pairs), diagonal_(points), row_begin_(points + 1, 0), gradient_(2 * points) {
    // Neighbours of every point, sorted and each once, so that the order of sums depends on the graph alone.
    std::vector<int> begin(points + 1, 0);
    for (const auto& [a, b] : pairs) {
        ++begin[a + 1];
        ++begin[b + 1];
    }
    for (int p = 0; p < points; ++p) begin[p + 1] += begin[p];
    std::vector<int> next(begin.begin(), begin.end() - 1), neighbour(2 * pairs.size());
    for (const auto& [a, b] : pairs) {
        neighbour[next[a]++] = b;
        neighbour[next[b]++] = a;
    }
    column_.reserve(neighbour.size());
    for (int p = 0; p < points; ++p) {
        const auto first = neighbour.begin() + begin[p], last = neighbour.begin() + begin[p + 1];
        std::sort(first, last);
        column_.insert(column_.end(), first, std::unique(first, last));
        row_begin_[p + 1] = static_cast<int>(column_.size());
    }
    beside_.resize(column_.size());
    const auto find = [&](int row, int column) {
        const auto first = column_.begin() + row_begin_[row], last = column_.begin() + row_begin_[row + 1];
        return static_cast<int>(std::lower_bound(first, last, column) - column_.begin());
    };
    slot_.reserve(pairs.size());
    for (const auto& [a, b] : pairs) slot_.push_back({find(a, b), find(b, a)});
    clear();
}

void NormalEquations::clear() {
    std::fill(diagonal_.begin(), diagonal_.end(), Block{});
    std::fill(beside_.begin(), beside_.end(), Block{});
    gradient_.setZero();
}

void NormalEquations::add_pair(int index, double weight, double residual, Complex u, Complex v) {
    const auto add = [](Block& block, double w, Complex a, Complex b) {
        block[0] += w * a.real() * b.real();
        block[1] += w * a.real() * b.imag();
        block[2] += w * a.imag() * b.real();
        block[3] += w * a.imag() * b.imag();
    };
    const auto [a, b] = pair_[index];
    add(diagonal_[a], weight, u, u);
    add(diagonal_[b], weight, v, v);
    add(beside_[slot_[index][0]], weight, u, v);
    add(beside_[slot_[index][1]], weight, v, u);
    const double pull = weight * residual;
    gradient_[2 * a] += pull * u.real();
    gradient_[2 * a + 1] += pull * u.imag();
    gradient_[2 * b] += pull * v.real();
    gradient_[2 * b + 1] += pull * v.imag();
}

void NormalEquations::add_point(int point, const Eigen::Vector2d& g, const Eigen::Matrix2d& h) {
    gradient_.segment<2>(2 * point) += g;
    Block& block = diagonal_[point];
    block[0] += h(0, 0);
    block[1] += h(0, 1);
    block[2] += h(1, 0);
    block[3] += h(1, 1);
}

void NormalEquations::multiply(const std::vector<Block>& diagonal, const Eigen::VectorXd& x,
                               Eigen::VectorXd& result) const {
    const double* in = x.data();
    for (int p = 0; p < count_; ++p) {
        const Block& d = diagonal[p];
        double sx = d[0] * in[2 * p] + d[1] * in[2 * p + 1];
        double sy = d[2] * in[2 * p] + d[3] * in[2 * p + 1];
        for (int i = row_begin_[p]; i < row_begin_[p + 1]; ++i) {
            const Block& b = beside_[i];
            const double qx = in[2 * column_[i]], qy = in[2 * column_[i] + 1];
            sx += b[0] * qx + b[1] * qy;
            sy += b[2] * qx + b[3] * qy;
        }
        result[2 * p] = sx;
        result[2 * p + 1] = sy;
    }
}

Eigen::VectorXd NormalEquations::solve(double radius, double tolerance) const {
    // A point without any residual stays where it is.
    constexpr double tiny = 1e-12;
    std::vector<Block> diagonal = diagonal_;
    std::vector<Block> inverse(count_);
    for (int p = 0; p < count_; ++p) {
        Block& d = diagonal[p];
        d[0] += std::max(d[0] / radius, tiny);
        d[3] += std::max(d[3] / radius, tiny);
        const double determinant = d[0] * d[3] - d[1] * d[2];
        inverse[p] = {d[3] / determinant, -d[1] / determinant, -d[2] / determinant, d[0] / determinant};
    }
    const auto precondition = [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) {
        for (int p = 0; p < count_; ++p) {
            const Block& m = inverse[p];
            z[2 * p] = m[0] * r[2 * p] + m[1] * r[2 * p + 1];
            z[2 * p + 1] = m[2] * r[2 * p] + m[3] * r[2 * p + 1];
        }
    };
    Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * count_);
    Eigen::VectorXd r = -gradient_, z(2 * count_), product(2 * count_);
    precondition(r, z);
    Eigen::VectorXd direction = z;
    double descent = r.dot(z);
    const double enough = tolerance * tolerance * descent;
    for (int step = 0; step < most_steps && descent > enough && descent > 0.0; ++step) {
        multiply(diagonal, direction, product);
        const double bend = direction.dot(product);
        if (!(bend > 0.0)) break;
        const double length = descent / bend;
        x += length * direction;
        r -= length * product;
        precondition(r, z);
        const double next = r.dot(z);
        direction = z + (next / descent) * direction;
        descent = next;
    }
    return x;
}

double NormalEquations::predicted_fall(const Eigen::VectorXd& x) const {
    Eigen::VectorXd product(2 * count_);
    multiply(diagonal_, x, product);
    return -gradient_.dot(x) - 0.5 * x.dot(product);
}

}  // namespace isograft
