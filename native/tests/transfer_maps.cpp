// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer_maps.h"

#include <limits>

namespace isograft::maps {

Correspondence identity(const shapes::Shape& shape) {
    const int count = static_cast<int>(shape.vertices.rows());
    Correspondence map;
    map.face = Eigen::VectorXi::Constant(count, -1);
    map.barycentric = Points::Constant(count, 3, std::numeric_limits<double>::quiet_NaN());
    map.vertex = map.face;
    for (int f = 0; f < shape.faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) {
            const int v = shape.faces(f, c);
            map.face[v] = f;
            map.vertex[v] = v;
            map.barycentric.row(v) = Eigen::Matrix3d::Identity().row(c);
        }
    }
    return map;
}

Correspondence to_renumbered(const shapes::Shape& shape, const shapes::Renumbered& renumbered) {
    const Correspondence onto_itself = identity(renumbered.shape);
    Correspondence map = identity(shape);
    for (int v = 0; v < shape.vertices.rows(); ++v) {
        const int other = renumbered.vertex[v];
        map.face[v] = onto_itself.face[other];
        map.barycentric.row(v) = onto_itself.barycentric.row(other);
        map.vertex[v] = other;
    }
    return map;
}

}  // namespace isograft::maps
