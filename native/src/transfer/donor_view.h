// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/transfer.h"
#include "transfer/seams.h"

namespace isograft {

/// The donor as transfers read it.
struct DonorView {
    DonorView(const DonorMesh& donor, const CornerValues& values, double tolerance);

    [[nodiscard]] Eigen::Vector3d corner(int f, int c) const { return vertices.row(faces(f, c)).transpose(); }
    [[nodiscard]] Eigen::Vector3d point(int f, const Eigen::Vector3d& weights) const {
        return weights[0] * corner(f, 0) + weights[1] * corner(f, 1) + weights[2] * corner(f, 2);
    }
    /// Weights of the point of triangle `f` that is nearest to `p`.
    [[nodiscard]] Eigen::Vector3d closest(int f, const Eigen::Vector3d& p) const;
    /// The attribute at `weights` of triangle `f`.
    [[nodiscard]] Eigen::RowVectorXd value(int f, const Eigen::Vector3d& weights) const;

    const Points& vertices;
    const Triangles& faces;
    const CornerValues& values;
    double tolerance;
    SeamGraph graph;
    /// #F by 3: unit normals, of one winding within every part joined by edges of two triangles; 0 without an area.
    Points normal;
    /// #F.
    Eigen::VectorXd longest_edge;
    /// Of all triangles.
    double area = 0.0;
    /// Points nearer than this are one.
    double same_point;
};

/// The image of a receiver's vertex on the donor.
struct Image {
    int face = -1;
    Eigen::Vector3d weights;
    Eigen::Vector3d point;
};

/// Where a corner is read.
struct Place {
    int face = -1;
    Eigen::Vector3d weights;
};

/// The images of all receiver vertices; `face` -1 where unmatched. Weights are made >= 0 with sum 1.
std::vector<Image> images_of(const Correspondence& correspondence, const DonorView& donor);

/// Corner values of no column: what a donor is viewed with where seams do not matter.
inline CornerValues no_corner_values(const Triangles& faces) { return {3 * faces.rows(), 0}; }

}  // namespace isograft
