// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "isograft/monitor.h"
#include "surface/local_delaunay.h"

namespace isograft {

/// A manifold triangulation of sites: triangles that most of their corners see come first, and one that overlaps an
/// accepted one at a corner is left out; small gaps that this leaves are closed, holes of the data stay open.
///
/// Every edge has at most two triangles that run along it in opposite ways, every site one fan.
/// \param seen from local_delaunay(). \param largest the circumradius beyond which a gap is a hole, in local spacings.
std::vector<Corners> triangulate(const SurfaceSites& sites, std::vector<SeenTriangle> seen, double largest,
                                 Monitor& monitor);

}  // namespace isograft
