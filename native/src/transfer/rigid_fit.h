// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/fill.h"
#include "isograft/monitor.h"
#include "transfer/laplacian.h"
#include "transfer/membrane.h"
#include "transfer/thin_plate.h"

namespace isograft {

/// complete_rigid() behind its checks.
///
/// \param rest #V by 3, of the size that the result has. \param large holes of more vertices are solved nearly,
/// unless the exact way takes no more than `most_bending` in thin_plate() and `most_stretching` in Membrane.
/// \throw InvalidInput if the mesh is too degenerate; Cancelled.
TransferredValues fit_rigid(const Points& rest, const Triangles& faces, const Points& placed, const Unknowns& unknowns,
                            const CompletionOptions& options, Eigen::Index large, Monitor& monitor,
                            double most_bending = linear_bending, double most_stretching = linear_stretching);

}  // namespace isograft
