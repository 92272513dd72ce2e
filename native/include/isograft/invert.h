// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "isograft/correspondence.h"
#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// The map the other way round: for every vertex of the target its point on the source.
///
/// A target vertex lies under the images of source triangles (three matched corners, not torn apart by the map: see
/// place_corners()). It takes the point nearest to it on the nearest of those that face its way; so the inverse of a
/// map is its inverse up to how flat triangles approximate a bent surface, and exact where vertices lie on vertices.
/// Where the image ends before a vertex, it is unmatched. O(#F(source) x target triangles under one of them).
/// \param correspondence source to target; `confidence`, `stretch` and `region` may be empty (then 1, 0 and 0).
/// \param source the surface the map starts from, `polygons` unused. \param target the surface it leads to.
/// \param threads 0 takes all cores; the result does not depend on it. \param monitor may be null.
/// \return one row per target vertex. Confidence: the least of the source triangle's corners; stretch: their weighted
/// mean; region: that of the corner with the largest weight.
/// \throw InvalidInput on sizes or indices that do not fit, or matches without a triangle (point clouds); Cancelled.
Correspondence invert(const Correspondence& correspondence, const ReceiverMesh& source, const DonorMesh& target,
                      int threads = 0, Monitor* monitor = nullptr);

}  // namespace isograft
