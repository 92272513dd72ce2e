// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "feature/pair.h"
#include "growth/partial_map.h"
#include "isograft/options/dense.h"

namespace isograft {

/// Slide a map along the surface to where the shape fits: least squares of stretch plus, first, a quadratic model of a
/// ray descriptor's distance around every image, then the relief of small pieces (see Relief), then the descriptor
/// again with finer curvature. Cures drift of some spacings, not a wrong limb. \throw Cancelled on request.
void refine(PartialMap& map, const Pair& pair, const FeatureOptions& features, const GrowthOptions& growth,
            const DenseOptions& options, int threads, Monitor& monitor, double from, double to);

}  // namespace isograft
