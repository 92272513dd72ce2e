// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "blend/core.h"
#include "feature/pair.h"

namespace isograft {

/// What the seeds of a core say of the scale that was assumed.
struct CoreScale {
    /// Median of d_T / d_S between pairs of seeds: the factor by which the assumed scale is too small.
    double ratio = 1.0;
    /// Its standard error, from the spread of the single ratios; large where there are too few.
    double error = 1.0;
};

/// Compare geodesic distances between the seeds of a core's patches on both surfaces.
///
/// Seeds were matched by descriptor alone, so their distances do not copy the assumed scale as those within a grown map
/// do. Paths bent by a boundary are left out. O(most_seeds x #V).
CoreScale measure_core_scale(const Pair& pair, const std::vector<Patch>& patches, const Core& core, Monitor& monitor);

}  // namespace isograft
