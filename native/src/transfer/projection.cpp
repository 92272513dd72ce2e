// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/projection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Triangles within this many radii of a receiver triangle's image are looked at where the walk fails.
constexpr double reach = 1.5;
// A walk this long has lost its way.
constexpr int longest_walk = 256;
// A weight this far below 0 is rounding.
constexpr double on_edge = 1e-9;
// The surface lies within this of the flat image of a triangle, in its longest edge.
constexpr double farthest = 0.75;
// Directions closer to a triangle's plane than this (sine) do not meet it anywhere useful.
constexpr double grazing = 1e-3;

}  // namespace

Points image_normals(const ReceiverImages& receiver) {
    const Triangles& faces = receiver.receiver.faces;
    Points normals = Points::Zero(receiver.receiver.vertices.rows(), 3);
    for (int f = 0; f < faces.rows(); ++f) {
        if (receiver.extent[f] == infinity) continue;
        const Vector3d a = receiver.corner(f, 0).point;
        const Vector3d normal = (receiver.corner(f, 1).point - a).cross(receiver.corner(f, 2).point - a);
        for (int c = 0; c < 3; ++c) normals.row(faces(f, c)) += normal.transpose();
    }
    for (Eigen::Index v = 0; v < normals.rows(); ++v) normals.row(v) = normals.row(v).stableNormalized();
    return normals;
}

Projection::Projection(const DonorView& donor, const ReceiverImages& receiver, const Points& normals)
    : donor_(donor), receiver_(receiver), normals_(normals), around_(donor) {}

void Projection::enter(int triangle) {
    triangle_ = triangle;
    last_ = -1;
    gathered_ = false;
    farthest_ = farthest * receiver_.extent[triangle] + donor_.same_point;
    for (int c = 0; c < 3; ++c) {
        corner_[c] = &receiver_.corner(triangle, c);
        normal_[c] = normals_.row(receiver_.receiver.faces(triangle, c)).transpose();
    }
}

Place Projection::find(const Vector3d& weights) {
    const Vector3d p = weights[0] * corner_[0]->point + weights[1] * corner_[1]->point + weights[2] * corner_[2]->point;
    const Vector3d direction = weights[0] * normal_[0] + weights[1] * normal_[1] + weights[2] * normal_[2];
    if (last_ < 0) {
        int heaviest = 0;
        weights.maxCoeff(&heaviest);
        last_ = corner_[heaviest]->face;
    }
    Place place;
    if (!walk(p, direction, last_, place)) place = nearest(p);
    last_ = place.face;
    return place;
}

bool Projection::walk(const Vector3d& p, const Vector3d& direction, int from, Place& place) const {
    const auto& next = donor_.graph.next;
    const double length = direction.norm();
    if (length < 0.1) return false;
    int f = from, before = -1;
    for (int step = 0; step < longest_walk; ++step) {
        const Vector3d a = donor_.corner(f, 0);
        const Vector3d e1 = donor_.corner(f, 1) - a, e2 = donor_.corner(f, 2) - a, s = p - a;
        const Vector3d normal = e1.cross(e2);
        const double facing = normal.dot(direction);
        if (std::abs(facing) <= grazing * length * normal.norm()) return false;
        Vector3d w;
        w[1] = s.cross(e2).dot(direction) / facing;
        w[2] = e1.cross(s).dot(direction) / facing;
        w[0] = 1.0 - w[1] - w[2];
        if (w.minCoeff() >= -on_edge) {
            if (std::abs(s.dot(normal) / facing) * length > farthest_) return false;
            place.face = f;
            place.weights = w.cwiseMax(0.0);
            place.weights /= place.weights.sum();
            return true;
        }
        // Across the edge that the point lies farthest beyond, unless that leads back or nowhere.
        int order[3] = {0, 1, 2};
        std::sort(order, order + 3, [&](int i, int j) { return w[i] < w[j] || (w[i] == w[j] && i < j); });
        int to = -1;
        for (const int c : order) {
            if (w[c] >= -on_edge) break;
            const int h = 3 * f + (c + 1) % 3;
            for (int g = next[h]; g != h && to < 0; g = next[g]) {
                if (g / 3 != before) to = g / 3;
            }
            if (to >= 0) break;
        }
        if (to < 0) return false;
        before = f;
        f = to;
    }
    return false;
}

Place Projection::nearest(const Vector3d& p) {
    if (!gathered_) {
        const Vector3d centre = (corner_[0]->point + corner_[1]->point + corner_[2]->point) / 3.0;
        double radius = 0.0;
        int seeds[3];
        for (int c = 0; c < 3; ++c) {
            radius = std::max(radius, (corner_[c]->point - centre).norm());
            seeds[c] = corner_[c]->face;
        }
        near_ = around_.gather(seeds, 3, centre, reach * radius + donor_.same_point);
        if (near_.empty()) near_.assign(seeds, seeds + 3);
        gathered_ = true;
    }
    Place best;
    double least = infinity;
    for (const int f : near_) {
        const Vector3d weights = donor_.closest(f, p);
        const double distance = (donor_.point(f, weights) - p).squaredNorm();
        if (distance > least || (distance == least && f > best.face)) continue;
        least = distance;
        best = {f, weights};
    }
    return best;
}

}  // namespace isograft
