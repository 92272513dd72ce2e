// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/surface_point.h"

#include <algorithm>

namespace isograft {

Complex carry(const TriangleMesh& mesh, int from_face, int to_face, Complex d) {
    if (from_face == to_face) return d;
    return unit(flatten(mesh, to_face, lift(mesh, from_face, d))) * modulus(d);
}

SurfacePoint point_at(const TriangleMesh& mesh, int face, Complex q) {
    constexpr double inset = 1e-7;
    const auto& c = mesh.corner[face];
    const double area = cross(c[1], c[2]);
    SurfacePoint p;
    p.face = face;
    p.weight[1] = cross(q, c[2]) / area;
    p.weight[2] = cross(c[1], q) / area;
    p.weight[0] = 1.0 - p.weight[1] - p.weight[2];
    double sum = 0.0;
    for (double& w : p.weight) {
        if (!(w > inset)) w = inset;  // also catches NaN from slivers
        sum += w;
    }
    for (double& w : p.weight) w /= sum;
    return p;
}

SurfacePoint point_near_vertex(const TriangleMesh& mesh, int v) {
    SurfacePoint p;
    p.face = mesh.vertex_face[mesh.vertex_face_begin[v]];
    for (int k = 0; k < 3; ++k) p.weight[k] = mesh.face[p.face][k] == v ? 0.98 : 0.01;
    return p;
}

int nearest_corner(const TriangleMesh& mesh, const SurfacePoint& p) {
    const auto largest = std::max_element(p.weight.begin(), p.weight.end());
    return mesh.face[p.face][largest - p.weight.begin()];
}

}  // namespace isograft
