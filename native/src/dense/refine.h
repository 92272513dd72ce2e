// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "feature/pair.h"
#include "growth/partial_map.h"
#include "isograft/options/dense.h"

namespace isograft {

/// Slide a map along the surface to where the curvature fits, first the coarse and then the fine one: least squares of
/// stretch plus a quadratic model of a small ray descriptor's distance around every image. Cures drift of up to about a
/// spacing, not a wrong limb.
void refine(PartialMap& map, const Pair& pair, const FeatureOptions& features, const GrowthOptions& growth,
            const DenseOptions& options, int threads, Monitor& monitor, double from, double to);

}  // namespace isograft
