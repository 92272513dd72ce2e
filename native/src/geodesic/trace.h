// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "geodesic/surface_point.h"

namespace isograft {

/// Where a straightest geodesic ended.
struct Trace {
    SurfacePoint end;
    /// Unit direction of travel at the end, in the end triangle's frame.
    Complex direction{1.0, 0.0};
    /// Length walked; less than asked for where a boundary was hit.
    double length = 0.0;
    /// The whole length was walked.
    bool complete = false;
};

/// Walk straight over the mesh: across every edge the path goes on at the same angle (Polthier and Schmies 1998).
///
/// \param direction in the start triangle's frame, any length but 0. \param length >= 0, in mesh units.
/// O(triangles crossed). What growth carries directions along with (paper section 4.3).
Trace trace(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction, double length);

/// The point of the surface at `x`, which lies near it, as a mean of points on it does, reached straight from `start`
/// near `x`. The boundary is not crossed.
SurfacePoint walked_to(const TriangleMesh& mesh, const SurfacePoint& start, const Eigen::Vector3d& x);

/// A straight walk, triangle by triangle, for callers that sample along the way.
///
/// In each triangle the edge that was entered through lies along the real axis. Directions turn from frame to frame and
/// places are found anew on every edge, so that one sliver does not scale up the rounding of another.
class Walker {
  public:
    Walker(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction);

    /// Length walked up to where the current triangle was entered.
    [[nodiscard]] double travelled() const { return travelled_; }
    /// Length left inside the current triangle.
    [[nodiscard]] double inside() const { return inside_; }
    [[nodiscard]] int face() const { return base_ / 3; }
    /// In the current triangle's frame.
    [[nodiscard]] Complex direction() const { return direction_ * mesh_->direction[base_]; }
    /// The planar point `length` further inside the current triangle.
    [[nodiscard]] Complex at(double length) const;
    /// Step into the next triangle. \return false at a boundary; the walker then stays where it is.
    bool advance();

  private:
    void begin(Complex start);
    void enter(int halfedge, double place, Complex heading);

    const TriangleMesh* mesh_;
    /// The half-edge entered through, the first of its triangle at the start.
    int base_;
    /// In its frame.
    Complex entry_;
    Complex direction_;
    /// The half-edge on the other side of the one that the path leaves through, where on it, and the direction there.
    int next_ = -1;
    double next_at_ = 0.0;
    Complex next_direction_;
    double travelled_ = 0.0;
    double inside_ = 0.0;
};

}  // namespace isograft
