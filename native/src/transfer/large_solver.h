// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "base/piece.h"
#include "isograft/transfer.h"
#include "transfer/cholesky.h"
#include "transfer/graded_space.h"
#include "transfer/laplacian.h"
#include "transfer/sparse.h"

namespace isograft {

/// An energy of the unknowns: x^T A x with A = rows^T diag(weights) rows.
struct SquaredRows {
    /// #rows by #unknowns.
    RowMatrix rows;
    /// #rows, positive.
    Eigen::VectorXd weights;
    /// A itself where it has fewer entries than there are steps through the rows, else empty.
    RowMatrix product;
};

/// The thin plate: the square of laplacian() over vertex_areas(), of all vertices that see an unknown one. O(#V).
SquaredRows bending_rows(const Eigen::SparseMatrix<double>& laplacian, const Eigen::VectorXd& areas,
                         const Unknowns& unknowns);

/// The Laplacian itself: every edge of an unknown vertex. O(#V).
/// \param laplacian positive_laplacian().
SquaredRows stretching_rows(const Eigen::SparseMatrix<double>& laplacian, const Unknowns& unknowns);

/// Nearly solves A x = b of an elliptic energy such as the thin plate's in almost linear time.
///
/// By conjugate gradients that are preconditioned by a graded space, within which the energy is brought down exactly,
/// and Chebyshev polynomials before and after it.
class LargeSolver {
  public:
    /// \param energy and \param space must outlive this. \param degree of the polynomials. \throw Cancelled
    LargeSolver(const SquaredRows& energy, const GradedSpace& space, int degree, Piece piece);

    /// Whether the factorisation went well; otherwise there is no solution.
    [[nodiscard]] bool usable() const { return factor_->usable(); }

    /// What comes nearest to the solution within the space. \param right #unknowns by k. \return likewise.
    /// \throw Cancelled
    [[nodiscard]] CornerValues within_space(const CornerValues& right, Monitor& monitor) const;

    /// Bring `start` nearer to the solution. \param right #unknowns by k. \param steps conjugate gradients.
    /// \param start #unknowns by k. \return #unknowns by k; columns do not touch each other. \throw Cancelled
    [[nodiscard]] CornerValues improve(const CornerValues& right, CornerValues start, int steps, Piece piece) const;

  private:
    [[nodiscard]] CornerValues apply(const CornerValues& x, Monitor& monitor) const;
    [[nodiscard]] CornerValues smooth(const CornerValues& right, Monitor& monitor) const;
    [[nodiscard]] CornerValues precondition(const CornerValues& right, Monitor& monitor) const;

    const SquaredRows& energy_;
    const GradedSpace& space_;
    int degree_;
    // #unknowns: 1 over a diagonal that is above A.
    Eigen::VectorXd scale_;
    std::optional<Cholesky> factor_;
};

}  // namespace isograft
