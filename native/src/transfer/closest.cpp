// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/closest.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>

namespace isograft {

using Eigen::Vector3d;

namespace {

// Triangles whose height is below this share of their longest edge have no plane to speak of.
constexpr double flat_height = 1e-10;

}  // namespace

double closest_parameter(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d ab = b - a;
    const double length = ab.squaredNorm();
    return length > 0.0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0.0;
}

Vector3d plane_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const Vector3d normal = (b - a).cross(c - a);
    const double area = normal.squaredNorm();
    const double v = (p - a).cross(c - a).dot(normal) / area;
    const double w = (b - a).cross(p - a).dot(normal) / area;
    return {1.0 - v - w, v, w};
}

Vector3d closest_weights(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if ((b - a).cross(c - a).squaredNorm() > flat_height * flat_height * longest * longest) {
        const Vector3d inside = plane_weights(p, a, b, c);
        if (inside.minCoeff() >= 0.0) return inside;
    }
    const Vector3d* corner[3] = {&a, &b, &c};
    Vector3d best = Vector3d::UnitX();
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const Vector3d& from = *corner[i];
        const Vector3d& to = *corner[(i + 1) % 3];
        const double t = closest_parameter(p, from, to);
        const double distance = (from + t * (to - from) - p).squaredNorm();
        if (distance >= nearest) continue;
        nearest = distance;
        best.setZero();
        best[i] = 1.0 - t;
        best[(i + 1) % 3] = t;
    }
    return best;
}

}  // namespace isograft
