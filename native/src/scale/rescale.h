// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scale/setting.h"

namespace isograft {

/// Correct the scale of a prepared pair by `factor`: the source, its samples and curvatures are scaled where they are,
/// its descriptors made anew, since they look at it with the pair's radius.
///
/// The unit length and the target stay. O(#V), plus the source's descriptors.
void rescale(PreparedPair& prepared, double factor, const MatchOptions& options, Monitor& monitor, double from,
             double to);

}  // namespace isograft
