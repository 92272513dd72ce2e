// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of the oriented polar descriptor. Lengths are in the pair's unit length.
struct FeatureOptions {
    /// Radius of the window. Larger sees more context and costs its square.
    double radius = 0.2;
    /// Umbrella smoothing steps of the mean curvature, for meshes near 5,000 vertices.
    int smoothing = 8;
    /// Curvature h enters as atan(squash h): keeps sharp creases from outweighing everything else.
    double squash = 0.06;
    /// Weight of the ring areas against the curvature cells.
    double ring_weight = 0.15;
    /// Added per hidden share of the window, so that a match seen whole beats one seen in part.
    double hidden_penalty = 0.05;
    /// Two descriptors that share less of the window than this are not compared.
    double min_visible = 0.2;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("radius", radius);
        visitor("smoothing", smoothing);
        visitor("squash", squash);
        visitor("ring_weight", ring_weight);
        visitor("hidden_penalty", hidden_penalty);
        visitor("min_visible", min_visible);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft
