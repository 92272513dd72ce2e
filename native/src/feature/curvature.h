// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "surface/mesh.h"

namespace isograft {

/// Smoothed signed mean curvature at every vertex: positive where the surface bulges outward, one over mesh units.
///
/// Cotangent Laplacian of the position along the normal, smoothed by heat flow for `time` (square mesh units), which
/// has the same reach whatever the triangulation. Boundary vertices have no curvature of their own and get that of
/// the inside. O(#V^1.5) (one sparse factorisation).
std::vector<double> mean_curvature(const TriangleMesh& mesh, double time);

}  // namespace isograft
