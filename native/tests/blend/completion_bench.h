// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "blend/completion.h"
#include "twins.h"

namespace isograft {

/// A completion on the blob twins, with all that it refers to.
struct CompletionBench {
    explicit CompletionBench(const std::vector<Patch>& patches) : patches_of_search(patches) {}

    const std::vector<Patch>& patches_of_search;
    PatchSettings settings = Twins::of_a_blob().settings();
    Monitor monitor;
    Trials trials{Twins::of_a_blob().pair(), settings, 2 * settings.seed.probe_size};
    DistanceFields fields{Twins::of_a_blob().pair()};
    DriftFinder drift{Twins::of_a_blob().pair(), settings.feature};
    Completion completion{Twins::of_a_blob().pair(), settings, patches_of_search, trials, fields, drift, monitor};
};

/// The best `count` patches of 40 samples grown from right matches of the blob twins.
inline std::vector<Patch> right_patches(const std::vector<OrientedMatch>& matches, int count) {
    PatchSettings settings = Twins::of_a_blob().settings();
    settings.blend.patches = count;
    settings.blend.patch_size = 40;
    Monitor monitor;
    return grow_patches(Twins::of_a_blob().pair(), settings, matches, 0, monitor, 0.0, 1.0);
}

}  // namespace isograft
