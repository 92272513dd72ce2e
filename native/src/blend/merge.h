// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "blend/anchors.h"
#include "growth/patches.h"

namespace isograft {

/// Add to `map` every sample on which the patches' weighted votes settle on one place (paper eq. 10, with a mode in
/// place of the mean, so that a wrong limb does not pull the right one).
void merge_into(PartialMap& map, const Pair& pair, const PatchSettings& settings,
                const std::vector<const Patch*>& patches, const std::vector<double>& weights);

/// Whether the images of an edge's ends, `a` and `b` in space, are as far apart as the ends are: to a third of the edge
/// and a fifth of a spacing.
bool keeps_length(const Samples& source, const SampleEdge& edge, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Number the parts of a map that are continuous on both surfaces, the largest area 0; -1 where unmapped.
std::vector<int> continuous_parts(const PartialMap& map, const Pair& pair);

/// Drop every part that was taken for another limb: it touches a larger one on S with much of its rim and lies
/// elsewhere on T, or the largest one reaches it on S over a gap clearly shorter than the straight line on T, or it
/// does not fit the anchors. Parts that touch nothing and fit stay. \return number of samples dropped.
int drop_torn_parts(PartialMap& map, const Pair& pair, const Anchors& anchors);

/// Share of the level-0 edges between mapped samples whose images lie more than two spacings too far apart. A right map
/// tears S only where S touches itself.
double torn_share(const PartialMap& map, const Samples& source);

}  // namespace isograft
