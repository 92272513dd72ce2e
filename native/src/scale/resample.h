// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "feature/pair.h"
#include "isograft/match.h"

namespace isograft {

/// Other samples on both surfaces of a pair, with their descriptors; landmarks stay the first samples.
///
/// Whether a map crosses a narrow joint hangs on where samples happen to lie, so another search needs other samples.
/// Meshes, scale and curvatures stay. O(#V) small windows, and one of the descriptors' radius a sample.
/// \param seed of the source's samples; the target's take the next one.
void resample(Pair& pair, const MatchOptions& options, std::uint64_t seed, Monitor& monitor, double from, double to);

}  // namespace isograft
