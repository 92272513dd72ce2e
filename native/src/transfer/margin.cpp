// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/margin.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/parallel.h"

namespace isograft {

namespace {

constexpr auto baked = static_cast<std::uint8_t>(Texel::baked);
constexpr auto filled = static_cast<std::uint8_t>(Texel::filled);
// Other bands may be marking margins in the rows that this one reads.
std::uint8_t load(std::uint8_t& texel) { return std::atomic_ref(texel).load(std::memory_order_relaxed); }
void store(std::uint8_t& texel, Texel value) {
    std::atomic_ref(texel).store(static_cast<std::uint8_t>(value), std::memory_order_relaxed);
}

constexpr int none = std::numeric_limits<int>::max();

}  // namespace

void dilate(std::uint8_t* mask, int width, int height, int margin, int first_row, int end_row,
            const std::function<void(std::size_t from, std::size_t to)>& copy) {
    if (margin <= 0) return;
    const auto is_baked = [&](int y, int x) {
        const std::uint8_t texel = load(mask[static_cast<std::size_t>(y) * width + x]);
        return texel == baked || texel == filled;
    };
    // Per texel of the band the row of the nearest baked texel in its own column.
    const int rows = end_row - first_row;
    std::vector<int> nearest_row(static_cast<std::size_t>(rows) * width, none);
    const auto slot = [&](int y, int x) -> int& {
        return nearest_row[static_cast<std::size_t>(y - first_row) * width + x];
    };
    std::vector<int> last(width, none);
    for (int y = std::max(0, first_row - margin); y < end_row; ++y) {
        for (int x = 0; x < width; ++x) {
            if (is_baked(y, x)) last[x] = y;
            if (y >= first_row && last[x] != none && y - last[x] <= margin) slot(y, x) = last[x];
        }
    }
    std::fill(last.begin(), last.end(), none);
    for (int y = std::min(height, end_row + margin) - 1; y >= first_row; --y) {
        for (int x = 0; x < width; ++x) {
            if (is_baked(y, x)) last[x] = y;
            if (y >= end_row || last[x] == none || last[x] - y > margin) continue;
            int& found = slot(y, x);
            if (found == none || last[x] - y < y - found) found = last[x];
        }
    }
    for (int y = first_row; y < end_row; ++y) {
        for (int x = 0; x < width; ++x) {
            if (is_baked(y, x)) continue;
            long least = static_cast<long>(margin) * margin + 1;
            int from_row = none, from_column = none;
            for (int column = std::max(0, x - margin); column <= std::min(width - 1, x + margin); ++column) {
                const int row = slot(y, column);
                if (row == none) continue;
                const long across = column - x, along = row - y;
                const long distance = across * across + along * along;
                const bool earlier = distance == least && (row < from_row || (row == from_row && column < from_column));
                if (distance > least || (distance == least && !earlier)) continue;
                if (distance > static_cast<long>(margin) * margin) continue;
                least = distance;
                from_row = row;
                from_column = column;
            }
            if (from_row == none) continue;
            const std::size_t to = static_cast<std::size_t>(y) * width + x;
            store(mask[to], Texel::margin);
            copy(static_cast<std::size_t>(from_row) * width + from_column, to);
        }
    }
}

void dilate_bands(const Bands& bands, std::uint8_t* mask, const BakeOptions& options,
                  const std::function<void(std::size_t from, std::size_t to)>& copy, Monitor& monitor, double from,
                  double to) {
    const auto spread = [&](int band, int /*worker*/) {
        const int first_row = band * bands.rows;
        dilate(mask, options.width, options.height, options.margin, first_row,
               std::min(options.height, first_row + bands.rows), copy);
    };
    parallel_for(bands.count(), options.threads, spread, monitor, "margin", from, to);
}

}  // namespace isograft
