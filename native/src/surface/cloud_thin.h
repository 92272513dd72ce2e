// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"

namespace isograft {

/// Replace points by the means of those in each cell of a grid so fine that at most `most` remain. Cells are halved
/// by side where normals are given, so that close sheets stay apart. O(n log n).
void average_in_cells(std::vector<Eigen::Vector3d>& position, std::vector<Eigen::Vector3d>& normal, int most);

/// A maximal subset of points of which no two on the same sheet are nearer than `distance` local spacings, and none
/// nearer than `least`. Picked from the outermost inwards, so that numbering and placing do not matter.
std::vector<int> pick_evenly(const std::vector<Eigen::Vector3d>& position, const std::vector<Eigen::Vector3d>& normal,
                             const std::vector<double>& spacing, double distance, double least, Monitor& monitor);

}  // namespace isograft
