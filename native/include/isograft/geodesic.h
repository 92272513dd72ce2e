// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/surface.h"

namespace isograft {

/// Geodesic distance from a surface point to every input vertex, by polar marching over the repaired mesh.
///
/// \param face index into the surface's input triangles. \param barycentric weights of its corners.
/// \return #V, in the surface's own units; infinite where no path leads (another component, or unreferenced).
/// \throw InvalidInput if `face` is out of range or was left out by the gate.
Eigen::VectorXd geodesic_distances(const Surface& surface, int face, const Eigen::Vector3d& barycentric);

}  // namespace isograft
