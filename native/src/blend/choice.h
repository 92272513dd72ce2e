// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/patches.h"

namespace isograft {

/// What tells a right map from a consistent wrong one.
struct MapQuality {
    /// Mean mismatch by area: below 0.3 nearly always right, above 0.33 mostly wrong.
    double mismatch = 0.0;
    /// Correlation of curvature at the samples and at their images.
    double curvature = 0.0;
    /// Mean relative residual of the best rigid motion of each sample's surroundings.
    double rigidity = 0.0;
    /// Share of S's area that is expected to be mapped rightly, where doubt counts four times.
    double expected = 0.0;
};

/// \param doubts per sample the probability that its image is wrong, see Completion::doubts().
MapQuality measure_quality(const Pair& pair, const FeatureOptions& options, const PartialMap& map,
                           const std::vector<double>& doubts);

/// The score by which one of several contradicting maps is chosen; higher is better. Mostly what is expected to be
/// right; less where it is not nearly rigid (a body bends at joints, a wrong map everywhere) and where curvature does
/// not go along. The number of patches behind a map says nothing more: weighed in, it mended two of 80 pairs and broke
/// two.
double choice_score(const MapQuality& quality);

}  // namespace isograft
