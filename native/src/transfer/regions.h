// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// A mesh cut into pieces of about one size, for what varies slowly over it.
struct Regions {
    /// \param radius no vertex is farther from the middle of its piece, along the edges. O(#F log #F).
    Regions(const Points& vertices, const Triangles& faces, double radius, Monitor& monitor);

    [[nodiscard]] int count() const { return static_cast<int>(centre.rows()); }

    /// #V: the piece of every vertex, -1 of those in no triangle.
    Eigen::VectorXi of;
    /// By piece: mean of its vertices.
    Points centre;
    /// By piece: thirds of the triangles around its vertices.
    Eigen::VectorXd area;
    /// Between pieces, positive semidefinite: length of the common border, as seen along the way between the centres,
    /// over their distance (finite volumes), so that (area + t stiffness)^-1 area is one step of heat flow over time t.
    Eigen::SparseMatrix<double> stiffness;
};

}  // namespace isograft
