// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"
#include "hierarchy/coarse_mesh.h"
#include "isograft/correspondence.h"
#include "isograft/options/dense.h"
#include "isograft/surface.h"

namespace isograft {

/// What is known of every source sample besides its image; values of unmapped ones are not read.
struct SampleNotes {
    std::vector<double> confidence;
    std::vector<double> stretch;
    std::vector<int> region;
};

/// Of samples that lie apart on S and together on T, drop the riskier ones, so that the map is one to one.
/// \param risk per sample, lower is surer.
void drop_collisions(PartialMap& map, const Pair& pair, const std::vector<double>& risk, double radius);

/// From the samples to every input vertex: each coarse vertex is traced from the samples near it and the places
/// averaged; fine vertices follow the coarse triangle they lie in; images are put back on the fine target.
///
/// Vertices without a mapped sample within `options.reach` spacings stay unmatched.
/// \param source, target what the result's indices and units refer to. \throw Cancelled if `monitor` asks for it.
Correspondence densify(const PartialMap& map, const Pair& pair, const SampleNotes& notes, const DenseOptions& options,
                       const Detail& source, const Detail& target, int threads, Monitor& monitor, double from,
                       double to);

}  // namespace isograft
