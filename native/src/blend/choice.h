// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "growth/patches.h"

namespace isograft {

/// What tells a right map from a consistent wrong one.
struct MapQuality {
    /// Share of S's area that is mapped.
    double coverage = 0.0;
    /// Mean mismatch by area: below 0.3 nearly always right, above 0.33 mostly wrong.
    double mismatch = 0.0;
    /// Correlation of curvature at the samples and at their images.
    double curvature = 0.0;
    /// Mean relative residual of the best rigid motion of each sample's surroundings.
    double rigidity = 0.0;
};

MapQuality measure_quality(const Pair& pair, const FeatureOptions& options, const PartialMap& map);

/// The score by which one of several contradicting cores is chosen; higher is better.
double choice_score(const MapQuality& quality, double vote);

}  // namespace isograft
