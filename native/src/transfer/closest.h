// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace isograft {

/// Weights of the point of the closed triangle abc that is nearest to `p`; >= 0, sum 1.
///
/// Zero-area triangles are read as the segments they are. A point on an edge or a corner has exact zeros.
Eigen::Vector3d closest_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c);

/// Weights of the projection of `p` to the plane of abc; sum 1, negative outside. abc must have an area.
Eigen::Vector3d plane_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c);

/// Parameter in [0, 1] of the point of the segment ab that is nearest to `p`; 0 if a = b.
double closest_parameter(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace isograft
