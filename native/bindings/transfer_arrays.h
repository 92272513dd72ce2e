// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "bindings.h"
#include "isograft/transfer.h"

namespace isograft::bindings {

/// The arrays of a correspondence that every transfer reads; lengths are checked behind the interface.
inline Correspondence to_correspondence(const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex) {
    Correspondence correspondence;
    correspondence.face = Eigen::Map<const Eigen::VectorXi>(face.data(), face.size());
    correspondence.barycentric = to_points(barycentric, "barycentric");
    correspondence.vertex = Eigen::Map<const Eigen::VectorXi>(vertex.data(), vertex.size());
    return correspondence;
}

/// Rows and columns of a two-dimensional array. \throw InvalidInput naming `name`.
inline CornerValues to_values(const DoubleArray& array, const std::string& name) {
    if (array.ndim() != 2) {
        throw InvalidInput(name + " must have two dimensions, got " + std::to_string(array.ndim()));
    }
    return Eigen::Map<const CornerValues>(array.data(), array.shape(0), array.shape(1));
}

inline Eigen::VectorXi to_int_vector(const IntArray& array) {
    return Eigen::Map<const Eigen::VectorXi>(array.data(), array.size());
}

inline py::array_t<bool> to_mask(const Mask& mask) { return to_numpy(mask.matrix()); }

}  // namespace isograft::bindings
