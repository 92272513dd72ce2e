// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/sampling.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace isograft {

namespace {

// A pixel's coordinate within the image; -1 = nothing there.
int within(double floor, int size, Extension extension) {
    if (extension == Extension::repeat) {
        const double turned = floor - size * std::floor(floor / size);
        return std::min(static_cast<int>(turned), size - 1);
    }
    if (floor >= 0.0 && floor < size) return static_cast<int>(floor);
    if (extension == Extension::clip) return -1;
    return floor < 0.0 ? 0 : size - 1;
}

void add_pixel(const Pixels& image, int components, int x, int y, float weight, float* values) {
    if (x < 0 || y < 0 || weight == 0.0F) return;
    const std::size_t at = (static_cast<std::size_t>(y) * image.width + x) * components;
    if (image.reals != nullptr) {
        for (int k = 0; k < components; ++k) values[k] += weight * image.reals[at + k];
    } else {
        const float scaled = weight / 255.0F;
        for (int k = 0; k < components; ++k) values[k] += scaled * image.bytes[at + k];
    }
}

}  // namespace

void read_pixels(const Pixels& image, int components, Extension extension, bool closest, double u, double v,
                 float* values) {
    std::fill(values, values + components, 0.0F);
    if (image.width == 1 && image.height == 1) {
        add_pixel(image, components, 0, 0, 1.0F, values);
        return;
    }
    const double x = u * image.width, y = v * image.height;
    if (closest) {
        add_pixel(image, components, within(std::floor(x), image.width, extension),
                  within(std::floor(y), image.height, extension), 1.0F, values);
        return;
    }
    const double left = std::floor(x - 0.5), low = std::floor(y - 0.5);
    const auto right_share = static_cast<float>(x - 0.5 - left), high_share = static_cast<float>(y - 0.5 - low);
    for (int j = 0; j < 2; ++j) {
        const int row = within(low + j, image.height, extension);
        const float share = j == 0 ? 1.0F - high_share : high_share;
        for (int i = 0; i < 2; ++i) {
            const int column = within(left + i, image.width, extension);
            add_pixel(image, components, column, row, share * (i == 0 ? 1.0F - right_share : right_share), values);
        }
    }
}

}  // namespace isograft
