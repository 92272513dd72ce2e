// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "isograft/transfer.h"

namespace isograft {

/// Tangent frames of a UV map, as normal maps are read in.
struct TangentFrames {
    /// 3 #F by 3: unit vectors along growing u, at right angles to the vertex's normal; 0 where there is no direction.
    Points tangent;
    /// #F: 1, or -1 where the UVs are mirrored against the winding.
    std::vector<signed char> handedness;
};

/// Corners at one vertex that are joined by edges without a seam between triangles of one handedness share a tangent:
/// the mean of their triangles' by angle (as MikkTSpace has it). O(#F log #F).
TangentFrames tangent_frames(const Points& vertices, const Triangles& faces, const CornerUV& uv);

/// #V by 3: unit normals of the triangles around every vertex by area; 0 without an area.
Points vertex_normals(const Points& vertices, const Triangles& faces);

}  // namespace isograft
