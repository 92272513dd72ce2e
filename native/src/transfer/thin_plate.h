// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "base/piece.h"
#include "isograft/transfer.h"
#include "transfer/laplacian.h"

namespace isograft {

/// Holes of more vertices are solved nearly, in almost linear time: about where that becomes the faster way.
constexpr Eigen::Index large_hole = 50000;

/// The values at the unknown vertices with which a thin plate is bent least: their bi-Laplacian is 0.
///
/// With a hole of more than `large` vertices nearly, by a LargeSolver; else exactly, by one Cholesky factorisation.
/// \param laplacian laplacian() of `vertices` and `faces`. \param values #V by k, finite where known.
/// \return #unknowns by k. \throw InvalidInput if the mesh is too degenerate; Cancelled.
CornerValues thin_plate(const Points& vertices, const Triangles& faces, const Eigen::SparseMatrix<double>& laplacian,
                        const Unknowns& unknowns, const CornerValues& values, Eigen::Index large, Piece piece);

}  // namespace isograft
