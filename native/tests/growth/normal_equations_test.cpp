// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/normal_equations.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "base/random.h"

namespace isograft {
namespace {

struct Residual {
    double weight, value;
    Complex u, v;
};

struct System {
    int points = 60;
    std::vector<std::array<int, 2>> pairs;
    std::vector<Residual> residuals;
    Eigen::MatrixXd h;
    Eigen::VectorXd g;
};

// Residuals between random points, some pairs more than once, and the same written out as one dense matrix.
System random_system() {
    System s;
    Random random(3);
    s.h = Eigen::MatrixXd::Zero(2 * s.points, 2 * s.points);
    s.g = Eigen::VectorXd::Zero(2 * s.points);
    for (int i = 0; i < 300; ++i) {
        const int a = random.below(s.points), b = (a + 1 + random.below(i % 3 == 0 ? 2 : s.points - 1)) % s.points;
        const auto number = [&] { return 2.0 * random.uniform() - 1.0; };
        const Residual r{0.5 + random.uniform(), number(), {number(), number()}, {number(), number()}};
        s.pairs.push_back({a, b});
        s.residuals.push_back(r);
        Eigen::VectorXd row = Eigen::VectorXd::Zero(2 * s.points);
        row.segment<2>(2 * a) << r.u.real(), r.u.imag();
        row.segment<2>(2 * b) << r.v.real(), r.v.imag();
        s.h += r.weight * row * row.transpose();
        s.g += r.weight * r.value * row;
    }
    return s;
}

NormalEquations assembled(const System& s) {
    NormalEquations result(s.points, s.pairs);
    for (std::size_t i = 0; i < s.pairs.size(); ++i) {
        const Residual& r = s.residuals[i];
        result.add_pair(static_cast<int>(i), r.weight, r.value, r.u, r.v);
    }
    return result;
}

TEST(NormalEquations, AgreeWithADenseFactorisation) {
    System s = random_system();
    NormalEquations system = assembled(s);
    Eigen::Matrix2d h;
    h << 2.0, 0.3, 0.3, 1.0;
    const Eigen::Vector2d g(0.7, -0.2);
    system.add_point(5, g, h);
    s.h.block<2, 2>(10, 10) += h;
    s.g.segment<2>(10) += g;
    EXPECT_LT((system.gradient() - s.g).norm(), 1e-12 * s.g.norm());
    for (const double radius : {1.0, 1e3}) {
        const Eigen::MatrixXd damped = s.h + Eigen::MatrixXd((s.h.diagonal() / radius).asDiagonal());
        const Eigen::VectorXd x = damped.ldlt().solve(-s.g);
        EXPECT_LT((system.solve(radius, 1e-10) - x).norm(), 1e-7 * x.norm()) << radius;
        EXPECT_LT((system.solve(radius, 1e-4) - x).norm(), 1e-2 * x.norm()) << radius;
        EXPECT_NEAR(system.predicted_fall(x), -s.g.dot(x) - 0.5 * x.dot(s.h * x), 1e-10);
    }
}

TEST(NormalEquations, LeaveAPointWithoutResidualsWhereItIs) {
    NormalEquations system(3, {{0, 2}});
    system.add_pair(0, 1.0, 0.5, {1.0, 0.0}, {-1.0, 0.0});
    const Eigen::VectorXd x = system.solve(1e3, 1e-8);
    EXPECT_EQ(x.segment<2>(2), Eigen::Vector2d::Zero());
    EXPECT_NEAR(x[0], -0.25, 1e-3);
    EXPECT_NEAR(x[4], 0.25, 1e-3);
    EXPECT_TRUE(x.allFinite());
}

TEST(NormalEquations, AreEmptyAgainAfterClear) {
    const System s = random_system();
    NormalEquations system = assembled(s);
    const Eigen::VectorXd x = system.solve(1e3, 1e-8);
    system.clear();
    EXPECT_EQ(system.solve(1e3, 1e-8), Eigen::VectorXd::Zero(2 * s.points));
    for (std::size_t i = 0; i < s.pairs.size(); ++i) {
        const Residual& r = s.residuals[i];
        system.add_pair(static_cast<int>(i), r.weight, r.value, r.u, r.v);
    }
    EXPECT_EQ(system.solve(1e3, 1e-8), x);
}

}  // namespace
}  // namespace isograft
