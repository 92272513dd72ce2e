// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// What a map makes of the landmarks, the first samples of both sides.
struct Heed {
    /// Summed weights of those it puts in their places, within a tenth of the unit length, and of those it puts
    /// elsewhere.
    double kept = 0.0, broken = 0.0;
    int kept_count = 0;
    /// Of the weight of all landmarks the share that is kept, those outside the map by half; 1 without landmarks.
    double share = 1.0;

    /// Whether somebody who knows says so: one landmark would only speak for the place where the map began.
    [[nodiscard]] bool vouched() const { return kept_count >= 2 && kept > broken; }
};

/// \param weight of each landmark, in (0, 1].
Heed heed(const PartialMap& map, const Pair& pair, const std::vector<double>& weight);

}  // namespace isograft
