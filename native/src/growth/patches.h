// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/grow.h"
#include "isograft/options/blend.h"
#include "isograft/options/seed.h"
#include "seed/oriented_match.h"

namespace isograft {

/// A middle-sized map grown from one oriented match.
struct Patch {
    PartialMap map;
    /// Mean mismatch plus stress plus what it lacks in size: 0 is perfect, about 1 chance.
    double quality = 0.0;
    /// Say in a merge; 0 has none.
    double weight = 0.0;
};

/// Options of several stages, passed on together.
struct PatchSettings {
    FeatureOptions feature;
    SeedOptions seed;
    GrowthOptions growth;
    BlendOptions blend;
    int threads = 0;
    /// Weight of each landmark; they are the first samples of both sides, in this order.
    std::vector<double> landmarks;
};

/// Mean of the better half of some patches' qualities: of two ways to lay the surfaces beside each other, the one with
/// the lower mean lets more of the seeds grow. \param quality at least one.
double better_half(std::vector<double> quality);

/// Mean mismatch over a map's samples.
double mean_mismatch(const Pair& pair, const FeatureOptions& options, const PartialMap& map);

/// A small map from one oriented match, and how good it is (see Patch::quality).
Patch probe(const Pair& pair, const PatchSettings& settings, Grower& grower, const OrientedMatch& match, int size);

/// Probe the first matches, keep the best, and grow those on (after the paper's section 4.3).
///
/// Many middle-sized maps instead of the paper's 200 whole ones: drift is not the limit, a whole limb taken for
/// another is. \param forced the first so many matches are always kept (landmarks).
/// \return best first. Equal bit for bit for any number of threads. \throw Cancelled if `monitor` asks for it.
std::vector<Patch> grow_patches(const Pair& pair, const PatchSettings& settings,
                                const std::vector<OrientedMatch>& matches, int forced, Monitor& monitor, double from,
                                double to);

}  // namespace isograft
