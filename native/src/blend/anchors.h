// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// Geodesic distances from a few spread matches of a map: what they say about any other match.
///
/// A path bent by a boundary may be a detour round something missing: then only the other side's excess counts.
class Anchors {
  public:
    explicit Anchors(const Pair& pair) : pair_(pair) {}

    /// Choose `count` mapped samples far from each other and measure from them and from their images.
    /// Windows of anchors that have hardly moved since the last call are kept. O(count x #V).
    /// \return false if the map is empty.
    bool place(const PartialMap& map, int count, Monitor& monitor);

    /// Trimmed mean relative difference of the distances from the anchors: 0 fits, above 0.2 does not.
    [[nodiscard]] double incompatibility(int sample, const SurfacePoint& point) const;

  private:
    enum class Sight : char { straight, bent, none };
    struct Anchor {
        int sample = -1;
        SurfacePoint image;
        Eigen::Vector3d image_position;
        std::vector<float> source_distance;  // per source sample
        std::vector<Sight> source_sight;
        std::vector<float> target_distance;  // per target vertex
        std::vector<Sight> target_sight;
    };

    void measure_source(Anchor& anchor, Window& window) const;
    void measure_target(Anchor& anchor, Window& window) const;

    const Pair& pair_;
    std::vector<Anchor> anchors_;
};

}  // namespace isograft
