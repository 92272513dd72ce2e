// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/thin_plate.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "transfer/cholesky.h"
#include "transfer/graded_space.h"
#include "transfer/large_solver.h"
#include "transfer/sparse.h"

namespace isograft {

namespace {

constexpr int degree = 5;
constexpr int conjugate_gradients = 6;
// The exact way is not tried for more unknowns: ordering them could not be stopped for half a second and longer.
constexpr Eigen::Index most_to_order = 500000;
// So that many columns take no more memory than a few.
constexpr Eigen::Index columns_at_once = 8;

CornerValues of_unknowns(const Eigen::MatrixXd& values, const Unknowns& unknowns) {
    CornerValues rows(unknowns.count(), values.cols());
    for (Eigen::Index i = 0; i < unknowns.count(); ++i) rows.row(i) = values.row(unknowns.vertex[i]);
    return rows;
}

RowMatrix bending(const Eigen::SparseMatrix<double>& laplacian, const Eigen::VectorXd& areas, const Unknowns& unknowns,
                  Monitor& monitor) {
    const RowMatrix rows(laplacian);
    const RowMatrix even = areas.cwiseInverse().asDiagonal() * rows;
    const Eigen::SparseMatrix<double> energy(multiply(rows, even, monitor));
    return {unknowns.block(energy)};
}

// None if a matrix is too degenerate.
std::optional<CornerValues> solve_nearly(const Points& vertices, const Eigen::SparseMatrix<double>& laplacian,
                                         const Eigen::VectorXd& areas, const Unknowns& unknowns,
                                         const std::vector<Eigen::Index>& hole_sizes, const CornerValues& right,
                                         Eigen::Index large, Piece piece) {
    const GradedSpace space(vertices, areas, RowMatrix(laplacian), unknowns, hole_sizes, large, piece.until(0.2));
    const SquaredRows energy = bending_rows(laplacian, areas, unknowns);
    const LargeSolver solver(energy, space, degree, piece.until(0.6));
    if (!solver.usable()) return std::nullopt;
    CornerValues solved(right.rows(), right.cols());
    for (Eigen::Index begin = 0; begin < right.cols(); begin += columns_at_once) {
        const Eigen::Index width = std::min(columns_at_once, right.cols() - begin);
        const double share = static_cast<double>(begin + width) / static_cast<double>(right.cols());
        const CornerValues some = right.middleCols(begin, width);
        solved.middleCols(begin, width) = solver.improve(some, solver.within_space(some, piece.monitor()),
                                                         conjugate_gradients, piece.until(0.6 + 0.4 * share));
    }
    if (!solved.allFinite()) return std::nullopt;
    return solved;
}

}  // namespace

CornerValues thin_plate(const Points& vertices, const Triangles& faces, const Eigen::SparseMatrix<double>& laplacian,
                        const Unknowns& unknowns, const CornerValues& values, Eigen::Index large, Piece piece,
                        double most) {
    const Eigen::VectorXd areas = vertex_areas(vertices, faces);
    piece.check();
    const Eigen::MatrixXd bent = areas.cwiseInverse().asDiagonal() * (laplacian * unknowns.zeroed(values));
    const CornerValues right = -of_unknowns(laplacian * bent, unknowns);
    const auto matrix = [&] { return bending(laplacian, areas, unknowns, piece.monitor()); };
    const std::vector<Eigen::Index> sizes = unknowns.large_hole_sizes(laplacian, large);
    if (!sizes.empty()) {
        if (unknowns.count() <= most_to_order) {
            const Cholesky factor(matrix(), most, piece);
            if (factor.usable()) return factor.solve(right, piece.monitor());
        }
        const auto solved = solve_nearly(vertices, laplacian, areas, unknowns, sizes, right, large, piece.until(0.9));
        if (solved) return *solved;
    }
    return factorised(matrix(), piece.until(1.0)).solve(right, piece.monitor());
}

}  // namespace isograft
