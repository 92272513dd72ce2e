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

/// One step of a walk through triangles, for callers that sample along the way.
class Walker {
  public:
    Walker(const TriangleMesh& mesh, const SurfacePoint& start, Complex direction);

    /// Length walked up to where the current triangle was entered.
    [[nodiscard]] double travelled() const { return travelled_; }
    /// Length left inside the current triangle.
    [[nodiscard]] double inside() const { return inside_; }
    [[nodiscard]] int face() const { return face_; }
    [[nodiscard]] Complex direction() const { return direction_; }
    /// The planar point `length` further inside the current triangle.
    [[nodiscard]] Complex at(double length) const { return entry_ + length * direction_; }
    /// Step into the next triangle. \return false at a boundary; the walker then stays where it is.
    bool advance();

  private:
    void find_exit();

    const TriangleMesh* mesh_;
    int face_;
    int entered_ = -1;
    int exit_ = -1;
    Complex entry_;
    Complex direction_;
    double travelled_ = 0.0;
    double inside_ = 0.0;
};

}  // namespace isograft
