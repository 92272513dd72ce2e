// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/surface.h"
#include "isograft/transfer.h"

namespace isograft {

/// The triangles around every edge of a mesh, and which of them carry on a corner attribute there.
///
/// Half-edge 3 f + c runs from corner c of triangle f to the next one.
struct SeamGraph {
    /// 3 #F: the next half-edge around the same edge, itself if there is no other. Edges may have any number of
    /// triangles.
    std::vector<int> next;
    /// 3 #F: half-edges of one edge carry on the attribute into each other if this is equal; otherwise it is a seam.
    std::vector<int> side;
    /// #F: true if a seam is among the triangle's edges. A mere boundary is none.
    std::vector<char> has_seam;
    /// #F: connected parts without crossing seams, numbered by their first triangle.
    Eigen::VectorXi island;
};

/// #F by 3, with every vertex replaced by the first one at the same position; `faces` itself if `vertices` is empty.
/// \param monitor may be null, here and below. \throw Cancelled if it asks for it, here and below.
Triangles weld(const Points& vertices, const Triangles& faces, Monitor* monitor = nullptr);

/// \param faces #F by 3, welded. \param values 3 #F by k. O(#F log #F).
SeamGraph build_seam_graph(const Triangles& faces, const CornerValues& values, double tolerance,
                           Monitor* monitor = nullptr);

/// The corners at a vertex that are joined by edges without a seam, between triangles that belong `together`.
/// \param faces as given to build_seam_graph(). \return 3 #F: numbers from 0 by first corner. O(#F).
Eigen::VectorXi group_corners(const SeamGraph& graph, const Triangles& faces,
                              const std::function<bool(int f, int g)>& together, Monitor* monitor = nullptr);

}  // namespace isograft
