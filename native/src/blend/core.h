// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/patches.h"
#include "isograft/options/blend.h"

namespace isograft {

/// Patches that agree with each other.
struct Core {
    std::vector<char> member;
    int count = 0;
    /// The map of an earlier search, and no consensus of this one.
    bool carried = false;
};

/// Find sets of patches that put the samples they share in the same places (in place of the paper's linkage, section
/// 4.4): the leading eigenvector of the agreement graph names the first member, those that agree best follow.
///
/// \param forced the first so many patches come from landmarks: one of them begins the first core, however little
/// the others agree with it.
/// \return up to BlendOptions::cores disjoint ones, the strongest first; the first is there unless `patches` is empty.
std::vector<Core> find_cores(const std::vector<Patch>& patches, const BlendOptions& options, int forced = 0);

}  // namespace isograft
