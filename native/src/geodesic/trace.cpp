// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/trace.h"

#include <algorithm>
#include <limits>

namespace isograft {

namespace {
// Below it a path is parallel to an edge, or enters through it.
constexpr double least_slope = 1e-14;
}  // namespace

Walker::Walker(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction)
    : mesh_(&mesh), face_(start.face), entry_(planar(mesh, start)), direction_(unit(direction)) {
    find_exit();
}

void Walker::find_exit() {
    const auto& corner = mesh_->corner[face_];
    if (entered_ >= 0) {
        // The side on which the far corner is passed says which of the two other edges is crossed.
        const int k = entered_ - 3 * face_;
        const int far = k == 0 ? 2 : k - 1;
        const int after = k == 2 ? 0 : k + 1;
        const int start = cross(direction_, corner[far] - entry_) > 0.0 ? after : far;
        const Complex edge = mesh_->direction[3 * face_ + start];
        const double slope = cross(direction_, edge);
        if (slope > least_slope) {
            exit_ = 3 * face_ + start;
            inside_ = std::max(cross(corner[start] - entry_, edge) / slope, 0.0);
            return;
        }
    }
    double nearest = std::numeric_limits<double>::max();
    exit_ = -1;
    for (int k = 0; k < 3; ++k) {
        const int h = 3 * face_ + k;
        if (h == entered_) continue;
        const Complex edge = mesh_->direction[h];
        const double slope = cross(direction_, edge);
        if (slope <= least_slope) continue;
        const double t = cross(corner[k] - entry_, edge) / slope;
        if (t < nearest) {
            nearest = t;
            exit_ = h;
        }
    }
    inside_ = exit_ < 0 ? 0.0 : std::max(nearest, 0.0);
}

bool Walker::advance() {
    if (exit_ < 0) return false;
    const int twin = mesh_->twin[exit_];
    if (twin < 0) return false;
    const Complex crossing = at(inside_) - mesh_->corner[face_][exit_ % 3];
    const double along = std::clamp(dot(crossing, mesh_->direction[exit_]), 0.0, mesh_->length[exit_]);
    travelled_ += inside_;
    direction_ = unit_again(direction_ * mesh_->rotation[exit_]);
    face_ = twin / 3;
    entered_ = twin;
    entry_ = mesh_->corner[face_][twin % 3] + (mesh_->length[twin] - along) * mesh_->direction[twin];
    find_exit();
    return true;
}

Trace trace(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction, double length) {
    Walker walker(mesh, start, direction);
    // Only a path that circles in slivers for ever gets near this many steps.
    constexpr int max_steps = 100000;
    Trace result;
    for (int step = 0; step < max_steps; ++step) {
        const double left = length - walker.travelled();
        if (walker.inside() >= left) {
            result.end = point_at(mesh, walker.face(), walker.at(left));
            result.length = length;
            result.complete = true;
            result.direction = walker.direction();
            return result;
        }
        if (!walker.advance()) break;
    }
    result.end = point_at(mesh, walker.face(), walker.at(walker.inside()));
    result.length = walker.travelled() + walker.inside();
    result.direction = walker.direction();
    return result;
}

}  // namespace isograft
