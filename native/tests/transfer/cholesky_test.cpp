// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/cholesky.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/SparseCholesky>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer/laplacian.h"

namespace isograft {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

// The Laplacian of a body, or its bi-Laplacian, of all vertices above a plane.
Matrix half_of(const shapes::Shape& shape, bool is_square) {
    const Matrix first = laplacian(shape.vertices, shape.faces);
    const Unknowns unknowns(shape.faces, shape.vertices.col(2).array() < 0.0);
    return unknowns.block(is_square ? Matrix(first * first) : first);
}

CornerValues some_values(Eigen::Index rows, Eigen::Index columns) {
    CornerValues values(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i) {
        for (Eigen::Index k = 0; k < columns; ++k) values(i, k) = std::sin(static_cast<double>(7 * i + 3 * k));
    }
    return values;
}

}  // namespace

TEST(Cholesky, AgreesWithThatOfEigen) {
    const shapes::Shape shape = shapes::blob(4);
    for (const bool is_square : {false, true}) {
        const Matrix matrix = half_of(shape, is_square);
        const CornerValues right = some_values(matrix.rows(), 3);
        Monitor monitor;
        const Cholesky factor(RowMatrix(matrix), monitor);
        ASSERT_TRUE(factor.usable());
        const Eigen::SimplicialLDLT<Matrix> other(matrix);
        const Eigen::MatrixXd expected = other.solve(Eigen::MatrixXd(right));
        const CornerValues found = factor.solve(right, monitor);
        EXPECT_LE((found - expected).norm(), 1e-10 * expected.norm());
        EXPECT_LE((matrix * found - right).norm(), 1e-10 * right.norm());
    }
}

TEST(Cholesky, SolvesPartsThatHangTogetherNowhere) {
    Eigen::MatrixXd dense = Eigen::VectorXd::LinSpaced(5, 2.0, 6.0).asDiagonal();
    dense(0, 4) = dense(4, 0) = 1.0;
    const Matrix matrix = dense.sparseView();
    Monitor monitor;
    const CornerValues right = some_values(5, 2);
    const CornerValues found = Cholesky(RowMatrix(matrix), monitor).solve(right, monitor);
    EXPECT_LE((matrix * found - right).norm(), 1e-14);
}

TEST(Cholesky, SaysWhenThereIsNoSolution) {
    Monitor monitor;
    EXPECT_FALSE(Cholesky(RowMatrix(3, 3), monitor).usable());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Ones(2, 2);
    EXPECT_FALSE(Cholesky(RowMatrix(dense.sparseView()), monitor).usable());
    dense(1, 1) = 2.0;
    EXPECT_TRUE(Cholesky(RowMatrix(dense.sparseView()), monitor).usable());
}

TEST(Cholesky, TellsHowFarItIsAndStops) {
    const RowMatrix matrix(half_of(shapes::blob(4), true));
    Monitor silent;
    Cholesky(matrix, Piece(silent, 0.5));
    EXPECT_NEAR(silent.fraction(), 0.5, 1e-9);
    silent.cancel();
    EXPECT_THROW(Cholesky(matrix, silent), Cancelled);
    Monitor late;
    const Cholesky factor(matrix, late);
    late.cancel();
    EXPECT_THROW((void)factor.solve(some_values(matrix.rows(), 1), late), Cancelled);
}

TEST(Multiply, AgreesWithThatOfEigenAndStops) {
    const RowMatrix a(half_of(shapes::blob(3), true));
    const RowMatrix b(a.leftCols(40));
    Monitor monitor;
    const RowMatrix found = multiply(a, b, monitor);
    const RowMatrix expected = a * b;
    EXPECT_EQ(found.nonZeros(), expected.nonZeros());
    EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
    monitor.cancel();
    EXPECT_THROW(multiply(a, b, monitor), Cancelled);
}

}  // namespace isograft
