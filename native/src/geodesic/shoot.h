// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geodesic/trace.h"

namespace isograft {

/// A straightest geodesic between two points.
struct Shot {
    double length = 0.0;
    /// Unit direction at the start, in its triangle's frame.
    Complex departure{1.0, 0.0};
    /// Unit direction of travel at the end, in the end point's triangle's frame.
    Complex arrival{1.0, 0.0};
};

/// When a shot is good enough.
struct ShootOptions {
    int max_traces = 5;
    /// Stop once the end is missed by less than this share of the length.
    double tolerance = 0.02;
};

/// Find the straightest geodesic from `from` to `to` near a guess: trace, then turn and lengthen by the miss seen in
/// the tangent plane of the end, one to five times.
///
/// The path stays homotopic to the guess, so it is blind to shortcuts and welds that a shortest path would take.
/// \return nothing where a boundary is in the way or the end is missed by more than 15 % of the length.
std::optional<Shot> shoot(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to, Complex direction,
                          double length, const ShootOptions& options = {});

}  // namespace isograft
