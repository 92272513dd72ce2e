// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "feature/pair.h"
#include "hierarchy/coarse_mesh.h"
#include "isograft/match.h"

namespace isograft {

/// How the two surfaces are laid beside each other before anything is matched.
struct Setting {
    /// sigma: target units per source unit.
    double scale = 1.0;
    /// Open parts of one surface are turned over.
    bool source_reversed = false;
    bool target_reversed = false;
};

/// A pair under a setting, sampled and described.
struct PreparedPair {
    Setting setting;
    /// The surfaces as used (a reversed setting changes them), fine and coarse.
    Detail source, target;
    Pair pair;
    /// The pair's unit length in the target's units.
    double unit = 1.0;
};

/// Settle scale and sides, then sample and describe both surfaces.
///
/// Where votes leave several settings, each is prepared and probed, and the one whose probes fit best is taken: a wrong
/// scale or an inside-out surface has no good probes.
/// \param later what is still to come before the progress is at `to`, in seconds as of Costs: how much is done here
/// shows on the way only.
/// \param report stages, scale, unit length, sample counts and warnings are filled in. \throw Cancelled on request.
PreparedPair prepare_pair(Surface source, Surface target, const MatchOptions& options, MatchReport& report,
                          Monitor& monitor, double from, double to, double later = 0.0);

}  // namespace isograft
