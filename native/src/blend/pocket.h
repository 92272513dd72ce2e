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
/// A mapped sample in such a part none of whose neighbours is mapped counts as left out: patches that were not
/// continued put it there, often on the other hand. It is placed anew, or dropped where its distances fit nowhere.
/// \param map in and out; what else it holds is not moved. \param landmarks the first so many samples are not moved.
void fill_pockets(PartialMap& map, const Pair& pair, int landmarks, int threads, Monitor& monitor);

}  // namespace isograft
