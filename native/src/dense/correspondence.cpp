// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/correspondence.h"

#include <limits>
#include <string>

#include "isograft/errors.h"

namespace isograft {

Eigen::MatrixXd Correspondence::interpolate(const Eigen::MatrixXd& values, const Triangles& faces) const {
    Eigen::MatrixXd result =
        Eigen::MatrixXd::Constant(face.size(), values.cols(), std::numeric_limits<double>::quiet_NaN());
    const bool of_cloud = corners.rows() > 0;
    for (Eigen::Index i = 0; i < face.size(); ++i) {
        const int f = face[i];
        if (of_cloud ? corners(i, 0) < 0 : f < 0) continue;
        if (f >= faces.rows() && !of_cloud) {
            throw InvalidInput("row " + std::to_string(i) + " is matched to triangle " + std::to_string(f) +
                               ", but `faces` has " + std::to_string(faces.rows()) +
                               " rows; pass the triangles of the target that was matched");
        }
        const Eigen::RowVector3i corner = of_cloud ? corners.row(i) : faces.row(f);
        const int highest = corner.maxCoeff();
        if (highest >= values.rows() || corner.minCoeff() < 0) {
            throw InvalidInput("`values` has " + std::to_string(values.rows()) + " rows, but row " + std::to_string(i) +
                               " is matched to vertex " + std::to_string(highest) +
                               "; pass one row for every vertex of the target");
        }
        result.row(i).setZero();
        for (int k = 0; k < 3; ++k) {
            // A corner without weight must not spread its NaN.
            if (barycentric(i, k) != 0.0) result.row(i) += barycentric(i, k) * values.row(corner[k]);
        }
    }
    return result;
}

}  // namespace isograft
