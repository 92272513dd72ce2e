// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/fill.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {

namespace {

Mask away_from(const shapes::Shape& shape, const Eigen::RowVector3d& centre, double radius) {
    return (shape.vertices.rowwise() - centre).rowwise().norm().array() > radius;
}

}  // namespace

TEST(FillSmooth, ContinuesALinearFunctionOnAShearedPlane) {
    const shapes::Shape plane = shapes::grid(14, 12, 0.5, 0.4, 0.7);
    const Mask known = away_from(plane, plane.vertices.colwise().mean(), 1.2);
    CornerValues values(plane.vertices.rows(), 2);
    values << plane.vertices.col(0) * 2.0 - plane.vertices.col(1), plane.vertices.col(1);
    const TransferredValues filled = fill_smooth(plane.vertices, plane.faces, values, known);
    EXPECT_GT((!known).count(), 10);
    EXPECT_TRUE((filled.mask == !known).all());
    EXPECT_LE((filled.values - values).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(FillSmooth, LeavesPartsAloneOfWhichNothingIsKnown) {
    const shapes::Shape one = shapes::sphere(1);
    const shapes::Shape two = shapes::joined(one, one);
    Mask known = Mask::Constant(two.vertices.rows(), false);
    known[3] = true;
    const CornerValues values = Eigen::VectorXd::LinSpaced(two.vertices.rows(), 0.0, 1.0);
    const TransferredValues filled = fill_smooth(two.vertices, two.faces, values, known);
    const Eigen::Index half = one.vertices.rows();
    EXPECT_TRUE(filled.mask.head(half).count() == half - 1 && filled.mask.tail(half).count() == 0);
    // Of one known value only: constant.
    EXPECT_LE((filled.values.topRows(half).array() - values(3, 0)).abs().maxCoeff(), 1e-9);
    EXPECT_EQ(filled.values.bottomRows(half), values.bottomRows(half));
}

TEST(NearestKnown, GoesAlongTheSurface) {
    // Two sheets that lie close to each other: what is known of one says nothing of the other.
    const shapes::Shape sheet = shapes::grid(4, 4, 1.0, 1.0);
    const shapes::Shape two =
        shapes::joined(sheet, shapes::moved(sheet, Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.01}));
    Mask known = Mask::Constant(50, false);
    known[0] = true;
    const Eigen::VectorXi source = nearest_known(two.vertices, two.faces, known);
    EXPECT_TRUE((source.head(25).array() == 0).all());
    EXPECT_TRUE((source.tail(25).array() == -1).all());
}

TEST(NearestKnown, TellsHowFarItIsAndStopsWhenCancelled) {
    const shapes::Shape shape = shapes::sphere(5);
    Mask known = Mask::Constant(shape.vertices.rows(), false);
    known[0] = true;
    std::vector<double> told;
    Monitor listening([&](const std::string&, double fraction) {
        told.push_back(fraction);
        return true;
    });
    nearest_known(shape.vertices, shape.faces, known, &listening);
    EXPECT_EQ(told.front(), 0.0);
    EXPECT_EQ(told.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    Monitor refusing([](const std::string&, double fraction) { return fraction < 0.05; });
    EXPECT_THROW(nearest_known(shape.vertices, shape.faces, known, &refusing), Cancelled);
}

TEST(CompleteRigid, BringsARemovedPartBackUnderARigidMotion) {
    const shapes::Shape rest = shapes::blob(3);
    const shapes::Shape placed = shapes::moved(rest, shapes::some_rotation(), {1.0, 2.0, 3.0}, 2.0);
    const Mask known = away_from(rest, rest.vertices.row(0), 0.5);
    Points start = placed.vertices;
    for (Eigen::Index v = 0; v < start.rows(); ++v) {
        if (!known[v]) start.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    CompletionOptions options;
    options.iterations = 500;
    const TransferredValues done = complete_rigid(rest.vertices, rest.faces, start, known, 2.0, options);
    EXPECT_GT((!known).count(), 10);
    EXPECT_TRUE((done.mask == !known).all());
    EXPECT_LE((done.values - placed.vertices).rowwise().norm().maxCoeff(), 1e-2);
}

TEST(CornerGroups, TellHowFarTheyAreAndStopWhenCancelled) {
    const shapes::Shape shape = shapes::sphere(2);
    const CornerValues nothing(3 * shape.faces.rows(), 0);
    std::vector<double> told;
    Monitor listening([&](const std::string&, double fraction) {
        told.push_back(fraction);
        return true;
    });
    EXPECT_EQ(corner_groups(shape.faces, nothing, 0.0, shape.vertices, &listening).maxCoeff() + 1,
              shape.vertices.rows());
    ASSERT_GE(told.size(), 4U);
    EXPECT_EQ(told.front(), 0.0);
    EXPECT_EQ(told.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    for (const double end : {0.0, told[1], told[2]}) {
        Monitor refusing([&](const std::string&, double fraction) { return fraction <= end; });
        EXPECT_THROW(corner_groups(shape.faces, nothing, 0.0, shape.vertices, &refusing), Cancelled);
    }
}

TEST(CompleteRigid, RefusesAndStops) {
    const shapes::Shape rest = shapes::sphere(1);
    Mask known = Mask::Constant(rest.vertices.rows(), true);
    known[0] = false;
    EXPECT_THROW(complete_rigid(rest.vertices, rest.faces, rest.vertices, known, 0.0), InvalidInput);
    EXPECT_THROW(complete_rigid(rest.vertices, rest.faces, rest.vertices, known.head(3), 1.0), InvalidInput);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(complete_rigid(rest.vertices, rest.faces, rest.vertices, known, 1.0, {}, &monitor), Cancelled);
    EXPECT_THROW(fill_smooth(rest.vertices, rest.faces, rest.vertices, known, &monitor), Cancelled);
}

TEST(FillSmooth, TellsHowFarItIsAndStopsInTheMiddleOfItsFactorisation) {
    const shapes::Shape shape = shapes::blob(6);
    const Mask known = shape.vertices.col(2).array() > 0.8;
    EXPECT_GT((!known).count(), 30000);
    std::vector<double> told;
    // A second of work; the callback is asked every tenth of one.
    Monitor refusing([&](const std::string&, double fraction) {
        told.push_back(fraction);
        return fraction < 0.1;
    });
    EXPECT_THROW(fill_smooth(shape.vertices, shape.faces, shape.vertices, known, &refusing), Cancelled);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_LT(told.back(), 0.5);
    told.clear();
    // The start of the rigid completion is such a factorisation.
    Monitor other([&](const std::string&, double fraction) {
        told.push_back(fraction);
        return fraction < 0.04;
    });
    EXPECT_THROW(complete_rigid(shape.vertices, shape.faces, shape.vertices, known, 1.0, {}, &other), Cancelled);
    EXPECT_LT(told.back(), 0.2);
}

}  // namespace isograft
