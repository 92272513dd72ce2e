// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "isograft/bake.h"
#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// Values to paint, and the image that they are painted into.
struct PaintChannel {
    /// 3 #F by components, in the units of the image: 0 to 255 for 8 bits.
    CornerValues values;
    /// height by width by components. One of the two is set. Not owned.
    std::uint8_t* bytes = nullptr;
    float* reals = nullptr;
};

/// Paint values of corners into triangles of a UV layout, where bake() has left nothing.
///
/// Texels whose centre lies in a wanted triangle and that the mask calls Texel::nothing get the linear mean of its
/// corners' values and become Texel::filled; where triangles overlap the first has the texel. Then the margin, around
/// what is baked and what is filled. O(texels + #F).
/// \param uv 3 #F by 2. \param wanted #F. \param mask height by width of Texel, as of a bake() without a margin.
/// \param monitor may be null. \throw InvalidInput on sizes or values that do not fit; Cancelled, with some texels
/// written.
void paint(const CornerUV& uv, const Mask& wanted, const std::vector<PaintChannel>& channels,
           const BakeOptions& options, std::uint8_t* mask, Monitor* monitor = nullptr);

}  // namespace isograft
