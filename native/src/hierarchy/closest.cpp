// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/closest.h"

#include <algorithm>
#include <limits>

namespace isograft {

SurfacePoint closest_in_face(const TriangleMesh& mesh, int face, const Eigen::Vector3d& x) {
    const auto& c = mesh.corner[face];
    const Complex q = flatten(mesh, face, x - mesh.position[mesh.face[face][0]]);
    const double area = cross(c[1], c[2]);
    const double w1 = cross(q, c[2]) / area;
    const double w2 = cross(c[1], q) / area;
    if (w1 >= 0.0 && w2 >= 0.0 && w1 + w2 <= 1.0) return point_at(mesh, face, q);
    Complex best = c[0];
    double best_distance = std::numeric_limits<double>::max();
    for (int k = 0; k < 3; ++k) {
        const Complex edge = c[(k + 1) % 3] - c[k];
        const double along = std::clamp(dot(q - c[k], edge) / std::max(std::norm(edge), 1e-300), 0.0, 1.0);
        const Complex foot = c[k] + along * edge;
        if (std::norm(q - foot) < best_distance) {
            best_distance = std::norm(q - foot);
            best = foot;
        }
    }
    return point_at(mesh, face, best);
}

SurfacePoint closest_from(const TriangleMesh& mesh, int start, const Eigen::Vector3d& x) {
    SurfacePoint best;
    double best_distance = std::numeric_limits<double>::max();
    const auto consider_around = [&](int vertex) {
        bool nearer = false;
        for (int i = mesh.vertex_face_begin[vertex]; i < mesh.vertex_face_begin[vertex + 1]; ++i) {
            const SurfacePoint p = closest_in_face(mesh, mesh.vertex_face[i], x);
            const double d = (position(mesh, p) - x).squaredNorm();
            if (d < best_distance) {
                best_distance = d;
                best = p;
                nearer = true;
            }
        }
        return nearer;
    };
    consider_around(start);
    for (bool nearer = true; nearer;) {
        const auto corners = mesh.face[best.face];
        nearer = false;
        for (const int v : corners) nearer = consider_around(v) || nearer;
    }
    return best;
}

}  // namespace isograft
