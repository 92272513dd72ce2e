// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "surface/kd_tree.h"

namespace isograft {

/// Options of the robust implicit surface. Lengths are in local spacings of the points.
struct RimlsOptions {
    /// Radius of a point's weight function. Larger smooths more.
    double support = 2.6;
    /// Points that much off the surface that the others make count little (sigma_r of the paper).
    double residual = 0.5;
    /// Normals that differ that much (length of the difference) count little: keeps creases and close sheets apart
    /// (sigma_n of the paper).
    double normal = 0.8;
    /// Reweighting steps, and steps of the projection.
    int refits = 3;
    int steps = 12;
};

/// A continuous surface through noisy oriented points: robust implicit moving least squares.
///
/// Oztireli, Guennebaud, Gross, "Feature preserving point set surfaces based on non-linear kernel regression",
/// Computer Graphics Forum 28 (2009), algorithm 1: the zero set of f(x), a weighted mean of the points' tangent planes'
/// distances at x, with weights (1 - (r/h)^4... refitted to leave out points whose plane or normal disagrees.
class Rimls {
  public:
    struct Projection {
        Eigen::Vector3d position;
        /// Unit, the gradient of f there.
        Eigen::Vector3d normal;
        /// False if there were too few points around, or the steps did not end on the surface.
        bool converged = false;
    };

    /// \param tree, normal, spacing of the points; they must outlive this object. Normals are oriented and of unit
    /// length.
    Rimls(const KdTree& tree, const std::vector<Eigen::Vector3d>& normal, const std::vector<double>& spacing,
          const RimlsOptions& options = {});

    /// The point of the surface near `x` on the sheet that looks along `side` (unit): points that look the other way
    /// are not seen. Ends within 1e-4 spacings of the zero set.
    [[nodiscard]] Projection project(const Eigen::Vector3d& x, const Eigen::Vector3d& side) const;

  private:
    struct Value;
    [[nodiscard]] Value value(const Eigen::Vector3d& x, const Eigen::Vector3d& side) const;

    const KdTree* tree_;
    const std::vector<Eigen::Vector3d>* normal_;
    const std::vector<double>* spacing_;
    RimlsOptions options_;
};

}  // namespace isograft
