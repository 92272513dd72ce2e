// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/large_solver.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "open_hole.h"
#include "shapes.h"
#include "transfer/galerkin.h"

namespace isograft {

namespace {

// A hole with its space and its solver.
struct Solver {
    explicit Solver(const shapes::Shape& shape)
        : hole(shape), space(hole.space()), nearly(hole.energy, space, 5, monitor) {}

    Monitor monitor;
    const OpenHole hole;
    const GradedSpace space;
    const LargeSolver nearly;
};

double farthest(const CornerValues& a, const CornerValues& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace

TEST(BendingRows, AreTheSquareOfTheLaplacianOverTheAreas) {
    const OpenHole hole(shapes::blob(3));
    const Eigen::SparseMatrix<double> whole = hole.first * hole.areas.cwiseInverse().asDiagonal() * hole.first;
    const Eigen::MatrixXd expected = hole.unknowns.block(whole);
    EXPECT_LE((Eigen::MatrixXd(hole.matrix()) - expected).norm(), 1e-12 * expected.norm());
}

TEST(StretchingRows, AreTheLaplacian) {
    const OpenHole hole(shapes::blob(3));
    const Eigen::SparseMatrix<double> first = positive_laplacian(hole.shape.vertices, hole.shape.faces);
    const SquaredRows energy = stretching_rows(first, hole.unknowns);
    const Eigen::SparseMatrix<double> rows(energy.rows);
    const Eigen::MatrixXd found = Eigen::SparseMatrix<double>(rows.transpose() * energy.weights.asDiagonal() * rows);
    const Eigen::MatrixXd expected = hole.unknowns.block(first);
    EXPECT_GT(energy.weights.minCoeff(), 0.0);
    EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
}

TEST(GradedSpace, HasFewParametersThatAddUpToOneEverywhere) {
    const OpenHole hole(shapes::blob(6));
    const GradedSpace space = hole.space();
    const int parameters = space.first(space.group_count());
    EXPECT_LT(parameters, hole.unknowns.count() / 3);
    CornerValues ones = CornerValues::Zero(parameters, 1);
    for (int group = 0; group < space.group_count(); ++group) ones(space.first(group), 0) = 1.0;
    EXPECT_LE((space.spread(ones).array() - 1.0).abs().maxCoeff(), 1e-12);
}

TEST(GradedSpace, LeavesSmallHolesFree) {
    const OpenHole hole(shapes::blob(4));
    const GradedSpace space = hole.space(hole.unknowns.count());
    EXPECT_EQ(space.group_count(), hole.unknowns.count());
    EXPECT_EQ(space.first(space.group_count()), hole.unknowns.count());
}

TEST(GradedSpace, GathersWhatItSpreads) {
    const OpenHole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    const CornerValues parameters = CornerValues::Random(space.first(space.group_count()), 2);
    const CornerValues values = CornerValues::Random(hole.unknowns.count(), 2);
    const double one = space.spread(parameters).cwiseProduct(values).sum();
    const double other = parameters.cwiseProduct(space.gather(values)).sum();
    EXPECT_NEAR(one, other, 1e-9 * values.norm() * parameters.norm());
}

TEST(EnergyWithin, IsThatOfWhatIsSpread) {
    const OpenHole hole(shapes::blob(5));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const RowMatrix lower = energy_within(space, hole.energy, monitor);
    const Eigen::VectorXd parameters = Eigen::VectorXd::Random(lower.rows());
    const Eigen::VectorXd bent = hole.energy.rows * space.spread(parameters);
    const double expected = bent.cwiseAbs2().dot(hole.energy.weights);
    EXPECT_NEAR(parameters.dot(lower.selfadjointView<Eigen::Lower>() * parameters), expected, 1e-9 * expected);
}

TEST(LargeSolver, ComesNearTheExactSolutionStepByStep) {
    Solver solver(shapes::blob(6));
    ASSERT_TRUE(solver.nearly.usable());
    const CornerValues exact = solver.hole.exact(), nothing = CornerValues::Zero(exact.rows(), exact.cols());
    double before = farthest(nothing, exact);
    const CornerValues right = solver.hole.right(), start = solver.nearly.within_space(right, solver.monitor);
    for (const int steps : {0, 2, 6}) {
        const double now = farthest(solver.nearly.improve(right, start, steps, solver.monitor), exact);
        EXPECT_LT(now, 0.3 * before) << steps;
        before = now;
    }
    EXPECT_LE(before, 1e-3);
}

TEST(LargeSolver, StaysAtTheExactSolution) {
    Solver solver(shapes::blob(5));
    const CornerValues exact = solver.hole.exact();
    EXPECT_LE(farthest(solver.nearly.improve(solver.hole.right(), exact, 3, solver.monitor), exact), 1e-7);
}

TEST(LargeSolver, SolvesEachColumnAsIfItWereAlone) {
    Solver solver(shapes::blob(5));
    const CornerValues right = solver.hole.right();
    const auto improved = [&](const CornerValues& some) {
        return solver.nearly.improve(some, CornerValues::Zero(some.rows(), some.cols()), 3, solver.monitor);
    };
    const CornerValues all = improved(right);
    for (Eigen::Index k = 0; k < right.cols(); ++k) {
        const CornerValues one = improved(right.col(k));
        EXPECT_EQ(one, CornerValues(all.col(k))) << k;
    }
}

TEST(LargeSolver, StopsInEachOfItsParts) {
    const OpenHole hole(shapes::blob(4));
    const GradedSpace space = hole.space();
    Monitor monitor;
    const LargeSolver solver(hole.energy, space, 5, Piece(monitor, 0.5));
    EXPECT_NEAR(monitor.fraction(), 0.5, 1e-9);
    const CornerValues right = hole.right();
    static_cast<void>(solver.improve(right, right, 2, Piece(monitor, 0.5)));
    EXPECT_NEAR(monitor.fraction(), 1.0, 1e-9);
    monitor.cancel();
    EXPECT_THROW(GradedSpace(hole.shape.vertices, hole.areas, RowMatrix(hole.first), hole.unknowns,
                             hole.unknowns.hole_sizes(hole.first), 0, monitor),
                 Cancelled);
    EXPECT_THROW(energy_within(space, hole.energy, monitor), Cancelled);
    EXPECT_THROW(LargeSolver(hole.energy, space, 5, monitor), Cancelled);
    EXPECT_THROW(static_cast<void>(solver.improve(right, right, 1, monitor)), Cancelled);
}

}  // namespace isograft
