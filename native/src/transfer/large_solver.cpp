// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/large_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "transfer/galerkin.h"

namespace isograft {

namespace {

// The share of the spectrum that a Chebyshev polynomial damps evenly.
constexpr double damped_from = 1.0 / 30.0;

// Column by column.
Eigen::RowVectorXd products(const CornerValues& a, const CornerValues& b) {
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(a.cols());
    for (Eigen::Index i = 0; i < a.rows(); ++i) sum += a.row(i).cwiseProduct(b.row(i));
    return sum;
}

// 0 where a column has nothing more to gain.
Eigen::RowVectorXd ratios(const Eigen::RowVectorXd& over, const Eigen::RowVectorXd& under) {
    return (under.array() > 0.0 && over.array() > 0.0).select(over.array() / under.array(), 0.0);
}

}  // namespace

SquaredRows bending_rows(const Eigen::SparseMatrix<double>& laplacian, const Eigen::VectorXd& areas,
                         const Unknowns& unknowns) {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> weights;
    for (Eigen::Index v = 0; v < laplacian.rows(); ++v) {
        const std::size_t before = entries.size();
        for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, v); it; ++it) {
            const int slot = unknowns.slot[it.row()];
            if (slot >= 0) entries.emplace_back(static_cast<int>(weights.size()), slot, it.value());
        }
        if (entries.size() > before) weights.push_back(1.0 / areas[v]);
    }
    const auto count = static_cast<Eigen::Index>(weights.size());
    SquaredRows result{
        RowMatrix(count, unknowns.count()), Eigen::Map<const Eigen::VectorXd>(weights.data(), count), {}};
    result.rows.setFromTriplets(entries.begin(), entries.end());
    return result;
}

SquaredRows stretching_rows(const Eigen::SparseMatrix<double>& laplacian, const Unknowns& unknowns) {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> weights;
    for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
        const int v = unknowns.vertex[i];
        for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, v); it; ++it) {
            const int slot = unknowns.slot[it.row()];
            // An edge of two unknown vertices is met at both.
            if (it.row() == v || (slot >= 0 && slot < i) || !(it.value() < 0.0)) continue;
            const int row = static_cast<int>(weights.size());
            entries.emplace_back(row, static_cast<int>(i), 1.0);
            if (slot >= 0) entries.emplace_back(row, slot, -1.0);
            weights.push_back(-it.value());
        }
    }
    const auto count = static_cast<Eigen::Index>(weights.size());
    SquaredRows result{RowMatrix(count, unknowns.count()), Eigen::Map<const Eigen::VectorXd>(weights.data(), count),
                       RowMatrix(unknowns.block(laplacian))};
    result.rows.setFromTriplets(entries.begin(), entries.end());
    return result;
}

LargeSolver::LargeSolver(const SquaredRows& energy, const GradedSpace& space, int degree, Piece piece)
    : energy_(energy), space_(space), degree_(degree), scale_(Eigen::VectorXd::Zero(energy.rows.cols())) {
    // (row . x)^2 <= sum |row| sum |row| x^2.
    for (Eigen::Index row = 0; row < energy.rows.rows(); ++row) {
        double sum = 0.0;
        for (RowMatrix::InnerIterator it(energy.rows, row); it; ++it) sum += std::abs(it.value());
        for (RowMatrix::InnerIterator it(energy.rows, row); it; ++it) {
            scale_[it.col()] += energy.weights[row] * sum * std::abs(it.value());
        }
    }
    scale_ = (scale_.array() > 0.0).select(scale_.array().inverse(), 0.0);
    const RowMatrix matrix = energy_within(space, energy, piece.until(0.5));
    factor_.emplace(matrix, piece.until(1.0));
}

CornerValues LargeSolver::improve(const CornerValues& right, CornerValues start, int steps, Piece piece) const {
    CornerValues x = std::move(start);
    CornerValues residual = right - apply(x, piece.monitor());
    CornerValues direction = CornerValues::Zero(x.rows(), x.cols());
    Eigen::RowVectorXd gain = Eigen::RowVectorXd::Zero(x.cols());
    for (int step = 0; step < steps; ++step) {
        piece.reach((1.0 + step) / (1.0 + steps));
        const CornerValues wanted = precondition(residual, piece.monitor());
        const Eigen::RowVectorXd now = products(residual, wanted);
        const Eigen::RowVectorXd kept = ratios(now, gain);
        gain = now;
        for (Eigen::Index i = 0; i < x.rows(); ++i) {
            direction.row(i) = wanted.row(i) + direction.row(i).cwiseProduct(kept);
        }
        const CornerValues pull = apply(direction, piece.monitor());
        const Eigen::RowVectorXd far = ratios(gain, products(direction, pull));
        for (Eigen::Index i = 0; i < x.rows(); ++i) {
            x.row(i) += direction.row(i).cwiseProduct(far);
            residual.row(i) -= pull.row(i).cwiseProduct(far);
        }
    }
    piece.reach(1.0);
    return x;
}

CornerValues LargeSolver::apply(const CornerValues& x, Monitor& monitor) const {
    monitor.check();
    CornerValues result = CornerValues::Zero(x.rows(), x.cols());
    const Eigen::Index width = x.cols();
    const auto add = [width](double* to, double factor, const double* from) {
        for (Eigen::Index k = 0; k < width; ++k) to[k] += factor * from[k];
    };
    const auto of = [&](Eigen::Index row) { return x.data() + row * width; };
    const auto into = [&](Eigen::Index row) { return result.data() + row * width; };
    if (energy_.product.rows() > 0) {
        for (Eigen::Index row = 0; row < energy_.product.rows(); ++row) {
            for (RowMatrix::InnerIterator it(energy_.product, row); it; ++it) add(into(row), it.value(), of(it.col()));
        }
        return result;
    }
    std::vector<double> sum(width);
    for (Eigen::Index row = 0; row < energy_.rows.rows(); ++row) {
        std::fill(sum.begin(), sum.end(), 0.0);
        for (RowMatrix::InnerIterator it(energy_.rows, row); it; ++it) add(sum.data(), it.value(), of(it.col()));
        for (double& one : sum) one *= energy_.weights[row];
        for (RowMatrix::InnerIterator it(energy_.rows, row); it; ++it) add(into(it.col()), it.value(), sum.data());
    }
    return result;
}

// Chebyshev's polynomial of the scaled matrix, whose eigenvalues are at most 1 (Saad 2003, algorithm 12.1).
CornerValues LargeSolver::smooth(const CornerValues& right, Monitor& monitor) const {
    const double middle = 0.5 * (1.0 + damped_from), half = 0.5 * (1.0 - damped_from);
    double rho = half / middle;
    CornerValues residual = right;
    CornerValues step = scale_.asDiagonal() * residual / middle;
    CornerValues x = step;
    for (int k = 1; k < degree_; ++k) {
        residual -= apply(step, monitor);
        const double next = 1.0 / (2.0 * middle / half - rho);
        step = next * rho * step + 2.0 * next / half * (scale_.asDiagonal() * residual);
        x += step;
        rho = next;
    }
    return x;
}

CornerValues LargeSolver::within_space(const CornerValues& right, Monitor& monitor) const {
    return space_.spread(factor_->solve(space_.gather(right), monitor));
}

CornerValues LargeSolver::precondition(const CornerValues& right, Monitor& monitor) const {
    CornerValues x = smooth(right, monitor);
    x += within_space(right - apply(x, monitor), monitor);
    return x + smooth(right - apply(x, monitor), monitor);
}

}  // namespace isograft
