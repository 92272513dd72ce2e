// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of growth and of its least squares. Lengths are in units of the sample spacing r0.
struct GrowthOptions {
    /// nu: largest accepted stretch against the mapped neighbours (paper section 4.3; there 0.5 e0).
    double stretch_limit = 0.5;
    /// Weight of the disagreement of predicted angles in the order of growth.
    double rotation_weight = 0.3;
    /// Mapped neighbours a new sample needs once a map is past its first few samples.
    int min_neighbours = 3;
    /// Two images nearer than this collide unless their samples are neighbours.
    double collision_radius = 0.45;
    /// Relative residual from which an edge's weight falls (Huber).
    double huber = 0.1;
    /// Longest step of a point in one iteration of the least squares.
    double max_step = 0.5;
    /// Iterations of the least squares at every doubling of the map.
    int iterations = 2;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("stretch_limit", stretch_limit);
        visitor("rotation_weight", rotation_weight);
        visitor("min_neighbours", min_neighbours);
        visitor("collision_radius", collision_radius);
        visitor("huber", huber);
        visitor("max_step", max_step);
        visitor("iterations", iterations);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft
