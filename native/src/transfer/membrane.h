// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "base/piece.h"
#include "isograft/transfer.h"
#include "transfer/cholesky.h"
#include "transfer/graded_space.h"
#include "transfer/laplacian.h"
#include "transfer/large_solver.h"

namespace isograft {

/// Multiplications an unknown that count as linear time: up to about there, factorising and 50 solutions take less than
/// 50 near ones. A sheet of 189,000 vertices needs 11,000, one of 632,000 24,000.
constexpr double linear_stretching = 30000.0;

/// The Laplacian of the unknown vertices, to be solved again and again with right-hand sides that change little.
///
/// Exactly, by one Cholesky factorisation; with a hole of more than `large` vertices only if that takes at most `most`
/// multiplications an unknown, else nearly, by a LargeSolver from where the last solution was: almost linear time.
class Membrane {
  public:
    /// \param laplacian positive_laplacian() of `vertices` and `faces`. Nothing that is given need outlive this call.
    /// \throw InvalidInput if the mesh is too degenerate; Cancelled.
    Membrane(const Points& vertices, const Triangles& faces, const Eigen::SparseMatrix<double>& laplacian,
             const Unknowns& unknowns, Eigen::Index large, Piece piece, double most = linear_stretching);

    /// \param right, before #unknowns by k, the latter a solution of nearly the same. \return #unknowns by k.
    /// \throw Cancelled
    [[nodiscard]] CornerValues solve(const CornerValues& right, const CornerValues& before, Monitor& monitor) const;

  private:
    struct Nearly {
        Nearly(const Points& vertices, const Eigen::VectorXd& areas, const Eigen::SparseMatrix<double>& laplacian,
               const Unknowns& unknowns, const std::vector<Eigen::Index>& hole_sizes, Eigen::Index large, Piece piece);

        GradedSpace space;
        SquaredRows energy;
        LargeSolver solver;
    };

    // One of the two. The solver points at its neighbours, which must not move.
    std::unique_ptr<const Nearly> nearly_;
    std::optional<Cholesky> exactly_;
};

}  // namespace isograft
