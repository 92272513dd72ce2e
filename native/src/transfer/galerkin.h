// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/piece.h"
#include "transfer/graded_space.h"
#include "transfer/large_solver.h"
#include "transfer/sparse.h"

namespace isograft {

/// An energy within a space: P^T A P, its diagonal raised by a tiny share, as the parameters of nodes hardly differ
/// from some of their neighbours'.
///
/// \return #parameters by #parameters, the lower triangle. O(#rows), if each touches few groups. \throw Cancelled
RowMatrix energy_within(const GradedSpace& space, const SquaredRows& energy, Piece piece);

}  // namespace isograft
