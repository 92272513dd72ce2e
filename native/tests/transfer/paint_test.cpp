// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/paint.h"

#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"

namespace isograft {
namespace {

constexpr int size = 20;
constexpr auto nothing = static_cast<std::uint8_t>(Texel::nothing);
constexpr auto baked = static_cast<std::uint8_t>(Texel::baked);
constexpr auto margin = static_cast<std::uint8_t>(Texel::margin);
constexpr auto filled = static_cast<std::uint8_t>(Texel::filled);

// Two triangles that make up the square from 0.2 to 0.8, values that are linear in it, and an image of them.
struct Square {
    CornerUV uv{6, 2};
    PaintChannel channel;
    std::vector<float> image = std::vector<float>(size * size, -1.0F);
    std::vector<std::uint8_t> mask = std::vector<std::uint8_t>(size * size, nothing);

    Square() {
        uv << 0.2, 0.2, 0.8, 0.2, 0.8, 0.8, 0.2, 0.2, 0.8, 0.8, 0.2, 0.8;
        channel.values = uv.col(0) + 2.0 * uv.col(1);
        channel.reals = image.data();
    }

    static float truth(int x, int y) { return static_cast<float>((x + 0.5) / size + 2.0 * (y + 0.5) / size); }

    void paint(bool first, bool second, int texels, int threads = 1) {
        Mask wanted(2);
        wanted << first, second;
        isograft::paint(uv, wanted, {channel}, {size, size, texels, threads}, mask.data());
    }
};

TEST(Paint, IsLinearBetweenTheCorners) {
    Square square;
    square.paint(true, true, 0);
    int count = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            if (square.mask[y * size + x] != filled) continue;
            ++count;
            EXPECT_NEAR(square.image[y * size + x], Square::truth(x, y), 1e-6);
        }
    }
    EXPECT_EQ(count, 144);
}

TEST(Paint, LeavesWhatIsBakedAndWhatIsNotWanted) {
    Square square;
    square.mask[9 * size + 12] = baked;
    square.paint(true, false, 0);
    EXPECT_EQ(square.mask[9 * size + 12], baked);
    EXPECT_EQ(square.image[9 * size + 12], -1.0F);
    EXPECT_EQ(square.mask[12 * size + 6], nothing);
    EXPECT_EQ(square.mask[6 * size + 12], filled);
}

TEST(Paint, PutsAMarginAroundWhatIsBakedAndWhatIsFilled) {
    Square square;
    square.mask[0] = baked;
    square.image[0] = 7.0F;
    square.paint(true, true, 2);
    EXPECT_EQ(square.mask[1], margin);
    EXPECT_EQ(square.image[1], 7.0F);
    EXPECT_EQ(square.mask[2 * size + 8], margin);
    EXPECT_EQ(square.image[2 * size + 8], square.image[4 * size + 8]);
    EXPECT_EQ(square.mask[size * size - 1], nothing);
}

TEST(Paint, IsEqualForAnyNumberOfThreads) {
    Square one, eight;
    one.paint(true, true, 3, 1);
    eight.paint(true, true, 3, 8);
    EXPECT_EQ(one.image, eight.image);
    EXPECT_EQ(one.mask, eight.mask);
}

TEST(Paint, RefusesValuesOfOtherTrianglesAndStopsWhenCancelled) {
    Square square;
    square.channel.values.conservativeResize(3, 1);
    EXPECT_THROW(square.paint(true, true, 0), InvalidInput);
    Square other;
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(isograft::paint(other.uv, Mask::Constant(2, true), {other.channel}, {size, size, 0, 1},
                                 other.mask.data(), &monitor),
                 Cancelled);
}

}  // namespace
}  // namespace isograft
