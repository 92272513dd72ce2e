// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include <Eigen/Core>

#include "isograft/surface.h"

namespace isograft {

/// Geodesic distance from a surface point to every input vertex, by polar marching over the repaired mesh.
///
/// \param face index into the surface's input triangles. \param barycentric weights of its corners.
/// \param radius how far to go, in the surface's own units; the nearer part costs less. Within the outermost tenth a
/// distance may be up to a per cent too long.
/// \return #V, in the surface's own units; infinite where no path leads (another component, or unreferenced) and
/// beyond `radius`.
/// \throw InvalidInput if `face` is out of range or was left out by the gate, or `radius` is not positive.
Eigen::VectorXd geodesic_distances(const Surface& surface, int face, const Eigen::Vector3d& barycentric,
                                   double radius = std::numeric_limits<double>::infinity());

}  // namespace isograft
