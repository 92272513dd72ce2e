// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/piece.h"
#include "isograft/surface.h"
#include "surface/mesh.h"

namespace isograft {

/// A point cloud as the stages see it.
struct Cloud {
    /// Even triangles over the cloud's smoothed surface, in the caller's units.
    TriangleMesh mesh;
    /// Per input point its nearest vertex of `mesh` on its own sheet, -1 for points left out as no part of the surface.
    std::vector<int> vertex;
    /// Per input point the unit normal of the smoothed surface, outward; NaN for points left out.
    Points normals;
    /// A part is open, so that its outer side is not known.
    bool ambiguous = false;
    std::vector<std::string> warnings;
};

/// From points to the surface through them.
///
/// Clouds above 60,000 points are averaged in cells; the graph of 8 nearest neighbours shows
/// outliers and parts; normals are fitted where none are given, and oriented; all points are put onto the robust
/// implicit surface; evenly spread ones are joined by their local Delaunay triangles. Holes larger than twice the
/// points' distance stay holes. O(n log n).
/// \param normals as for check_cloud(). \throw as check_cloud(); InvalidInput if the points show no surface; Cancelled.
Cloud make_cloud(const Points& vertices, const Points& normals, Piece progress);

}  // namespace isograft
