// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/correspondence.h"
#include "isograft/match.h"
#include "surface/mesh.h"

namespace isograft::matches {

/// Options for a match of two blobs in a fraction of a second, on two threads.
MatchOptions quick();

/// How far the working samples of `mesh` lie apart.
double spacing(const TriangleMesh& mesh, const MatchOptions& options);

/// Share of all source vertices matched to within `radius` of `truth`, and of those matched at all.
struct Score {
    double right = 0.0, matched = 0.0;
};
Score score(const Correspondence& c, const Points& truth, double radius);

/// Fails the test at the first value that differs; NaN equals NaN.
void expect_same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace isograft::matches
