// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// Where a vertex of the source's mesh goes.
struct VertexPlace {
    SurfacePoint point;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();

    struct Say {
        int sample;
        double weight;
    };
    /// The samples that were heard, by rising index, and their weights, one over the squared distance.
    std::vector<Say> said;
    double total = 0.0;
};

/// Each mapped sample near a vertex walks to it on T as it would on S; the mean of where they end.
/// \param reach no mapped sample nearer than this: no place. In the pair's unit length.
std::optional<VertexPlace> place_of_vertex(int vertex, const PartialMap& map, const Pair& pair, double reach);

/// The same map on other samples of the same two meshes: each goes where the corners of its triangle go.
/// \param from what `map` is on. \param to the same but for its samples.
/// \return without the samples that have a corner farther than a spacing from all mapped ones; `seed_distance` is 0.
PartialMap carried_over(const PartialMap& map, const Pair& from, const Pair& to);

}  // namespace isograft
