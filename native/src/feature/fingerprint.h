// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geodesic/surface_point.h"
#include "isograft/monitor.h"

namespace isograft {

/// Geodesic fingerprints (Sun et al. 2003, paper section 4.2): the length of the isocontours of geodesic distance from
/// a point over that of the circles of the same radii in the plane.
///
/// 1 on a plane, sin(r / a) / (r / a) on a sphere of radius a. A boundary cuts contours short, as in the paper.
/// \param radii ascending and positive, in mesh units. \param points one row each.
/// \return #points by #radii, finite and >= 0; equal bit for bit for any number of threads.
/// O(#points x vertices within the largest radius).
Eigen::MatrixXd fingerprints(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points,
                             const std::vector<double>& radii, int threads, Monitor& monitor, double from, double to);

/// `count` radii from `least` to `most`, evenly spaced.
std::vector<double> even_radii(double least, double most, int count);

/// Geodesic diameter of a mesh's largest component: the longest of a few sweeps from one farthest vertex to the next,
/// a lower bound that is met on most shapes.
double geodesic_diameter(const TriangleMesh& mesh, Monitor& monitor);

}  // namespace isograft
