// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hierarchy/coarse_mesh.h"
#include "surface/mesh.h"

namespace isograft {

/// Smoothed signed mean curvature at every vertex: positive where the surface bulges outward, one over mesh units.
///
/// Cotangent Laplacian of the position along the normal, smoothed by heat flow for `time` (square mesh units), which
/// has the same reach whatever the triangulation. Boundary vertices have no curvature of their own and get that of
/// the inside. O(#V^1.5) (one sparse factorisation).
/// \throw Cancelled if `monitor` asks for it.
std::vector<double> mean_curvature(const TriangleMesh& mesh, double time, Monitor& monitor);
std::vector<double> mean_curvature(const TriangleMesh& mesh, double time);

/// mean_curvature() at the vertices of a coarse mesh, for several times at once.
///
/// Where the fine mesh has several times as many vertices, its curvature is integrated there but flows on the coarse
/// mesh, whose edges must then be shorter than the flow reaches: linear in the fine mesh's size.
/// \param fine, coarse in the same unit. \return per time, per vertex of coarse.mesh. \throw Cancelled on request.
std::vector<std::vector<double>> coarse_curvatures(const TriangleMesh& fine, const CoarseMesh& coarse,
                                                   const std::vector<double>& times, Monitor& monitor);

}  // namespace isograft
