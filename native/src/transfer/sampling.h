// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "isograft/bake.h"

namespace isograft {

/// Most components an image may have.
constexpr int most_components = 4;

/// Read an image at a UV: bilinear between pixel centres, or the pixel under it.
/// \param values `components` numbers, of bytes in [0, 1].
void read_pixels(const Pixels& image, int components, Extension extension, bool closest, double u, double v,
                 float* values);

}  // namespace isograft
