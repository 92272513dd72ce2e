// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace isograft {

/// The rotation R for which the sum of |R p - q|^2 is least (Kabsch 1976). \param product the sum of p q^T.
Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& product);

}  // namespace isograft
