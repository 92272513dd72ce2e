// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "growth/partial_map.h"
#include "isograft/monitor.h"

namespace isograft {

/// How far fit_metric() goes.
struct MetricFitOptions {
    /// Steps tried at most; it ends before with one that gains, but less than a thousandth.
    int iterations = 30;
    /// Longest step of a point in one iteration, in spacings: farther off, lengths are no longer linear in it.
    double max_step = 1.0;
};

/// The paper's least squares (section 4.3, after Bronstein et al. 2006): the sum of (d_T - d_S)^2 over the hierarchy's
/// edges inside U, all of one weight, without a robust loss; two tangent unknowns a vertex, Levenberg-Marquardt.
///
/// Unlike relax(), which divides by d_S, bends to outliers less and is what our own presets use. Afterwards every
/// rotation is the mean turn of its edges of the two lowest levels. The map never gets worse in this sum.
/// \param map images, rotations and stress (root mean square of d_T - d_S, in spacings) are updated.
/// O(iterations x (edges + sparse Cholesky of 2 unknowns a vertex)).
void fit_metric(const Samples& source, const TriangleMesh& target, const MetricFitOptions& options, PartialMap& map,
                Monitor& monitor);

}  // namespace isograft
