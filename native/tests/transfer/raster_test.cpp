// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/raster.h"

#include <gtest/gtest.h>

#include "base/random.h"

namespace isograft {

namespace {

// The unit square cut into 2 n n triangles at places moved by chance.
CornerUV square(int n) {
    Random random(3);
    std::vector<Eigen::RowVector2d> at;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            const bool inner = i > 0 && i < n && j > 0 && j < n;
            const double x = inner ? random.uniform() - 0.5 : 0.0, y = inner ? random.uniform() - 0.5 : 0.0;
            at.emplace_back((j + 0.6 * x) / n, (i + 0.6 * y) / n);
        }
    }
    CornerUV uv(6 * n * n, 2);
    for (int c = 0; c < n * n; ++c) {
        const int a = c / n * (n + 1) + c % n;
        const int corner[6] = {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1};
        for (int k = 0; k < 6; ++k) uv.row(6 * c + k) = at[corner[k]];
    }
    return uv;
}

}  // namespace

TEST(Raster, CoversEveryTexelOfASquareThatIsCutUpOnceOrOnAnEdge) {
    const CornerUV uv = square(7);
    const int width = 61, height = 47;
    std::vector<int> hits(width * height, 0);
    for (int f = 0; f < uv.rows() / 3; ++f) {
        const TexelTriangle triangle(uv, f, width, height);
        for (int y = triangle.first_row(); y < triangle.end_row(); ++y) {
            const Span span = triangle.span(y);
            for (int x = span.from; x < span.to; ++x) ++hits[y * width + x];
        }
    }
    int once = 0;
    for (const int count : hits) {
        EXPECT_GE(count, 1);
        once += count == 1 ? 1 : 0;
    }
    EXPECT_GE(once, width * height * 97 / 100);
}

TEST(Raster, GivesTheWeightsThatLeadBackToTheCentreOfTheTexel) {
    const CornerUV uv = square(5);
    for (int f = 0; f < uv.rows() / 3; ++f) {
        const TexelTriangle triangle(uv, f, 64, 32);
        for (int y = triangle.first_row(); y < triangle.end_row(); ++y) {
            const Span span = triangle.span(y);
            for (int x = span.from; x < span.to; ++x) {
                const Eigen::RowVector3d weights = (span.at + x * span.step).transpose();
                const Eigen::RowVector2d at = weights * uv.middleRows(3 * f, 3);
                EXPECT_NEAR(at[0], (x + 0.5) / 64, 1e-12);
                EXPECT_NEAR(at[1], (y + 0.5) / 32, 1e-12);
                EXPECT_GE(weights.minCoeff(), -1e-8);
            }
        }
    }
}

TEST(Raster, KeepsToTheImageAndLeavesOutWhatHasNoArea) {
    CornerUV uv(9, 2);
    uv << -1.0, -2.0, 3.0, -2.0, 0.5, 4.0, 0.2, 0.2, 0.8, 0.8, 0.5, 0.5, 5.0, 5.0, 6.0, 5.0, 5.0, 6.0;
    const TexelTriangle large(uv, 0, 16, 16), flat(uv, 1, 16, 16), outside(uv, 2, 16, 16);
    EXPECT_EQ(large.first_row(), 0);
    EXPECT_EQ(large.end_row(), 16);
    for (int y = 0; y < 16; ++y) {
        EXPECT_GE(large.span(y).from, 0);
        EXPECT_LE(large.span(y).to, 16);
        EXPECT_EQ(flat.span(y).to, flat.span(y).from);
    }
    EXPECT_GE(outside.first_row(), outside.end_row());
    const Bands bands = make_bands(uv, {1, 1, 1}, 16, 16);
    EXPECT_EQ(bands.count(), 1);
    EXPECT_EQ(bands.triangle, (std::vector<int>{0, 1}));
}

}  // namespace isograft
