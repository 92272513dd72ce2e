// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/doubt.h"

#include <vector>

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

TEST(Doubt, IsAProbability) {
    for (const double bad : {0.0, 0.01, 0.5, 5.0}) {
        for (const double support : {0.0, 0.5, 1.0}) {
            const double d = doubt({bad, bad, bad, support, 0.0, false});
            EXPECT_GE(d, 0.0);
            EXPECT_LE(d, 1.0);
        }
    }
}

TEST(Doubt, RisesWithEveryMisfitAndFallsWithSupport) {
    const Evidence usual{0.2, 0.05, 0.1, 0.5, 0.0, false};
    Evidence e = usual;
    e.mismatch = 0.4;
    EXPECT_GT(doubt(e), doubt(usual));
    e = usual;
    e.incompatibility = 0.1;
    EXPECT_GT(doubt(e), doubt(usual));
    e = usual;
    e.curvature = 0.2;
    EXPECT_GT(doubt(e), doubt(usual));
    e = usual;
    e.hearsay = 1.0;
    EXPECT_GT(doubt(e), doubt(usual));
    e = usual;
    e.support = 0.9;
    EXPECT_LT(doubt(e), doubt(usual));
}

TEST(Doubt, ListensToDistancesAndSupportOnWholeSurfaces) {
    const Evidence usual{0.2, 0.05, 0.1, 0.5, 0.0, true};
    Evidence e = usual;
    e.incompatibility = 0.1;
    EXPECT_GT(doubt(e), doubt(usual));
    e = usual;
    e.support = 0.9;
    EXPECT_LT(doubt(e), doubt(usual));
    e = usual;
    e.mismatch = 0.4;
    EXPECT_EQ(doubt(e), doubt(usual));
}

TEST(Doubt, IsSmallWhereAllFitsAndLargeWhereNothingDoes) {
    EXPECT_LT(doubt({0.02, 0.0, 0.01, 1.0, 0.0, false}), 0.01);
    EXPECT_GT(doubt({1.0, 0.3, 0.5, 0.05, 0.0, false}), 0.9);
}

class SupportOfPatches : public testing::Test {
  protected:
    static constexpr double radius = 0.06;

    /// A patch that holds sample 3 alone, at `x` in space.
    static Patch at(double x) {
        Patch patch;
        patch.map = PartialMap(5);
        patch.map.put(Twins::of_a_blob().pair().target.mesh, 3, {0, {1.0, 0.0, 0.0}}, Complex(1.0, 0.0));
        patch.map.position[3] = Eigen::Vector3d(x, 0.0, 0.0);
        patch.map.seed_distance[3] = 0.0F;
        return patch;
    }
};

TEST_F(SupportOfPatches, IsEvenWherePatchesAreSilent) {
    const Support support({at(0.0)}, 5, radius, 0.1);
    EXPECT_DOUBLE_EQ(support.share(2, Eigen::Vector3d::Zero()), 0.5);
}

TEST_F(SupportOfPatches, IsTheShareThatAgrees) {
    const std::vector<Patch> patches{at(0.0), at(0.01), at(1.0), at(0.02)};
    const Support support(patches, 5, radius, 0.1);
    const double here = support.share(3, Eigen::Vector3d::Zero());
    const double there = support.share(3, Eigen::Vector3d(1.0, 0.0, 0.0));
    const double nowhere = support.share(3, Eigen::Vector3d(2.0, 0.0, 0.0));
    EXPECT_NEAR(here, 0.75, 0.02);
    EXPECT_NEAR(there, 0.25, 0.02);
    EXPECT_LT(nowhere, 0.02);
}

TEST_F(SupportOfPatches, WeighsPatchesByTheirQuality) {
    std::vector<Patch> patches{at(0.0), at(1.0)};
    patches[1].quality = 0.8;
    const Support support(patches, 5, radius, 0.1);
    EXPECT_GT(support.share(3, Eigen::Vector3d::Zero()), 0.7);
}

TEST_F(SupportOfPatches, NamesTheStrongestRivalOfAPlace) {
    const std::vector<Patch> patches{at(0.0), at(1.0), at(1.01), at(2.0)};
    const Support support(patches, 5, radius, 0.1);
    EXPECT_NEAR(support.rival(3, Eigen::Vector3d::Zero()), 0.5, 0.02);
    EXPECT_NEAR(support.rival(3, Eigen::Vector3d(1.0, 0.0, 0.0)), 0.25, 0.02);
    // Beside a place is no other place.
    EXPECT_LT(Support({at(0.0)}, 5, radius, 0.1).rival(3, Eigen::Vector3d(1.5 * radius, 0.0, 0.0)), 0.05);
}

}  // namespace
}  // namespace isograft
