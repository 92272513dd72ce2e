// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "transfer_arrays.h"

namespace isograft::bindings {

using ByteArray = py::array_t<std::uint8_t, py::array::c_style>;

inline bool is_byte(const py::array& array) { return py::isinstance<ByteArray>(array); }

/// \throw InvalidInput unless `array` is an image of so many components.
inline void check_pixels(const py::array& array, int components) {
    if (array.ndim() == 3 && array.shape(2) == components &&
        (is_byte(array) || py::isinstance<py::array_t<float, py::array::c_style>>(array))) {
        return;
    }
    throw InvalidInput("images must be contiguous uint8 or float32 arrays of shape (height, width, components)");
}

/// Let `channel`, a BakeChannel or a PaintChannel, be written into `result`.
template <class Channel>
void set_result(const py::array& result, int width, int height, Channel& channel) {
    if (result.shape(0) != height || result.shape(1) != width) {
        throw InvalidInput("a result's shape is not that of the bake");
    }
    void* pixels = py::array(result).mutable_data();
    if (is_byte(result)) {
        channel.bytes = static_cast<std::uint8_t*>(pixels);
    } else {
        channel.reals = static_cast<float*>(pixels);
    }
}

inline void check_mask(const ByteArray& mask, int width, int height) {
    if (mask.ndim() == 2 && mask.shape(0) == height && mask.shape(1) == width) return;
    throw InvalidInput("the mask's shape is not that of the bake");
}

inline CornerUV to_corner_uv(const DoubleArray& array, const std::string& name) {
    const CornerValues uv = to_values(array, name);
    if (uv.cols() != 2) throw InvalidInput(name + " must have 2 columns");
    return uv;
}

}  // namespace isograft::bindings
