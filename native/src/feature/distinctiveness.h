// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/mesh.h"

namespace isograft {

/// F of section 4.2: per row the sum of the L1 distances to all other rows.
///
/// L1 is a sum over dimensions, so each is sorted once: exact in O(rows log rows x columns).
Eigen::VectorXd distinctiveness(const Eigen::MatrixXd& descriptors);

/// Vertices whose value none of their neighbours exceeds; of equal neighbours the one with the lowest index.
std::vector<int> local_maxima(const TriangleMesh& mesh, const Eigen::VectorXd& values);

}  // namespace isograft
