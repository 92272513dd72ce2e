// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "base/piece.h"
#include "isograft/transfer.h"
#include "transfer/laplacian.h"

namespace isograft {

/// Holes of more vertices are solved nearly, in almost linear time, unless the exact way is near linear itself.
constexpr Eigen::Index large_hole = 50000;
/// Multiplications an unknown that count as linear time: half as much again as solving nearly takes. It is what a flat
/// sheet of 110,000 vertices needs, or a body of 300,000.
constexpr double linear_bending = 60000.0;

/// The values at the unknown vertices with which a thin plate is bent least: their bi-Laplacian is 0.
///
/// Exactly, by one Cholesky factorisation; with a hole of more than `large` vertices only if that takes at most `most`
/// multiplications an unknown, else nearly, by a LargeSolver.
/// \param laplacian laplacian() of `vertices` and `faces`. \param values #V by k, finite where known.
/// \return #unknowns by k. \throw InvalidInput if the mesh is too degenerate; Cancelled.
CornerValues thin_plate(const Points& vertices, const Triangles& faces, const Eigen::SparseMatrix<double>& laplacian,
                        const Unknowns& unknowns, const CornerValues& values, Eigen::Index large, Piece piece,
                        double most = linear_bending);

}  // namespace isograft
