// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/partial_map.h"
#include "hierarchy/vertex_levels.h"
#include "isograft/monitor.h"

namespace isograft {

/// A cluster's maps as one.
struct MergedMap {
    PartialMap map;
    /// Per source vertex the weighted mean distance of the maps' images from the merged one, in e0; 0 where one map
    /// alone speaks.
    std::vector<double> spread;
};

/// Eq. 10: every source vertex in the union of the maps' domains goes where the weighted sum of the distances to its
/// images is least, the weights exp(-d / decay) with d the way from the map's seed.
///
/// A sum of distances, as printed: the geometric median, though the paper's text calls it the Riemannian centre of
/// mass. It starts at the image nearest to all others and moves along the median of the logarithms, which come from a
/// window where images lie apart. Images that no path reaches do not count.
/// \param decay in mesh units; paper: 5 e1. \return equal bit for bit for any number of threads.
MergedMap merge_by_centroid(const VertexLevels& source, const TriangleMesh& target,
                            const std::vector<const PartialMap*>& maps, double decay, int threads, Monitor& monitor,
                            double from, double to);

}  // namespace isograft
