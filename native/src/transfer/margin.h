// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "isograft/bake.h"
#include "isograft/monitor.h"
#include "transfer/raster.h"

namespace isograft {

/// Give every texel within `margin` of a baked or filled one the nearest of those (of equally near ones the first by
/// row, then by column), and mark it. Works on rows [first_row, end_row) and reads beyond them.
///
/// \param mask height by width of Texel. What it says of baked texels is read only, so bands may run at a time.
/// \param copy called with (from, to): indices of texels. O(texels x margin / width of gaps).
void dilate(std::uint8_t* mask, int width, int height, int margin, int first_row, int end_row,
            const std::function<void(std::size_t from, std::size_t to)>& copy);

/// dilate() of all bands, side by side. \param options size, margin and threads. \throw Cancelled.
void dilate_bands(const Bands& bands, std::uint8_t* mask, const BakeOptions& options,
                  const std::function<void(std::size_t from, std::size_t to)>& copy, Monitor& monitor, double from,
                  double to);

/// Copy one texel of a channel's result, a BakeChannel's or a PaintChannel's, to another.
template <class Channel>
void copy_texel(const Channel& channel, int components, std::size_t from, std::size_t to) {
    const auto count = static_cast<std::size_t>(components);
    if (channel.reals != nullptr) {
        std::copy_n(channel.reals + from * count, count, channel.reals + to * count);
    } else {
        std::copy_n(channel.bytes + from * count, count, channel.bytes + to * count);
    }
}

}  // namespace isograft
