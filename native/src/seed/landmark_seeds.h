// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "isograft/match.h"
#include "isograft/monitor.h"
#include "seed/oriented_match.h"

namespace isograft {

/// Oriented matches of given point pairs, which are the first samples of both surfaces, in their order.
///
/// The angle is the one at which the descriptors fit best, unless they fit as well (within a tenth of chance) under the
/// angle at which the geodesics to the other landmarks leave: where the surface shows no features, as on a plane, that
/// is all there is to know. Of the other landmarks those count that keep their distance, and of the angles they tell
/// the one that most agree on within 30 degrees. O(#landmarks full windows).
/// \param at the progress that is reported meanwhile. \throw Cancelled if `monitor` asks for it.
std::vector<OrientedMatch> landmark_seeds(const Pair& pair, const std::vector<Landmark>& landmarks,
                                          const FeatureOptions& options, int threads, Monitor& monitor, double at);

}  // namespace isograft
