// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "isograft/match.h"

namespace isograft {

/// match() by the paper's own steps and parameters (preset `paper`, PaperOptions), on checked options and landmarks.
///
/// What is ours: windows, traces and shots instead of smoothed Dijkstra paths; triangles instead of RIMLS; scale and
/// sides found as in every preset where they are not given; every vertex a surface point. The maps of the other
/// clusters that cover at least half as much as the chosen one come as alternatives.
Match match_by_paper(const Surface& source, const Surface& target, const MatchOptions& options, Monitor& monitor);

/// Radii of the isocontours (section 5.1), evenly spaced from r_min to r_max, in units of `diameter`: the geodesic
/// diameter of S, of which R is 5 %.
std::vector<double> contour_radii(const PaperOptions& paper, double diameter);

/// w_C of eq. 8, in one over the squared unit of `e0`, the mean edge length of S: 1 / (8 e0^2) as printed.
double stretch_weight(const PaperOptions& paper, double e0);

/// One over k_ds of eq. 10, in units of `e0`: 5 e1 as printed, e1 = 2 e0.
double merge_decay(const PaperOptions& paper, double e0);

}  // namespace isograft
