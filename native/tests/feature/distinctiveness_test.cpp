// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/distinctiveness.h"

#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "shapes.h"

namespace isograft {
namespace {

Eigen::MatrixXd some_rows(int rows, int columns) {
    Random random(7);
    Eigen::MatrixXd values(rows, columns);
    // Rounded, so that there are ties.
    for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = random.below(40) / 20.0;
    return values;
}

TEST(Distinctiveness, IsTheSumOfAllPairs) {
    const Eigen::MatrixXd rows = some_rows(150, 6);
    const Eigen::VectorXd found = distinctiveness(rows);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        const double sum = (rows.rowwise() - rows.row(i)).cwiseAbs().sum();
        EXPECT_NEAR(found[i], sum, 1e-9 * (1.0 + sum));
    }
}

TEST(Distinctiveness, DoesNotChangeWithAnOffsetAndGrowsWithTheUnit) {
    const Eigen::MatrixXd rows = some_rows(80, 3);
    const Eigen::VectorXd found = distinctiveness(rows);
    const Eigen::MatrixXd shifted = (rows.array() + 3.25).matrix();
    EXPECT_LT((distinctiveness(shifted) - found).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((distinctiveness(2.0 * rows) - 2.0 * found).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Distinctiveness, IsZeroWhereAllRowsAreEqual) {
    EXPECT_EQ(distinctiveness(Eigen::MatrixXd::Constant(9, 4, 0.3)).maxCoeff(), 0.0);
}

TEST(LocalMaxima, AreWhatNoNeighbourExceeds) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(12, 12, 1.0, 1.0));
    Eigen::VectorXd height(mesh.vertex_count());
    int first = -1, second = -1;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const Eigen::Vector3d& p = mesh.position[v];
        height[v] = std::max(5.0 - (p - Eigen::Vector3d(3.0, 3.0, 0.0)).norm(),
                             4.0 - (p - Eigen::Vector3d(9.0, 8.0, 0.0)).norm());
        if (p == Eigen::Vector3d(3.0, 3.0, 0.0)) first = v;
        if (p == Eigen::Vector3d(9.0, 8.0, 0.0)) second = v;
    }
    EXPECT_EQ(local_maxima(mesh, height), (std::vector<int>{std::min(first, second), std::max(first, second)}));
}

TEST(LocalMaxima, OfAPlateauTheLowestIndexStands) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::sphere(2));
    EXPECT_EQ(local_maxima(mesh, Eigen::VectorXd::Constant(mesh.vertex_count(), 1.0)).front(), 0);
}

}  // namespace
}  // namespace isograft
