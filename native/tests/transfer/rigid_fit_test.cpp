// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/rigid_fit.h"

#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer/membrane.h"
#include "transfer/thin_plate.h"

namespace isograft {

namespace {

// Far fewer vertices than the holes here have.
constexpr Eigen::Index few = 500;

// A tube that is known at its two ends only, one of them turned to the side by `angle`.
struct BentTube {
    explicit BentTube(double angle) : rest(shapes::cylinder(48, 120, 1.0, 8.0)), placed(rest.vertices) {
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
        const Eigen::RowVector3d pivot(0.0, 0.0, 4.0);
        known = rest.vertices.col(2).array() < 1.0 || rest.vertices.col(2).array() > 7.0;
        for (Eigen::Index v = 0; v < placed.rows(); ++v) {
            if (placed(v, 2) > 7.0) placed.row(v) = (placed.row(v) - pivot) * turn.transpose() + pivot;
        }
    }

    [[nodiscard]] Points fitted(Eigen::Index large, int iterations = 50) const {
        Monitor monitor;
        CompletionOptions options;
        options.iterations = iterations;
        const Unknowns unknowns(rest.faces, known);
        return fit_rigid(rest.vertices, rest.faces, placed, unknowns, options, large, monitor, 0.0, 0.0).values;
    }

    // Root mean square over the edges of their stretch.
    [[nodiscard]] double stretch(const Points& at) const {
        double sum = 0.0;
        for (Eigen::Index f = 0; f < rest.faces.rows(); ++f) {
            for (int c = 0; c < 3; ++c) {
                const int a = rest.faces(f, c), b = rest.faces(f, (c + 1) % 3);
                const double before = (rest.vertices.row(a) - rest.vertices.row(b)).norm();
                sum += std::pow((at.row(a) - at.row(b)).norm() / before - 1.0, 2);
            }
        }
        return std::sqrt(sum / (3.0 * static_cast<double>(rest.faces.rows())));
    }

    shapes::Shape rest;
    Points placed;
    Mask known;
};

}  // namespace

TEST(RigidFit, IsNearlyTheSameByBothWays) {
    const BentTube tube(0.8);
    const Points exactly = tube.fitted(large_hole), nearly = tube.fitted(few);
    EXPECT_NE(exactly, nearly);
    EXPECT_LE((exactly - nearly).rowwise().norm().maxCoeff(), 1e-3);
}

TEST(RigidFit, BendsALargePartAndDoesNotStretchIt) {
    const BentTube tube(0.8);
    const Points exactly = tube.fitted(large_hole), nearly = tube.fitted(few), start = tube.fitted(few, 1);
    EXPECT_LT(tube.stretch(nearly), 0.7 * tube.stretch(start));
    EXPECT_LE(tube.stretch(nearly), 1.01 * tube.stretch(exactly));
}

TEST(RigidFit, BringsALargePartBackUnderARigidMotion) {
    const shapes::Shape rest = shapes::blob(4);
    const shapes::Shape placed = shapes::moved(rest, shapes::some_rotation(), {1.0, 2.0, 3.0});
    const Mask known = rest.vertices.col(2).array() < 0.0;
    Monitor monitor;
    const Unknowns unknowns(rest.faces, known);
    ASSERT_GT(unknowns.count(), 2 * few);
    Points start = placed.vertices;
    for (const int v : unknowns.vertex) start.row(v).setZero();
    CompletionOptions options;
    options.iterations = 500;
    const Points back = fit_rigid(rest.vertices, rest.faces, start, unknowns, options, few, monitor, 0.0, 0.0).values;
    EXPECT_LE((back - placed.vertices).rowwise().norm().maxCoeff(), 1e-2);
}

TEST(RigidFit, StopsWhenCancelledInBothWays) {
    const BentTube tube(0.3);
    const Unknowns unknowns(tube.rest.faces, tube.known);
    for (const Eigen::Index large : {few, large_hole}) {
        // Cancelled before it begins, while the smooth start is sought, and in its rounds.
        for (const double end : {0.0, 0.2, 0.6}) {
            Monitor refusing([&](const std::string&, double fraction) { return fraction < end; });
            EXPECT_THROW(
                fit_rigid(tube.rest.vertices, tube.rest.faces, tube.placed, unknowns, {}, large, refusing, 0.0, 0.0),
                Cancelled)
                << large << " " << end;
        }
    }
}

TEST(Membrane, ComesNearerWithEverySolution) {
    const BentTube tube(0.8);
    const Unknowns unknowns(tube.rest.faces, tube.known);
    const auto matrix = positive_laplacian(tube.rest.vertices, tube.rest.faces);
    Monitor monitor;
    const Membrane nearly(tube.rest.vertices, tube.rest.faces, matrix, unknowns, few, monitor, 0.0);
    const Membrane exactly(tube.rest.vertices, tube.rest.faces, matrix, unknowns, large_hole, monitor);
    const CornerValues right = CornerValues::Random(unknowns.count(), 3);
    const CornerValues goal = exactly.solve(right, CornerValues::Zero(right.rows(), 3), monitor);
    CornerValues found = CornerValues::Zero(right.rows(), 3);
    for (int k = 0; k < 3; ++k) {
        const double before = (found - goal).norm();
        found = nearly.solve(right, found, monitor);
        EXPECT_LT((found - goal).norm(), 0.5 * before) << k;
    }
}

}  // namespace isograft
