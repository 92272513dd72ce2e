// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// Points of a surface: triangles (-1 = none) and weights of their corners.
struct SurfacePoints {
    Eigen::VectorXi face;
    Points weights;
};

/// The donor's surface point for any points of the receiver's triangles, not for its vertices alone: as bake() finds
/// that of a texel.
///
/// \param points triangles of the receiver and weights >= 0 with sum 1. \param threads 0 takes all cores; the result
/// does not depend on it. \param monitor may be null. \return one row per point; -1 and zeros where the triangle is
/// unmatched or torn (see place_corners()) or was -1 already. O(#F + #points).
/// \throw InvalidInput on sizes, indices or weights that do not fit; Cancelled.
SurfacePoints locate(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                     const SurfacePoints& points, int threads = 0, Monitor* monitor = nullptr);

}  // namespace isograft
