// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/OrderingMethods>

#include "base/piece.h"
#include "isograft/transfer.h"
#include "transfer/sparse.h"

namespace isograft {

/// L D L^T of a sparse symmetric matrix, whose rows are ordered by approximate minimum degree (Eigen's).
///
/// As Eigen::SimplicialLDLT (Davis 2005, up-looking), but that it tells how far it is and can be stopped at every row;
/// only the ordering cannot. Matrices of surfaces: O(n^1.5) time, O(n log n) memory.
class Cholesky {
  public:
    /// \throw Cancelled
    Cholesky(const RowMatrix& matrix, Piece piece);

    /// Only if it takes at most `most` multiplications a row; else, after 0.05 of the piece, it is not usable.
    Cholesky(const RowMatrix& matrix, double most, Piece& piece);

    /// Whether it was factorised and no pivot was 0; otherwise there is no solution.
    [[nodiscard]] bool usable() const { return usable_; }

    /// \param right #rows by k. \return #rows by k. \throw Cancelled
    [[nodiscard]] CornerValues solve(const CornerValues& right, Monitor& monitor) const;

  private:
    void analyse(const RowMatrix& lower, Monitor& monitor);
    [[nodiscard]] double work() const;
    void factorise(const RowMatrix& lower, Piece& piece);

    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order_;
    // The elimination tree, and where the entries of L's columns start.
    std::vector<int> parent_;
    std::vector<std::size_t> first_;
    // Below the diagonal of L, column by column.
    std::vector<int> row_;
    std::vector<double> value_;
    std::vector<double> diagonal_;
    bool usable_ = true;
};

/// The same of a mesh's Laplacian or thin plate. \throw InvalidInput if the mesh is too degenerate for it; Cancelled.
Cholesky factorised(const RowMatrix& matrix, Piece piece);

}  // namespace isograft
