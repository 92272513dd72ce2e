// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/membrane.h"

#include <utility>
#include <vector>

#include "transfer/sparse.h"

namespace isograft {

namespace {

// Of one solution: what is left comes off in the next.
constexpr int conjugate_gradients = 1;
constexpr int degree = 3;

}  // namespace

Membrane::Nearly::Nearly(const Points& vertices, const Eigen::VectorXd& areas,
                         const Eigen::SparseMatrix<double>& laplacian, const Unknowns& unknowns,
                         const std::vector<Eigen::Index>& hole_sizes, Eigen::Index large, Piece piece)
    : space(vertices, areas, RowMatrix(laplacian), unknowns, hole_sizes, large, piece.until(0.3)),
      energy(stretching_rows(laplacian, unknowns)),
      solver(energy, space, degree, piece.until(1.0)) {}

Membrane::Membrane(const Points& vertices, const Triangles& faces, const Eigen::SparseMatrix<double>& laplacian,
                   const Unknowns& unknowns, Eigen::Index large, Piece piece, double most) {
    const RowMatrix matrix(unknowns.block(laplacian));
    const std::vector<Eigen::Index> sizes = unknowns.large_hole_sizes(laplacian, large);
    if (!sizes.empty()) {
        exactly_.emplace(matrix, most, piece);
        if (exactly_->usable()) return;
        exactly_.reset();
        auto nearly = std::make_unique<const Nearly>(vertices, vertex_areas(vertices, faces), laplacian, unknowns,
                                                     sizes, large, piece.until(0.9));
        if (nearly->solver.usable()) {
            nearly_ = std::move(nearly);
            piece.reach(1.0);
            return;
        }
    }
    exactly_.emplace(factorised(matrix, piece.until(1.0)));
}

CornerValues Membrane::solve(const CornerValues& right, const CornerValues& before, Monitor& monitor) const {
    if (nearly_) return nearly_->solver.improve(right, before, conjugate_gradients, monitor);
    return exactly_->solve(right, monitor);
}

}  // namespace isograft
