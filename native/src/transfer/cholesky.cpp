// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/cholesky.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isograft/errors.h"
#include "transfer/pace.h"

namespace isograft {

Cholesky::Cholesky(const RowMatrix& matrix, Piece piece)
    : Cholesky(matrix, std::numeric_limits<double>::infinity(), piece) {}

Cholesky::Cholesky(const RowMatrix& matrix, double most, Piece& piece) {
    piece.check();
    const Eigen::SparseMatrix<double> full(matrix);
    Eigen::AMDOrdering<int>()(full, order_);
    piece.reach(0.05);
    Eigen::SparseMatrix<double> sorted(matrix.rows(), matrix.rows());
    sorted.selfadjointView<Eigen::Lower>() = full.selfadjointView<Eigen::Lower>().twistedBy(order_.inverse().eval());
    // Rows of the lower triangle.
    const RowMatrix lower(sorted);
    analyse(lower, piece.monitor());
    usable_ = work() <= most * static_cast<double>(matrix.rows());
    if (usable_) factorise(lower, piece);
}

void Cholesky::analyse(const RowMatrix& lower, Monitor& monitor) {
    const auto count = static_cast<int>(lower.rows());
    parent_.assign(count, -1);
    std::vector<std::size_t> entries(count, 0);
    std::vector<int> seen_in(count, -1);
    for (int k = 0; k < count; ++k) {
        if (k % rows_a_check == 0) monitor.check();
        seen_in[k] = k;
        for (RowMatrix::InnerIterator it(lower, k); it; ++it) {
            // Every column on the way to the root has an entry in row k.
            for (auto column = static_cast<int>(it.col()); seen_in[column] != k; column = parent_[column]) {
                if (parent_[column] < 0) parent_[column] = k;
                ++entries[column];
                seen_in[column] = k;
            }
        }
    }
    first_.assign(count + 1, 0);
    for (int k = 0; k < count; ++k) first_[k + 1] = first_[k] + entries[k];
}

// Multiplications, nearly.
double Cholesky::work() const {
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < first_.size(); ++k) {
        const auto length = static_cast<double>(first_[k + 1] - first_[k]);
        sum += length * length;
    }
    return sum;
}

void Cholesky::factorise(const RowMatrix& lower, Piece& piece) {
    const auto count = static_cast<int>(lower.rows());
    diagonal_.assign(count, 0.0);
    row_.resize(first_[count]);
    value_.resize(first_[count]);
    const double work = this->work();
    double done = 0.0;
    std::vector<std::size_t> end(first_.begin(), first_.end() - 1);
    std::vector<double> line(count, 0.0);
    std::vector<int> seen_in(count, -1), pattern(count), path(count);
    for (int k = 0; k < count; ++k) {
        // Columns with an entry in row k, children before parents: paths of the tree, put in from the back.
        int top = count;
        seen_in[k] = k;
        for (RowMatrix::InnerIterator it(lower, k); it; ++it) {
            auto column = static_cast<int>(it.col());
            line[column] += it.value();
            int length = 0;
            for (; seen_in[column] != k; column = parent_[column]) {
                path[length++] = column;
                seen_in[column] = k;
            }
            while (length > 0) pattern[--top] = path[--length];
        }
        double pivot = line[k];
        line[k] = 0.0;
        for (; top < count; ++top) {
            const int column = pattern[top];
            const double value = line[column];
            line[column] = 0.0;
            for (std::size_t at = first_[column]; at < end[column]; ++at) line[row_[at]] -= value_[at] * value;
            const double entry = value / diagonal_[column];
            pivot -= entry * value;
            row_[end[column]] = k;
            value_[end[column]++] = entry;
            done += static_cast<double>(end[column] - first_[column]);
        }
        if (pivot == 0.0 || !std::isfinite(pivot)) {
            usable_ = false;
            return;
        }
        diagonal_[k] = pivot;
        piece.reach(work > 0.0 ? std::min(1.0, 0.05 + 0.95 * 2.0 * done / work) : 1.0);
    }
}

CornerValues Cholesky::solve(const CornerValues& right, Monitor& monitor) const {
    CornerValues x = order_.inverse() * right;
    const auto count = static_cast<int>(x.rows());
    for (int k = 0; k < count; ++k) {
        if (k % rows_a_check == 0) monitor.check();
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) x.row(row_[at]) -= value_[at] * x.row(k);
    }
    for (int k = count - 1; k >= 0; --k) {
        if (k % rows_a_check == 0) monitor.check();
        x.row(k) /= diagonal_[k];
        for (std::size_t at = first_[k]; at < first_[k + 1]; ++at) x.row(k) -= value_[at] * x.row(row_[at]);
    }
    return order_ * x;
}

Cholesky factorised(const RowMatrix& matrix, Piece piece) {
    Cholesky factor(matrix, piece);
    if (!factor.usable()) throw InvalidInput("the mesh is too degenerate to fill: remove zero-area faces");
    return factor;
}

}  // namespace isograft
