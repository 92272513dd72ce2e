// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "growth/partial_map.h"
#include "hierarchy/vertex_levels.h"
#include "isograft/monitor.h"

namespace isograft {

/// Geodesic distances between any two vertices of a mesh, looked up, right to within the spacing of the table's cells.
///
/// Below one spacing the way through space; beyond it the mean of the ways from either vertex to the other's centre, of
/// which one is too long by about what the other is too short; never less than the way through space.
class DistanceTable {
  public:
    /// A window from every centre, and a row of the table for each.
    DistanceTable(const TriangleMesh& mesh, double spacing, int threads, Monitor& monitor, double from, double to);

    [[nodiscard]] double operator()(int a, int b) const {
        const double straight = (mesh_.position[a] - mesh_.position[b]).norm();
        if (straight < near_) return straight;
        return std::max(straight, 0.5 * (static_cast<double>(table_(centre_[a], b)) + table_(centre_[b], a)));
    }

  private:
    const TriangleMesh& mesh_;
    double near_;
    std::vector<int> centre_;
    /// Centres by vertices.
    Eigen::MatrixXf table_;
};

/// d_Theta of eq. 9 for every two maps: the mean over U_i and U_j of the distance of the images, plus the mean over
/// what both images cover of the distance of the preimages; sums over the vertices of either surface.
///
/// A preimage of a target vertex is the source vertex whose image is nearest to it, in the triangles around it.
/// \return symmetric, in mesh units, 0 on the diagonal, infinite where two domains, or their images, do not overlap.
Eigen::MatrixXd map_dissimilarities(const VertexLevels& source, const DistanceTable& source_distance,
                                    const TriangleMesh& target, const DistanceTable& target_distance,
                                    const std::vector<PartialMap>& maps, int threads, Monitor& monitor, double from,
                                    double to);

}  // namespace isograft
