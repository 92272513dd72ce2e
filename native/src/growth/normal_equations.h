// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "base/complex.h"

namespace isograft {

/// The normal equations H x = -g of least squares over points of two unknowns each, whose residuals join two points.
///
/// H is kept as 2 by 2 blocks, a row of them per point: no symbolic analysis, no factor, one pass over memory per
/// product. O(points + pairs).
class NormalEquations {
  public:
    /// \param pairs the two points of every residual, different from each other; several may join the same two.
    NormalEquations(int points, const std::vector<std::array<int, 2>>& pairs);

    void clear();
    /// Add weight (r + u . x_first + v . x_second)^2 / 2 for the residual r of pair `index`.
    void add_pair(int index, double weight, double residual, Complex u, Complex v);
    /// Add g . x + x . h x / 2 for one point.
    void add_point(int point, const Eigen::Vector2d& g, const Eigen::Matrix2d& h);

    [[nodiscard]] const Eigen::VectorXd& gradient() const { return gradient_; }

    /// Solve (H + diag(H) / radius) x = -g by conjugate gradients, preconditioned by the blocks on the diagonal, down
    /// to `tolerance` of the first residual or 500 steps. Good for radii up to 1e4 or so. The same bits every time.
    [[nodiscard]] Eigen::VectorXd solve(double radius, double tolerance) const;

    /// What the quadratic model says the cost falls by: -g . x - x . H x / 2.
    [[nodiscard]] double predicted_fall(const Eigen::VectorXd& x) const;

  private:
    // Row major: xx, xy, yx, yy.
    using Block = std::array<double, 4>;

    void multiply(const std::vector<Block>& diagonal, const Eigen::VectorXd& x, Eigen::VectorXd& result) const;

    int count_;
    std::vector<std::array<int, 2>> pair_;
    std::vector<Block> diagonal_;
    // Blocks beside the diagonal, row by row in compressed form.
    std::vector<int> row_begin_, column_;
    std::vector<Block> beside_;
    // Per pair where its block is in the row of its first point, and in that of its second.
    std::vector<std::array<int, 2>> slot_;
    Eigen::VectorXd gradient_;
};

}  // namespace isograft
