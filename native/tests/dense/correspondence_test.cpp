// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/correspondence.h"

#include <limits>

#include <gtest/gtest.h>

#include "base/random.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

Correspondence random_correspondence(const shapes::Shape& target, int count) {
    Random random(3);
    Correspondence c;
    c.face.resize(count);
    c.barycentric.resize(count, 3);
    for (int i = 0; i < count; ++i) {
        c.face[i] = i % 5 == 4 ? -1 : random.below(static_cast<int>(target.faces.rows()));
        const Eigen::Vector3d w(random.uniform(), random.uniform(), random.uniform());
        c.barycentric.row(i) = w.transpose() / w.sum();
        if (c.face[i] < 0) c.barycentric.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    return c;
}

TEST(Interpolate, ReproducesWhatIsLinearInSpace) {
    const auto target = shapes::blob(2);
    const auto c = random_correspondence(target, 50);
    const Eigen::MatrixXd points = c.interpolate(target.vertices, target.faces);
    Eigen::MatrixXd linear = target.vertices * Eigen::Vector3d(1.0, -2.0, 0.5);
    linear.array() += 4.0;
    const Eigen::MatrixXd moved = c.interpolate(linear, target.faces);
    ASSERT_EQ(moved.rows(), 50);
    ASSERT_EQ(moved.cols(), 1);
    for (int i = 0; i < 50; ++i) {
        if (c.face[i] < 0) {
            EXPECT_TRUE(std::isnan(moved(i, 0)));
            EXPECT_TRUE(points.row(i).array().isNaN().all());
        } else {
            EXPECT_NEAR(moved(i, 0), points.row(i).dot(Eigen::RowVector3d(1.0, -2.0, 0.5)) + 4.0, 1e-12);
        }
    }
}

TEST(Interpolate, GivesTheVertexItsOwnValueEvenBesideNaN) {
    const auto target = shapes::grid(1, 1, 1.0, 1.0);
    Correspondence c;
    c.face = Eigen::VectorXi::Constant(1, 0);
    c.barycentric = Points(1, 3);
    c.barycentric << 0.0, 1.0, 0.0;
    Eigen::MatrixXd values = Eigen::MatrixXd::Constant(4, 2, std::numeric_limits<double>::quiet_NaN());
    values.row(target.faces(0, 1)) << 7.0, 8.0;
    EXPECT_EQ(c.interpolate(values, target.faces), (Eigen::MatrixXd(1, 2) << 7.0, 8.0).finished());
}

TEST(Interpolate, RefusesTooFewRowsAndSaysHowMany) {
    const auto target = shapes::blob(1);
    const auto c = random_correspondence(target, 200);
    try {
        (void)c.interpolate(Eigen::MatrixXd::Zero(3, 1), target.faces);
        FAIL() << "nothing was thrown";
    } catch (const InvalidInput& e) {
        EXPECT_NE(std::string(e.what()).find("`values` has 3 rows"), std::string::npos) << e.what();
    }
    EXPECT_THROW((void)c.interpolate(target.vertices, target.faces.topRows(1)), InvalidInput);
}

}  // namespace
}  // namespace isograft
