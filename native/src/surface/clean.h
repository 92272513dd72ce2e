// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/piece.h"
#include "isograft/surface.h"
#include "surface/edges.h"
#include "surface/mesh.h"

namespace isograft {

/// Triangles on their way through the gate. Corners are input vertices; where several were welded, the lowest of them.
struct Soup {
    /// All input vertices, used or not.
    std::vector<Eigen::Vector3d> position;
    std::vector<Corners> face;
    /// Per triangle the input's index, and how its corners stand to the input's (see TriangleMesh::input_order).
    std::vector<int> input_face;
    std::vector<char> input_order;
    std::vector<std::string> warnings;
};

/// \throw ResourceLimit if half-edges would not fit into 32-bit indices, or above 2^30 vertices.
void check_size(Eigen::Index vertices, Eigen::Index triangles);

/// \throw InvalidInput if a coordinate is not finite or the extent is beyond what areas and volumes can be computed
/// from.
void check_coordinates(const Points& vertices);

/// \throw InvalidInput if there is nothing, a coordinate is not finite, an index is out of range, or the extent is
/// beyond what areas and volumes can be computed from.
void check_arrays(const Points& vertices, const Triangles& faces);

/// Per vertex the lowest vertex at exactly the same place.
std::vector<int> find_places(const std::vector<Eigen::Vector3d>& position, Monitor& monitor);

/// Leave out what is no triangle, and weld what only its indexing keeps apart.
///
/// Left out: triangles with a repeated corner, without area (height below 1e-10 of the longest edge, or below what the
/// coordinates resolve), and those drawn twice, but not the walls of two bodies that touch. Welded: vertices at exactly
/// the same place, where that closes an edge of exactly two triangles (soups, seams) or a triangle left out had kept
/// them apart. Sheets that only touch in points, or at edges of more triangles, stay apart. O(#V log #V + #F).
/// \throw InvalidInput if no triangle is left; Cancelled if `progress` says so.
Soup clean(const Points& vertices, const Triangles& faces, Piece progress);

/// Per input vertex its vertex of the repaired mesh, -1 if no triangle of it uses the vertex. Of several copies the
/// one in the first triangle. Vertices that were welded share one.
std::vector<int> working_vertices(const Surface& surface);

}  // namespace isograft
