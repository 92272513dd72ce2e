// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "growth/partial_map.h"

namespace isograft {

/// A quadratic model of a per-sample energy around its image: g . x + x . H x / 2 in the image triangle's frame.
struct SampleTerm {
    double gx = 0.0, gy = 0.0;
    double hxx = 0.0, hxy = 0.0, hyy = 0.0;
};

/// What relax() does besides the stretch.
struct RelaxSettings {
    int iterations = 2;
    /// Weight of `term`; its models are made anew before every iteration.
    double term_weight = 0.0;
    /// Fills a model for each sample; nothing where the energy is not known (zeros).
    std::function<void(const PartialMap& map, std::vector<SampleTerm>& terms)> term;
    /// Drop samples whose mean relative stretch over level-0 edges exceeds this; 0 keeps all.
    double trim = 0.0;
    /// For the geodesics of large maps.
    int threads = 1;
};

/// Nonlinear least squares of d_T - d_S over the hierarchy's edges inside U (paper section 4.4, eq. 6): two tangent
/// unknowns a sample, weights 1 / d_S, Huber loss on the relative stretch, Levenberg-Marquardt.
///
/// d_T comes from shooting along the source's path, its derivative is minus the unit departure direction (first
/// variation of arc length). Afterwards every rotation is the mean turn of its edges.
/// \param map in and out: images, rotations, stress, and membership if `trim` is set.
/// \return per sample the mean relative stretch over its level-0 edges, 0 where unmapped.
std::vector<double> relax(const Samples& source, const TriangleMesh& target, const GrowthOptions& options,
                          const RelaxSettings& settings, PartialMap& map);

/// Residuals and derivatives of relax() for the test against finite differences.
struct StretchDerivative {
    double residual = 0.0;
    Complex by_u, by_v;
};
StretchDerivative stretch_derivative(const TriangleMesh& target, const SurfacePoint& u, const SurfacePoint& v,
                                     Complex direction, double length);

}  // namespace isograft
