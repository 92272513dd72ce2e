// SPDX-License-Identifier: GPL-3.0-or-later
#include "matches.h"

#include <cmath>

#include <gtest/gtest.h>

#include "hierarchy/samples.h"

namespace isograft::matches {

MatchOptions quick() {
    MatchOptions options = preset_options("fast");
    options.hierarchy.samples = 350;
    options.hierarchy.min_samples = 300;
    options.threads = 2;
    return options;
}

double spacing(const TriangleMesh& mesh, const MatchOptions& options) {
    return sample_spacing(mesh.area, options.hierarchy.samples);
}

Score score(const Correspondence& c, const Points& truth, double radius) {
    Score result;
    const double n = static_cast<double>(c.face.size());
    for (Eigen::Index v = 0; v < c.face.size(); ++v) {
        if (c.face[v] < 0) continue;
        result.matched += 1.0 / n;
        if ((c.points.row(v) - truth.row(v)).norm() < radius) result.right += 1.0 / n;
    }
    return result;
}

void expect_same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    ASSERT_EQ(a.rows(), b.rows());
    ASSERT_EQ(a.cols(), b.cols());
    for (Eigen::Index i = 0; i < a.size(); ++i) {
        const double x = a.data()[i], y = b.data()[i];
        ASSERT_TRUE(x == y || (std::isnan(x) && std::isnan(y))) << i << ": " << x << " and " << y;
    }
}

}  // namespace isograft::matches
