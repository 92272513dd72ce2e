// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "blend/choice.h"
#include "growth/patches.h"

namespace isograft {

/// One map out of many.
struct Blended {
    PartialMap map;
    /// Per sample the risk averaged over its ring (see Completion::ring_risk); 0 where unmapped.
    std::vector<double> risk;
    /// Of the map before careful trimming, by which it was chosen.
    MapQuality quality;
    int maps_in_core = 0;
};

/// Complete the strongest cores, choose one, and carry it carefully into the rest (DESIGN section 3, stage 7).
///
/// The map is empty where even the best core fits the surfaces no better than chance.
Blended blend(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches, Monitor& monitor,
              double from, double to);

}  // namespace isograft
