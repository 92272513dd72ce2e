// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "surface/cloud_graph.h"
#include "surface/kd_tree.h"

namespace isograft {

/// How well the sides of a cloud are known.
struct CloudSides {
    /// Per point the connected part it is in, 0 the largest.
    std::vector<int> part;
    /// Per part how closed it is about its inside: 1 for a closed surface, 0 for a flat sheet.
    std::vector<double> closedness;
    /// Points whose side contradicts more than a third of their neighbours or, in a closed part, the rest of the
    /// surface.
    std::vector<char> doubtful;
    /// Given normals only: points whose given side was turned over.
    int turned = 0;
};

/// A part at least this closed has an outer side.
constexpr double closed_enough = 0.55;

/// Unit normals of planes fitted to the nearest points; either side.
std::vector<Eigen::Vector3d> fit_normals(const KdTree& tree, const CloudGraph& graph, Monitor& monitor);

/// Fit again to those of the nearest points that look the same way, so that close sheets are kept apart.
/// \param normal oriented. Points with too few such neighbours keep theirs.
void refit_normals(const KdTree& tree, const CloudGraph& graph, std::vector<Eigen::Vector3d>& normal, Monitor& monitor);

/// Turn normals to one side in every connected part, outward where the part closes about an inside.
///
/// The side is carried along a minimum spanning tree over the neighbour graph. An edge across a thin sheet or a gap
/// between two sheets (steep to both normals) carries it mirrored, and is used last (Hoppe et al. 1992; Xie et al. 2003
/// for the mirroring). Outward is told by the winding number that the rest of the part gives at its own points:
/// 1/2 on a closed surface seen from inside, 0 on a plane.
/// \param given the caller's normals, or nothing: where a part is not closed, the side of most of them is kept.
CloudSides orient_normals(const KdTree& tree, const CloudGraph& graph, const std::vector<Eigen::Vector3d>& given,
                          std::vector<Eigen::Vector3d>& normal, Monitor& monitor);

}  // namespace isograft
