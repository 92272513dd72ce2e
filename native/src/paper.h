// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "isograft/match.h"

namespace isograft {

/// match() by the paper's own steps and parameters (preset `paper`, PaperOptions), on checked options and landmarks.
///
/// What is ours: windows, traces and shots instead of smoothed Dijkstra paths; triangles instead of RIMLS; scale and
/// sides found as in every preset where they are not given; every vertex a surface point. The maps of the other
/// clusters that cover at least half as much as the chosen one come as alternatives.
Match match_by_paper(const Surface& source, const Surface& target, const MatchOptions& options, Monitor& monitor);

}  // namespace isograft
