// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include "isograft/transfer.h"

namespace isograft {

/// #V by #V, positive semidefinite: cotangent weights of the edges, of obtuse angles negative, so that linear functions
/// of a plane have the value 0 away from its border. Triangles flatter than 1/1000 of their longest edge count as no
/// flatter. Rows of vertices in no triangle are 0.
Eigen::SparseMatrix<double> laplacian(const Points& vertices, const Triangles& faces);

/// The same with the weights of each corner held between 1/1000 and 1000, for what asks for positive ones.
Eigen::SparseMatrix<double> positive_laplacian(const Points& vertices, const Triangles& faces);

/// #V: a third of the area of the triangles around; at least a tiny share of the mean.
Eigen::VectorXd vertex_areas(const Points& vertices, const Triangles& faces);

/// #V: connected parts under triangles, numbered by their first vertex.
Eigen::VectorXi parts_of(const Triangles& faces, Eigen::Index vertex_count);

/// The unknowns of a system: vertices that are not known, in triangles, in a part with a known vertex.
struct Unknowns {
    Unknowns(const Triangles& faces, const Mask& known);

    /// Vertices, ascending.
    std::vector<int> vertex;
    /// #V: place in `vertex`, -1 if none.
    std::vector<int> slot;

    [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(vertex.size()); }
    /// The rows and columns of the unknowns.
    [[nodiscard]] Eigen::SparseMatrix<double> block(const Eigen::SparseMatrix<double>& matrix) const;
    /// \param values #V by k. \return the same, 0 at the unknowns.
    [[nodiscard]] CornerValues zeroed(const CornerValues& values) const;
    [[nodiscard]] Mask mask() const;
    /// Of each unknown, how many there are in its hole: unknowns that hang together by the edges of laplacian(). O(#V).
    [[nodiscard]] std::vector<Eigen::Index> hole_sizes(const Eigen::SparseMatrix<double>& laplacian) const;
    /// The same if a hole has more than `large` vertices; else nothing.
    [[nodiscard]] std::vector<Eigen::Index> large_hole_sizes(const Eigen::SparseMatrix<double>& laplacian,
                                                             Eigen::Index large) const;
};

}  // namespace isograft
