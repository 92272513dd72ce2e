// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/tangents.h"

#include <cmath>

#include <Eigen/Geometry>

#include "transfer/seams.h"

namespace isograft {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr double same_uv = 1e-7;

// Direction of growing u in a triangle, not of unit length; 0 where the UVs have no area. Its handedness in `sign`.
Vector3d direction_of_u(const Vector3d corner[3], const Vector2d uv[3], signed char& sign) {
    const Vector2d p = uv[1] - uv[0], q = uv[2] - uv[0];
    const double area = p[0] * q[1] - p[1] * q[0];
    sign = area < 0.0 ? -1 : 1;
    if (area == 0.0) return Vector3d::Zero();
    return sign * ((corner[1] - corner[0]) * q[1] - (corner[2] - corner[0]) * p[1]);
}

double angle_at(const Vector3d corner[3], int c) {
    const Vector3d a = corner[(c + 1) % 3] - corner[c], b = corner[(c + 2) % 3] - corner[c];
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Points vertex_normals(const Points& vertices, const Triangles& faces) {
    Points normals = Points::Zero(vertices.rows(), 3);
    for (int f = 0; f < faces.rows(); ++f) {
        const Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
        const Vector3d normal = (b - a).cross(c - a);
        for (int k = 0; k < 3; ++k) normals.row(faces(f, k)) += normal.transpose();
    }
    for (Eigen::Index v = 0; v < normals.rows(); ++v) normals.row(v) = normals.row(v).stableNormalized();
    return normals;
}

TangentFrames tangent_frames(const Points& vertices, const Triangles& faces, const CornerUV& uv) {
    const Triangles welded = weld(vertices, faces);
    const CornerValues values = uv;
    const SeamGraph graph = build_seam_graph(welded, values, same_uv);
    const Points normals = vertex_normals(vertices, welded);
    TangentFrames frames;
    frames.tangent = Points::Zero(3 * faces.rows(), 3);
    frames.handedness.resize(faces.rows());
    Points along(faces.rows(), 3);
    for (int f = 0; f < faces.rows(); ++f) {
        Vector3d corner[3];
        Vector2d at[3];
        for (int c = 0; c < 3; ++c) {
            corner[c] = vertices.row(faces(f, c)).transpose();
            at[c] = uv.row(3 * f + c).transpose();
        }
        along.row(f) = direction_of_u(corner, at, frames.handedness[f]).transpose();
    }
    const auto alike = [&](int f, int g) { return frames.handedness[f] == frames.handedness[g]; };
    const Eigen::VectorXi group = group_corners(graph, welded, alike);
    Points sum = Points::Zero(frames.tangent.rows(), 3);
    for (int f = 0; f < faces.rows(); ++f) {
        Vector3d corner[3];
        for (int c = 0; c < 3; ++c) corner[c] = vertices.row(faces(f, c)).transpose();
        for (int c = 0; c < 3; ++c) {
            const Vector3d normal = normals.row(welded(f, c)).transpose();
            const Vector3d u = along.row(f).transpose();
            const Vector3d flat = (u - u.dot(normal) * normal).stableNormalized();
            sum.row(group[3 * f + c]) += angle_at(corner, c) * flat.transpose();
        }
    }
    for (int i = 0; i < sum.rows(); ++i) frames.tangent.row(i) = sum.row(group[i]).stableNormalized();
    return frames;
}

}  // namespace isograft
