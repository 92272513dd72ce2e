// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "isograft/bake.h"

namespace isograft {

/// Give every texel within `margin` of a baked or filled one the nearest of those (of equally near ones the first by
/// row, then by column), and mark it. Works on rows [first_row, end_row) and reads beyond them.
///
/// \param mask height by width of Texel. What it says of baked texels is read only, so bands may run at a time.
/// \param copy called with (from, to): indices of texels. O(texels x margin / width of gaps).
void dilate(std::uint8_t* mask, int width, int height, int margin, int first_row, int end_row,
            const std::function<void(std::size_t from, std::size_t to)>& copy);

}  // namespace isograft
