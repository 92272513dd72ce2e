// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geodesic/surface_point.h"

namespace isograft {

/// The point of a triangle nearest to a point in space.
SurfacePoint closest_in_face(const TriangleMesh& mesh, int face, const Eigen::Vector3d& x);

/// The nearest surface point that a walk downhill in distance finds from the triangles around vertex `start`.
///
/// Unlike a search in space it stays on the sheet it starts on.
SurfacePoint closest_from(const TriangleMesh& mesh, int start, const Eigen::Vector3d& x);

}  // namespace isograft
