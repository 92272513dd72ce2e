// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "isograft/monitor.h"
#include "shapes.h"
#include "transfer/cholesky.h"
#include "transfer/graded_space.h"
#include "transfer/laplacian.h"
#include "transfer/large_solver.h"

namespace isograft {

// A shape of which only what lies below a plane is known, and some smooth values on it, 1 at most.
struct OpenHole {
    explicit OpenHole(const shapes::Shape& given)
        : shape(given),
          first(laplacian(shape.vertices, shape.faces)),
          areas(vertex_areas(shape.vertices, shape.faces)),
          known(shape.vertices.col(2).array() < 0.0),
          unknowns(shape.faces, known),
          energy(bending_rows(first, areas, unknowns)) {}

    [[nodiscard]] GradedSpace space(Eigen::Index few = 0) const {
        Monitor monitor;
        return {shape.vertices, areas, RowMatrix(first), unknowns, unknowns.hole_sizes(first), few, monitor};
    }

    [[nodiscard]] Eigen::SparseMatrix<double> matrix() const {
        const Eigen::SparseMatrix<double> rows(energy.rows);
        return rows.transpose() * energy.weights.asDiagonal() * rows;
    }

    // What the known values ask for: the first column of positions, the others waves.
    [[nodiscard]] CornerValues right() const {
        CornerValues values = CornerValues::Zero(shape.vertices.rows(), 3);
        for (Eigen::Index v = 0; v < values.rows(); ++v) {
            if (!known[v]) continue;
            const double x = shape.vertices(v, 0), y = shape.vertices(v, 1);
            values.row(v) << x, std::sin(4.0 * x) * std::cos(3.0 * y), x > 0.2 ? 1.0 : 0.0;
        }
        const Eigen::MatrixXd pull = first * (areas.cwiseInverse().asDiagonal() * (first * values));
        CornerValues rows(unknowns.count(), 3);
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) rows.row(i) = -pull.row(unknowns.vertex[i]);
        return rows;
    }

    [[nodiscard]] CornerValues exact() const {
        Monitor monitor;
        return Cholesky(RowMatrix(matrix()), monitor).solve(right(), monitor);
    }

    shapes::Shape shape;
    Eigen::SparseMatrix<double> first;
    Eigen::VectorXd areas;
    Mask known;
    Unknowns unknowns;
    SquaredRows energy;
};

}  // namespace isograft
