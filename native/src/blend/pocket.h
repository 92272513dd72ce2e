// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "feature/pair.h"
#include "growth/partial_map.h"
#include "isograft/monitor.h"

namespace isograft {

/// Place what growth left out in small parts of S beside the map: fingers, toes, ears and folds, where a few samples
/// are too far apart for straight traces to follow the shape.
///
/// Each sample goes where its geodesic distances to a dozen mapped samples around are what they are on S, among the
/// vertices of T on which no image lies. One whose distances fit nowhere, or whose neighbours lie elsewhere, stays
/// unmapped; so do parts along a boundary of S. Which of two fingers it is may remain open; they lie within a few
/// hundredths of each other.
/// \param map in and out; what it holds is not moved. \return samples added.
int fill_pockets(PartialMap& map, const Pair& pair, int threads, Monitor& monitor);

}  // namespace isograft
