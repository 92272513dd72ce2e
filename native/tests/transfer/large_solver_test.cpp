// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/large_solver.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer/galerkin.h"

namespace isograft {

namespace {

// A shape of which only what lies below a plane is known, and some smooth values on it, 1 at most.
struct Hole {
    explicit Hole(const shapes::Shape& given)
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

double farthest(const CornerValues& a, const CornerValues& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST(BendingRows, AreTheSquareOfTheLaplacianOverTheAreas) {
    const Hole hole(shapes::blob(3));
    const Eigen::SparseMatrix<double> whole = hole.first * hole.areas.cwiseInverse().asDiagonal() * hole.first;
    const Eigen::MatrixXd expected = hole.unknowns.block(whole);
    EXPECT_LE((Eigen::MatrixXd(hole.matrix()) - expected).norm(), 1e-12 * expected.norm());
}

TEST(GradedSpace, HasFewParametersThatAddUpToOneEverywhere) {
    const Hole hole(shapes::blob(6));
    const GradedSpace space = hole.space();
    const int parameters = space.first(space.group_count());
    EXPECT_LT(parameters, hole.unknowns.count() / 3);
    CornerValues ones = CornerValues::Zero(parameters, 1);
    for (int group = 0; group < space.group_count(); ++group) ones(space.first(group), 0) = 1.0;
    EXPECT_LE((space.spread(ones).array() - 1.0).abs().maxCoeff(), 1e-12);
}

TEST(GradedSpace, LeavesSmallHolesFree) {
    const Hole hole(shapes::blob(4));
    const GradedSpace space = hole.space(hole.unknowns.count());
    EXPECT_EQ(space.group_count(), hole.unknowns.count());
    EXPECT_EQ(space.first(space.group_count()), hole.unknowns.count());
}

TEST(GradedSpace, GathersWhatItSpreads) {
    const Hole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    const CornerValues parameters = CornerValues::Random(space.first(space.group_count()), 2);
    const CornerValues values = CornerValues::Random(hole.unknowns.count(), 2);
    const double one = space.spread(parameters).cwiseProduct(values).sum();
    const double other = parameters.cwiseProduct(space.gather(values)).sum();
    EXPECT_NEAR(one, other, 1e-9 * values.norm() * parameters.norm());
}

TEST(EnergyWithin, IsThatOfWhatIsSpread) {
    const Hole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const RowMatrix lower = energy_within(space, hole.energy, monitor);
    const Eigen::VectorXd parameters = Eigen::VectorXd::Random(lower.rows());
    const Eigen::VectorXd bent = hole.energy.rows * space.spread(parameters);
    const double expected = bent.cwiseAbs2().dot(hole.energy.weights);
    EXPECT_NEAR(parameters.dot(lower.selfadjointView<Eigen::Lower>() * parameters), expected, 1e-9 * expected);
}

TEST(LargeSolver, ComesNearTheExactSolutionStepByStep) {
    const Hole hole(shapes::blob(6));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const LargeSolver solver(hole.energy, space, monitor);
    ASSERT_TRUE(solver.usable());
    const CornerValues exact = hole.exact(), nothing = CornerValues::Zero(exact.rows(), exact.cols());
    double before = farthest(nothing, exact);
    for (const int steps : {0, 2, 6}) {
        const double now = farthest(solver.improve(hole.right(), nothing, steps, monitor), exact);
        EXPECT_LT(now, 0.3 * before) << steps;
        before = now;
    }
    EXPECT_LE(before, 1e-3);
}

TEST(LargeSolver, StaysAtTheExactSolution) {
    const Hole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const LargeSolver solver(hole.energy, space, monitor);
    const CornerValues exact = hole.exact();
    EXPECT_LE(farthest(solver.improve(hole.right(), exact, 3, monitor), exact), 1e-7);
}

TEST(LargeSolver, SolvesEachColumnAsIfItWereAlone) {
    const Hole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const LargeSolver solver(hole.energy, space, monitor);
    const CornerValues right = hole.right();
    const CornerValues all = solver.improve(right, CornerValues::Zero(right.rows(), right.cols()), 3, monitor);
    for (Eigen::Index k = 0; k < right.cols(); ++k) {
        const CornerValues one = solver.improve(right.col(k), CornerValues::Zero(right.rows(), 1), 3, monitor);
        EXPECT_EQ(one, CornerValues(all.col(k))) << k;
    }
}

TEST(LargeSolver, StopsInEachOfItsParts) {
    const Hole hole(shapes::blob(4));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const LargeSolver solver(hole.energy, space, Piece(monitor, 0.5));
    EXPECT_NEAR(monitor.fraction(), 0.5, 1e-9);
    const CornerValues right = hole.right();
    static_cast<void>(solver.improve(right, right, 2, Piece(monitor, 0.5)));
    EXPECT_NEAR(monitor.fraction(), 1.0, 1e-9);
    monitor.cancel();
    EXPECT_THROW(GradedSpace(hole.shape.vertices, hole.areas, RowMatrix(hole.first), hole.unknowns,
                             hole.unknowns.hole_sizes(hole.first), 0, monitor),
                 Cancelled);
    EXPECT_THROW(energy_within(space, hole.energy, monitor), Cancelled);
    EXPECT_THROW(LargeSolver(hole.energy, space, monitor), Cancelled);
    EXPECT_THROW(static_cast<void>(solver.improve(right, right, 1, monitor)), Cancelled);
}

}  // namespace isograft
