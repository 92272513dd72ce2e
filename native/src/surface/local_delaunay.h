// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "surface/edges.h"
#include "surface/kd_tree.h"

namespace isograft {

/// Points of a surface with unit normals, oriented, about evenly spread.
struct SurfaceSites {
    std::vector<Eigen::Vector3d> position, normal;
    /// Local distance of the points.
    std::vector<double> spacing;
};

/// A triangle that some of its corners see in the Delaunay triangulation of their surroundings.
struct SeenTriangle {
    /// Counter-clockwise seen from outside, the lowest first.
    Corners corner;
    /// How many of the three corners see it.
    int votes = 0;
    /// Largest circumradius that one of them sees, and the circumcentre in space there.
    double radius = 0.0;
    Eigen::Vector3d centre;
};

/// The Delaunay triangles around every site, each in its own tangent plane, with their votes.
///
/// A site sees those of its neighbours that can be reached from it in steps along the surface: neither across the
/// gap between close sheets nor round a rim. \param reach radius of the surroundings. \param largest circumradius
/// beyond which there is a hole; both in local spacings. Sorted by corners. O(n).
std::vector<SeenTriangle> local_delaunay(const SurfaceSites& sites, const KdTree& tree, double reach, double largest,
                                         Monitor& monitor);

}  // namespace isograft
