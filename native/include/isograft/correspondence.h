// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/surface.h"

namespace isograft {

/// For every source vertex a point of the target, or "unmatched". n = number of the source's input vertices.
///
/// Unmatched rows: face, vertex and region -1, confidence 0, NaN in every other floating-point array.
struct Correspondence {
    /// n: index into the target's input triangles; -1 everywhere for a point cloud, which has none.
    Eigen::VectorXi face;
    /// n by 3: weights of that triangle's corners in the input's corner order, >= 0, sum 1; of a point cloud those of
    /// `corners`.
    Points barycentric;
    /// Of a point cloud, n by 3: the target's input points that `barycentric` weighs, the nearest to the image on its
    /// sheet; -1 where unmatched. Of a mesh without rows: they are the corners of `face`.
    Triangles corners{0, 3};
    /// n by 3: the point itself, in the target's units.
    Points points;
    /// n: the target's input vertex with the largest weight; of a point cloud the nearest point.
    Eigen::VectorXi vertex;
    /// n: in [0, 1].
    Eigen::VectorXd confidence;
    /// n: mean of |d_T / (sigma d_S) - 1| to the mapped neighbours, without dimension.
    Eigen::VectorXd stretch;
    /// n: index of the continuous part the vertex belongs to, 0 the largest.
    Eigen::VectorXi region;

    /// Number of matched vertices.
    [[nodiscard]] Eigen::Index matched() const { return (vertex.array() >= 0).count(); }

    /// Move values from the target's vertices to the source's.
    /// \param values #V(target) by k. \param faces the target's input triangles; without rows for a point cloud.
    /// \return n by k; NaN where unmatched. \throw InvalidInput if `values` has too few rows.
    [[nodiscard]] Eigen::MatrixXd interpolate(const Eigen::MatrixXd& values, const Triangles& faces) const;
};

}  // namespace isograft
