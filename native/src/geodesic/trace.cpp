// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/trace.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace isograft {

namespace {
// Below it a path is parallel to an edge, or leads away from it.
constexpr double least_slope = 1e-14;
}  // namespace

Walker::Walker(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction)
    : mesh_(&mesh), base_(3 * start.face), direction_(unit(direction)) {
    assert(mesh.has_paths());
    begin(planar(mesh, start));
}

Complex Walker::at(double length) const {
    return mesh_->corner[face()][base_ % 3] + (entry_ + length * direction_) * mesh_->direction[base_];
}

// In the first triangle any edge may be the one to leave through. Its frame is that of its first half-edge.
void Walker::begin(Complex start) {
    entry_ = start;
    const auto& corner = mesh_->corner[face()];
    double nearest = std::numeric_limits<double>::max();
    int leave = -1;
    for (int h = base_; h < base_ + 3; ++h) {
        const double slope = cross(direction_, mesh_->direction[h]);
        if (slope <= least_slope) continue;
        const double t = cross(corner[h - base_] - entry_, mesh_->direction[h]) / slope;
        if (t >= nearest) continue;
        nearest = t;
        leave = h;
    }
    if (leave < 0) return;
    inside_ = std::max(nearest, 0.0);
    next_ = mesh_->twin[leave];
    const Complex crossing = entry_ + inside_ * direction_ - corner[leave - base_];
    next_at_ = mesh_->view[leave].length - dot(crossing, mesh_->direction[leave]);
    next_direction_ = -direction_ * std::conj(mesh_->direction[leave]);
}

// The side on which the apex is passed says which of the two other edges is left through, and the rest is products and
// sums of what is not negative. At a vertex, along the edge on the left, the exit is the edge ahead.
void Walker::enter(int halfedge, double place, Complex heading) {
    const HalfedgeView& view = mesh_->view[halfedge];
    base_ = halfedge;
    place = std::clamp(place, 0.0, view.length);
    entry_ = place;
    // Upward, if only by a rounding.
    direction_ = {heading.real(), std::max(heading.imag(), 0.0)};
    const double side = cross(direction_, view.apex - place);
    const bool left = side > 0.0 || (side == 0.0 && place == 0.0);
    const double aside = std::abs(side);
    const double before = left ? view.length - place : place;
    const double reach = direction_.imag() * before;
    const double share = 1.0 / (aside + reach);
    inside_ = view.apex.imag() * before * share;
    // From the exit's end, where its twin begins, to its start.
    const Complex back = left ? view.length - view.apex : view.apex;
    next_ = view.beyond[left ? 0 : 1];
    if (next_ < 0) return;
    const double length = mesh_->view[next_].length;
    next_at_ = length * (left ? aside : reach) * share;
    next_direction_ = unit_again(direction_ * std::conj(back) * (1.0 / length));
}

bool Walker::advance() {
    if (next_ < 0) return false;
    travelled_ += inside_;
    enter(next_, next_at_, next_direction_);
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

SurfacePoint walked_to(const TriangleMesh& mesh, const SurfacePoint& start, const Eigen::Vector3d& x) {
    const Complex step = flatten(mesh, start.face, x - position(mesh, start));
    return std::abs(step) > 1e-12 ? trace(mesh, start, step, std::abs(step)).end : start;
}

}  // namespace isograft
