// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/rotation.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace isograft {

using Eigen::Matrix3d;

Matrix3d rotation_of(const Matrix3d& product) {
    const Eigen::JacobiSVD<Matrix3d> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d flip = Matrix3d::Identity();
    if ((svd.matrixV() * svd.matrixU().transpose()).determinant() < 0.0) flip(2, 2) = -1.0;
    return svd.matrixV() * flip * svd.matrixU().transpose();
}

}  // namespace isograft
