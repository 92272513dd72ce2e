// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/clean.h"
#include "surface/edges.h"

namespace isograft {

/// What tells a component's outer side.
struct ComponentSide {
    double area = 0.0;
    /// Signed, about a point of the component itself; positive if the normals point outward.
    double volume = 0.0;
    /// The same about the component's centroid, which an open component has too: clearly positive where it bulges
    /// towards the side it shows, whatever is missing of it.
    double bulge = 0.0;
    /// The triangles bound a volume: they run along every edge equally often both ways, and the volume is not zero.
    bool closed = true;
};

/// Make the winding consistent within every component, turn closed components outward and let open ones keep the
/// winding of the larger part of their area. One-sided components are left inconsistent at the edges to be cut.
/// \throw Cancelled if `progress` says so.
void orient(Soup& soup, Piece progress);

/// Area, volume and closedness of every component.
/// \param component #F: in [0, count).
std::vector<ComponentSide> component_sides(const std::vector<Eigen::Vector3d>& position,
                                           const std::vector<Corners>& face, const std::vector<int>& component,
                                           int count, Monitor& monitor);

}  // namespace isograft
