// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/landmarks.h"

#include <gtest/gtest.h>

#include "made_patch.h"

namespace isograft {
namespace {

// The first samples of the two sides do not belong together, so a map of this test puts them where the target's are.
PartialMap keeping(int landmarks) {
    const Twins& twins = Twins::of_a_blob();
    const Pair& pair = twins.pair();
    PartialMap map(pair.source.samples.count());
    for (int i = 0; i < landmarks; ++i) map.put(pair.target.mesh, i, pair.target.samples.point[i], Complex(1.0, 0.0));
    return map;
}

TEST(Heed, IsWholeWithoutLandmarksAndHalfOutsideTheMap) {
    const Pair& pair = Twins::of_a_blob().pair();
    EXPECT_EQ(heed(keeping(3), pair, {}).share, 1.0);
    EXPECT_FALSE(heed(keeping(3), pair, {}).vouched());
    EXPECT_EQ(heed(keeping(0), pair, {1.0, 0.5}).share, 0.5);
    EXPECT_EQ(heed(keeping(1), pair, {1.0, 1.0}).share, 0.75);
}

TEST(Heed, WeighsWhatIsKeptAgainstWhatIsBroken) {
    const Pair& pair = Twins::of_a_blob().pair();
    PartialMap map = keeping(3);
    EXPECT_EQ(heed(map, pair, {1.0, 0.5, 0.25}).share, 1.0);
    EXPECT_TRUE(heed(map, pair, {1.0, 0.5, 0.25}).vouched());
    const Eigen::Vector3d there = pair.target.samples.position[0];
    const auto at = shapes::point_nearest(pair.target.mesh, 2.0 * Twins::of_a_blob().truth({0.0, 0.0, 0.0}) - there);
    map.put(pair.target.mesh, 0, at, Complex(1.0, 0.0));
    const Heed heeded = heed(map, pair, {1.0, 0.5, 0.25});
    EXPECT_EQ(heeded.kept, 0.75);
    EXPECT_EQ(heeded.broken, 1.0);
    EXPECT_EQ(heeded.kept_count, 2);
    EXPECT_NEAR(heeded.share, 0.5 * (1.0 - 0.25 / 1.75), 1e-15);
    EXPECT_FALSE(heeded.vouched());
    EXPECT_TRUE(heed(map, pair, {0.5, 0.5, 0.25}).vouched());
}

TEST(Heed, DoesNotTakeOneLandmarkForAVoucher) {
    EXPECT_FALSE(heed(keeping(1), Twins::of_a_blob().pair(), {1.0, 1.0}).vouched());
    EXPECT_TRUE(heed(keeping(2), Twins::of_a_blob().pair(), {1.0, 1.0}).vouched());
}

}  // namespace
}  // namespace isograft
