// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/piece.h"
#include "geodesic/surface_point.h"
#include "isograft/surface.h"

namespace isograft {

/// A mesh of even, moderate resolution to work on, and the way between it and the fine one.
///
/// Windows cost what they reach, and maps gain nothing from triangles far smaller than the sample spacing.
struct CoarseMesh {
    /// With paths.
    TriangleMesh mesh;
    /// Per coarse vertex the fine vertex it is. Empty if the fine mesh was coarse enough and `mesh` is the same.
    std::vector<int> fine_vertex;
    /// Per fine vertex its place on the coarse mesh. Empty as above.
    std::vector<SurfacePoint> place;
    /// Per coarse vertex the fine vertices whose nearest coarse vertex it is. Empty as above.
    std::vector<std::vector<int>> members;
};

/// A surface, and the coarse mesh its half of the pair works on.
struct Detail {
    Surface surface;
    /// Pair's units per unit of the surface.
    double factor = 1.0;
    /// In the pair's unit.
    CoarseMesh coarse;

    /// In the surface's own unit: a scaled copy of a million vertices would serve nothing but their places.
    [[nodiscard]] const TriangleMesh& fine() const { return surface.mesh(); }
};

/// Collapse short edges until about `edge` long ones are left; nothing is done to a mesh that has at most `slack` times
/// the vertices of equilateral triangles of that edge.
///
/// Vertices that stay keep their position, so that whatever is known of them stays true. Topology, boundaries and
/// orientation are kept. O(#V log #V).
CoarseMesh coarsen(const TriangleMesh& fine, double edge, Piece progress, double slack = 4.0 / 3.0);

/// coarsen() by way of a coarse mesh that is there already, so that the fine one is only looked up.
CoarseMesh coarsen_further(const TriangleMesh& fine, const CoarseMesh& coarse, double edge, Piece progress);

/// The point of the fine mesh at a point of the coarse one.
SurfacePoint to_fine(const Detail& detail, const SurfacePoint& point);

/// Values of fine vertices at the coarse ones.
std::vector<double> at_coarse(const CoarseMesh& coarse, const std::vector<double>& fine_values);

}  // namespace isograft
