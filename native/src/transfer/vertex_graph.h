// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// The edges of a mesh, and ways along them.
class VertexGraph {
  public:
    /// \param vertices must outlive the graph. O(#F).
    VertexGraph(const Points& vertices, const Triangles& faces);

    /// The source with the shortest way to every vertex: of equally near ones the lowest, -1 where none leads.
    /// O(#F log #F); the monitor is told of `part` of the whole, bit by bit.
    [[nodiscard]] Eigen::VectorXi nearest(const std::vector<int>& sources, Monitor& monitor, double part) const;

    /// Vertices of triangles, ascending: none within `radius` of another along the edges, and no other vertex of a
    /// triangle farther than that from one. O(#F log #F) if edges are shorter than `radius`.
    [[nodiscard]] std::vector<int> spread_out(double radius, Monitor& monitor) const;

  private:
    template <class Visit>
    void each(int v, const Visit& visit) const {
        for (std::size_t i = first_[v]; i < first_[v + 1]; ++i) visit(neighbour_[i]);
    }
    [[nodiscard]] double length(int v, int w) const { return (vertices_.row(v) - vertices_.row(w)).norm(); }

    const Points& vertices_;
    std::vector<std::size_t> first_;
    // An edge of two triangles twice.
    std::vector<int> neighbour_;
};

}  // namespace isograft
