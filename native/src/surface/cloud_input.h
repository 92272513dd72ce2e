// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/surface.h"

namespace isograft {

/// The points of a cloud on their way through the gate, a row of the input each.
struct CloudInput {
    std::vector<Eigen::Vector3d> position;
    /// Of unit length; empty if none were given.
    std::vector<Eigen::Vector3d> normal;
};

/// Fewest points that make a surface.
constexpr int fewest_points = 50;

/// \param normals #V by 3, or without rows if there are none.
/// \throw InvalidInput if there are fewer than 50 points, points repeat others, a coordinate is not finite, the extent
/// is beyond what can be computed with or has no area (all on a line), or if the normals are not one per point, not
/// finite, or without length. \throw ResourceLimit above 2^30 points.
CloudInput check_cloud(const Points& vertices, const Points& normals, Monitor& monitor);

}  // namespace isograft
