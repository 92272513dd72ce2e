// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "feature/pair.h"
#include "isograft/options/seed.h"

namespace isograft {

/// A source sample, its point on T, and the rotation between their frames: it fixes an isometry.
struct OrientedMatch {
    int sample = -1;
    SurfacePoint point;
    Complex rotation{1.0, 0.0};
    /// Lower is surer: distance over that of the sample's best twentieth, so that plain places do not win by being
    /// near everything.
    double score = 0.0;
};

/// Oriented matches of the coarse samples in the order in which to try them (in place of the paper's feature matches
/// and priority queue, section 4.3).
///
/// The order is deterministic. O(samples of a coarse level x target samples x shifts). \throw Cancelled on request.
std::vector<OrientedMatch> oriented_matches(const Pair& pair, const FeatureOptions& features,
                                            const SeedOptions& options, int threads, Monitor& monitor, double from,
                                            double to);

}  // namespace isograft
