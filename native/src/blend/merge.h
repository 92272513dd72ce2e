// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/patches.h"

namespace isograft {

/// Add to `map` every sample on which the patches' weighted votes settle on one place (paper eq. 10, with a mode in
/// place of the mean, so that a wrong limb does not pull the right one).
void merge_into(PartialMap& map, const Pair& pair, const PatchSettings& settings,
                const std::vector<const Patch*>& patches, const std::vector<double>& weights);

/// Number the parts of a map that are continuous on both surfaces, the largest area 0; -1 where unmapped.
std::vector<int> continuous_parts(const PartialMap& map, const Pair& pair);

/// Drop every part that touches a larger one on S and lies elsewhere on T, or that the largest reaches on S over a gap
/// shorter than the straight line on T: it was taken for another limb. Parts that touch nothing stay. \return number of
/// samples dropped.
int drop_torn_parts(PartialMap& map, const Pair& pair);

}  // namespace isograft
