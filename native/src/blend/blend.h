// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "blend/core.h"
#include "growth/patches.h"

namespace isograft {

/// One map out of many.
struct Blended {
    PartialMap map;
    /// Per sample the probability that its image is wrong (see Completion::doubts); 0 where unmapped.
    std::vector<double> risk;
    int maps_in_core = 0;
    /// Completion::worth() of the map as it is: comparable between searches of one pair.
    double fit = 0.0;
    /// The strongest core of this search came to the map that was carried over from an earlier one, and this is it. It
    /// was grown from other samples, but its second passes heard the earlier map too where that fits it.
    bool confirmed = false;
};

/// Complete the strongest cores, choose one, and carry it carefully into the rest (paper section 4.4).
///
/// \param cores those of find_cores(), the strongest first; beside them the map of an earlier search, if there is one.
/// \param middle progress when the cores are complete.
/// \return the chosen map, empty where even the best core fits the surfaces no better than chance; after it those that
/// contradict it and are worth nearly as much, by falling fit: the surfaces map onto themselves, and it is open which
/// of them is meant. \throw Cancelled if `monitor` asks for it.
std::vector<Blended> blend(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches,
                           const std::vector<Core>& cores, Monitor& monitor, double from, double middle, double to);

}  // namespace isograft
