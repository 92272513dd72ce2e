// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "hierarchy/samples.h"

namespace isograft {

/// The paper's topology hierarchy (section 4.1): level 0 is the vertices and edges of a mesh.
struct VertexLevels {
    /// Sample i is vertex i, `spacing` is e0, the mean edge length. Level 0 has the mesh's edges; above it each level
    /// is an evenly spaced subset of the one below with twice its spacing, joined where Voronoi cells touch.
    Samples samples;
    /// N1 of section 4.3: vertices no farther from each other than near_reach(), along a straight geodesic, and
    /// those that share an edge.
    std::vector<SampleEdge> near;
    /// Per vertex the indices into `near`.
    std::vector<std::vector<int>> near_of;

    /// e_j = 2^j e0.
    [[nodiscard]] double spacing(int level) const { return samples.spacing * static_cast<double>(1 << level); }
    /// How far N1 reaches, in e1.
    double near_spacings = 1.0;
    [[nodiscard]] double near_reach() const { return near_spacings * spacing(1); }
};

/// Build the hierarchy of a mesh.
///
/// Edges hold straight geodesics; one that is bent by a boundary or by strong curvature is left out above level 0.
/// O(#V levels) windows of about a dozen vertices of their level each.
/// \return equal bit for bit for any number of threads. \throw Cancelled if `monitor` asks for it.
/// \param near how far N1 reaches, in e1.
VertexLevels make_vertex_levels(const TriangleMesh& mesh, int levels, int threads, Monitor& monitor, double from,
                                double to, double near = 1.0);

}  // namespace isograft
