// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/laplacian.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "shapes.h"

namespace isograft {

namespace {

// A plane with angles of up to 158 degrees, unevenly divided.
shapes::Shape obtuse_plane() {
    shapes::Shape plane = shapes::noisy(shapes::grid(14, 12, 0.5, 0.3, 1.5), 0.05, 3);
    plane.vertices.col(2).setZero();
    return plane;
}

// With two that lie in one line, one that is a point and one without an area but with a length.
shapes::Shape degenerate() {
    shapes::Shape shape = shapes::grid(4, 4, 1.0, 1.0);
    shape.vertices.row(6) = 0.5 * (shape.vertices.row(0) + shape.vertices.row(12));
    shape.vertices.row(17) = shape.vertices.row(18);
    shape.vertices.row(23) = shape.vertices.row(18);
    return shape;
}

}  // namespace

TEST(Laplacian, IsZeroOfLinearFunctionsOfAnObtusePlaneAwayFromItsBorder) {
    const shapes::Shape plane = obtuse_plane();
    const Eigen::MatrixXd moved = laplacian(plane.vertices, plane.faces) * plane.vertices;
    int inner = 0;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
        const Eigen::Index i = v % 15, j = v / 15;
        if (i == 0 || j == 0 || i == 14 || j == 12) continue;
        EXPECT_LE(moved.row(v).norm(), 1e-11) << v;
        ++inner;
    }
    EXPECT_EQ(inner, 13 * 11);
}

TEST(Laplacian, IsPositiveSemidefiniteAndZeroOfConstantsOnlyWhereTrianglesHaveNoAreaToo) {
    for (const shapes::Shape& shape : {obtuse_plane(), degenerate()}) {
        const Eigen::MatrixXd matrix = laplacian(shape.vertices, shape.faces);
        ASSERT_TRUE(matrix.allFinite());
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix).eigenvalues();
        EXPECT_GE(values[0], -1e-10 * values.maxCoeff());
        EXPECT_GE(values[1], 1e-7 * values.maxCoeff());
        EXPECT_LE((matrix * Eigen::VectorXd::Ones(matrix.cols())).norm(), 1e-10 * values.maxCoeff());
    }
}

TEST(PositiveLaplacian, HasPositiveWeightsEverywhere) {
    for (const shapes::Shape& shape : {obtuse_plane(), degenerate()}) {
        const Eigen::SparseMatrix<double> matrix = positive_laplacian(shape.vertices, shape.faces);
        for (Eigen::Index v = 0; v < matrix.cols(); ++v) {
            for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, v); it; ++it) {
                EXPECT_TRUE(it.row() == v ? it.value() > 0.0 : it.value() < 0.0);
            }
        }
    }
}

}  // namespace isograft
