// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/metric_fit.h"
#include "hierarchy/vertex_levels.h"
#include "isograft/monitor.h"
#include "seed/oriented_match.h"

namespace isograft {

/// Options of flood().
struct FloodOptions {
    /// nu in e0: the largest |d_T - d_S| against any mapped vertex of N1.
    double stretch_limit = 0.5;
    MetricFitOptions fit;
};

/// Grow one partial map as the paper does (section 4.3): vertex after vertex in geodesic order from the seed, across
/// mesh edges from the boundary of U.
///
/// A new vertex is predicted from every mapped vertex of N1: the path between them on S is walked on T from its image,
/// turned by its angle. The vertex goes to the mean of the points reached, all of equal weight, if its distance on T to
/// the image of each of them respects eq. 5, and if nothing from beyond N1 lies within e0 of it. Whenever the area of U
/// has doubled, fit_metric() runs over the hierarchy's edges inside U. `seed_distance` of the map is the way from the
/// seed inside U.
/// \param match its sample is a vertex. O(#U (|N1| traces + least squares)).
PartialMap flood(const VertexLevels& source, const TriangleMesh& target, const OrientedMatch& match,
                 const FloodOptions& options, Monitor& monitor);

/// Maps of the first matches in their order, in which redundant ones move back.
struct Floods {
    std::vector<PartialMap> maps;
    /// Matches that were grown. Maps that end before they fill a cell of the top level (at most a tenth of S) have
    /// met a mismatch at once and are not kept: small ones would agree with each other wherever they lie.
    int tried = 0;
    int redundant = 0;
};

/// flood() the matches in order until `most` were tried.
///
/// A match is redundant if a map takes the same vertex to the same place (within e1) under the same angle (within 30
/// degrees): it would only be grown again (section 3.3). The paper increases its priority, so it is tried after all
/// matches of clusters, which have a finite score, and before those of none: the maps that many matches lead to are
/// then many, and the linkage sees them as a dense group.
/// \return equal bit for bit for any number of threads.
Floods flood_all(const VertexLevels& source, const TriangleMesh& target, const std::vector<OrientedMatch>& matches,
                 int most, const FloodOptions& options, int threads, Monitor& monitor, double from, double to);

}  // namespace isograft
