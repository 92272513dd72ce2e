// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "blend/distance_fields.h"
#include "growth/partial_map.h"

namespace isograft {

/// Geodesic distances from a few spread matches of a map: what they say about any other match.
///
/// A path bent by a boundary may be a detour round something missing: then only the other side's excess counts.
class Anchors {
  public:
    /// \param fields must outlive it; may be shared.
    explicit Anchors(DistanceFields& fields) : fields_(fields) {}

    /// Choose `count` mapped samples far from each other and measure from them and from the vertices nearest to their
    /// images. O(count x #V).
    /// \return false if the map is empty.
    bool place(const PartialMap& map, int count, Monitor& monitor);

    /// Trimmed mean relative difference of the distances from the anchors: 0 fits, above 0.2 does not.
    [[nodiscard]] double incompatibility(int sample, const SurfacePoint& point) const;

  private:
    struct Anchor {
        int sample = -1;
        /// To the samples of S, and from the vertex nearest to the image to those of T.
        std::shared_ptr<const DistanceField> source, target;
        /// From the image itself to the vertices of T.
        std::vector<float> target_distance;
    };

    [[nodiscard]] std::vector<float> from_image(const DistanceField& field, int vertex,
                                                const SurfacePoint& image) const;

    DistanceFields& fields_;
    std::vector<Anchor> anchors_;
};

}  // namespace isograft
