// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include <Eigen/Core>

#include "base/complex.h"
#include "surface/mesh.h"

namespace isograft {

/// A point of a mesh: a triangle and the weights of its corners (>= 0, sum 1).
struct SurfacePoint {
    int face = -1;
    std::array<double, 3> weight{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};
};

/// The point in space.
inline Eigen::Vector3d position(const TriangleMesh& mesh, const SurfacePoint& p) {
    const auto& f = mesh.face[p.face];
    return p.weight[0] * mesh.position[f[0]] + p.weight[1] * mesh.position[f[1]] + p.weight[2] * mesh.position[f[2]];
}

/// The point in its triangle's frame.
inline Complex planar(const TriangleMesh& mesh, const SurfacePoint& p) {
    const auto& c = mesh.corner[p.face];
    return p.weight[0] * c[0] + p.weight[1] * c[1] + p.weight[2] * c[2];
}

/// A planar vector of a triangle's frame in space, and the tangent part of a vector in space.
inline Eigen::Vector3d lift(const TriangleMesh& mesh, int face, Complex d) {
    return d.real() * mesh.axis_x[face] + d.imag() * mesh.axis_y[face];
}
inline Complex flatten(const TriangleMesh& mesh, int face, const Eigen::Vector3d& d) {
    return {d.dot(mesh.axis_x[face]), d.dot(mesh.axis_y[face])};
}

/// A tangent vector of one triangle turned into another's frame through space; keeps its length.
/// Meant for triangles that are near each other and nearly parallel.
Complex carry(const TriangleMesh& mesh, int from_face, int to_face, Complex d);

/// The surface point of `face` at planar position `q`, its weights kept off the edges by 1e-7 so that a trace from
/// it never starts on one.
SurfacePoint point_at(const TriangleMesh& mesh, int face, Complex q);

/// The surface point at vertex `v`, a hundredth of the way into the first of its triangles.
SurfacePoint point_near_vertex(const TriangleMesh& mesh, int v);

/// The corner of the point's triangle with the largest weight: a vertex of the mesh.
int nearest_corner(const TriangleMesh& mesh, const SurfacePoint& p);

}  // namespace isograft
