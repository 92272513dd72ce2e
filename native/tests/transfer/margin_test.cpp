// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/margin.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"

namespace isograft {

TEST(Margin, TakesTheNearestBakedTexelHoweverTheRowsAreSplit) {
    const int width = 37, height = 29, margin = 5;
    Random random(8);
    std::vector<std::uint8_t> start(width * height, 0);
    for (auto& texel : start) texel = random.uniform() < 0.02 ? 1 : 0;
    std::vector<std::size_t> first;
    for (const int rows : {height, 7, 1}) {
        std::vector<std::uint8_t> mask = start;
        std::vector<std::size_t> source(mask.size(), mask.size());
        for (int y = 0; y < height; y += rows) {
            dilate(mask.data(), width, height, margin, y, std::min(height, y + rows),
                   [&](std::size_t from, std::size_t to) { source[to] = from; });
        }
        if (first.empty()) first = source;
        EXPECT_EQ(source, first) << rows << " rows a band";
        for (int i = 0; i < width * height; ++i) {
            long least = -1;
            for (int j = 0; j < width * height; ++j) {
                const long dx = i % width - j % width, dy = i / width - j / width;
                if (start[j] == 1 && (least < 0 || dx * dx + dy * dy < least)) least = dx * dx + dy * dy;
            }
            const bool filled = start[i] == 0 && least <= margin * margin;
            EXPECT_EQ(mask[i], start[i] == 1 ? 1 : filled ? 2 : 0);
            if (!filled) continue;
            const long from = static_cast<long>(source[i]);
            const long dx = i % width - from % width, dy = i / width - from / width;
            EXPECT_EQ(dx * dx + dy * dy, least);
            EXPECT_EQ(start[from], 1);
        }
    }
}

}  // namespace isograft
