// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/thin_plate.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {

namespace {

// A sheared plane of which only three rings of vertices along the border are known.
struct Hole {
    explicit Hole(const shapes::Shape& given = shapes::grid(nx, ny, 0.5, 0.4, 0.7))
        : shape(given), known(shape.vertices.rows()) {
        for (Eigen::Index v = 0; v < known.rows(); ++v) {
            const Eigen::Index i = v % (nx + 1), j = v / (nx + 1);
            known[v] = i < 3 || j < 3 || i > nx - 3 || j > ny - 3;
        }
    }

    [[nodiscard]] CornerValues linear() const {
        CornerValues values(shape.vertices.rows(), 2);
        values << shape.vertices.col(0) * 2.0 - shape.vertices.col(1), shape.vertices.col(1);
        return values;
    }

    // Of the unknowns only. \param large holes of more vertices nearly.
    [[nodiscard]] CornerValues solve(CornerValues values, Eigen::Index large, Monitor& monitor) const {
        const Unknowns unknowns(shape.faces, known);
        for (const int v : unknowns.vertex) values.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
        const auto first = laplacian(shape.vertices, shape.faces);
        return thin_plate(shape.vertices, shape.faces, first, unknowns, values, large, Piece(monitor, 1.0), 0.0);
    }

    [[nodiscard]] CornerValues at_unknowns(const CornerValues& values) const {
        const Unknowns unknowns(shape.faces, known);
        CornerValues rows(unknowns.count(), values.cols());
        for (Eigen::Index i = 0; i < rows.rows(); ++i) rows.row(i) = values.row(unknowns.vertex[i]);
        return rows;
    }

    static constexpr int nx = 72, ny = 66;
    // Far fewer than the hole has.
    static constexpr Eigen::Index few = 1000;
    shapes::Shape shape;
    Mask known;
};

// Angles of up to 155 degrees, unevenly divided.
shapes::Shape obtuse() {
    shapes::Shape plane = shapes::noisy(shapes::grid(Hole::nx, Hole::ny, 0.5, 0.3, 1.5), 0.04, 3);
    plane.vertices.col(2).setZero();
    return plane;
}

}  // namespace

TEST(ThinPlate, KeepsLinearFunctionsInSmallAndLargeHoles) {
    for (const Hole& hole : {Hole(), Hole(obtuse())}) {
        const CornerValues values = hole.linear();
        for (const Eigen::Index large : {Hole::few, large_hole}) {
            Monitor monitor;
            const CornerValues solved = hole.solve(values, large, monitor);
            EXPECT_NEAR(monitor.fraction(), 1.0, 0.15) << large;
            EXPECT_LE((solved - hole.at_unknowns(values)).cwiseAbs().maxCoeff(), 1e-7 * values.cwiseAbs().maxCoeff());
        }
    }
}

TEST(ThinPlate, IsNearlyTheSameByBothWays) {
    const Hole hole;
    // More columns than are solved at once.
    CornerValues values(hole.shape.vertices.rows(), 10);
    for (Eigen::Index v = 0; v < values.rows(); ++v) {
        const double x = hole.shape.vertices(v, 0), y = hole.shape.vertices(v, 1);
        for (Eigen::Index k = 0; k < values.cols(); ++k) {
            values(v, k) = std::sin(0.02 * static_cast<double>(k) * x + 0.3 * y);
        }
    }
    Monitor monitor;
    const CornerValues exactly = hole.solve(values, large_hole, monitor);
    const CornerValues nearly = hole.solve(values, Hole::few, monitor);
    EXPECT_NE(exactly, nearly);
    EXPECT_LE((exactly - nearly).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(ThinPlate, SolvesLargeHolesExactlyIfThatTakesLittle) {
    const Hole hole;
    CornerValues values = hole.linear();
    values.col(1) = values.col(1).array().square();
    const Unknowns unknowns(hole.shape.faces, hole.known);
    const auto first = laplacian(hole.shape.vertices, hole.shape.faces);
    const auto solved = [&](Eigen::Index large, double most) {
        Monitor monitor;
        return thin_plate(hole.shape.vertices, hole.shape.faces, first, unknowns, values, large, monitor, most);
    };
    const CornerValues exactly = solved(large_hole, 0.0);
    EXPECT_EQ(solved(Hole::few, linear_bending), exactly);
    EXPECT_NE(solved(Hole::few, 100.0), exactly);
}

TEST(ThinPlate, StopsWhenCancelled) {
    const Hole hole;
    for (const Eigen::Index large : {Hole::few, large_hole}) {
        Monitor monitor;
        monitor.cancel();
        EXPECT_THROW(hole.solve(hole.linear(), large, monitor), Cancelled) << large;
    }
}

}  // namespace isograft
