// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of the step from the samples to every vertex.
struct DenseOptions {
    /// Strength of the descriptor term that slides points along the surface in the last least squares; 0 = off.
    double refine_weight = 0.1;
    /// Iterations of that, first with the coarse shape, which pulls from farther away; then of the relief of small
    /// pieces instead, and as many of that of smaller ones; and last with the fine shape.
    int refine_coarse_iterations = 2;
    int refine_relief_iterations = 6;
    int refine_iterations = 3;
    /// A vertex farther than this from every mapped sample stays unmatched; in sample spacings.
    double reach = 1.3;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("refine_weight", refine_weight);
        visitor("refine_coarse_iterations", refine_coarse_iterations);
        visitor("refine_relief_iterations", refine_relief_iterations);
        visitor("refine_iterations", refine_iterations);
        visitor("reach", reach);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft
