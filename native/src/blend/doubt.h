// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "growth/patches.h"

namespace isograft {

/// What speaks for and against one sample's image.
struct Evidence {
    /// mismatch() of the descriptors: 0 fits, about 1 is chance.
    double mismatch = 0.0;
    /// Anchors::incompatibility(): 0 fits, above 0.2 does not.
    double incompatibility = 0.0;
    /// Difference of the squashed curvature at the sample and at its image.
    double curvature = 0.0;
    /// Share of the patches' say that puts the sample there, see Support; 0.5 where they are silent.
    double support = 0.5;
    /// Log-odds that come from elsewhere.
    double hearsay = 0.0;
    /// Both surfaces are closed: then distances are what they are on the whole body, and tell best.
    bool whole = false;
    /// Drift::gain() of the sample; negative where it was not looked for.
    double drift = -1.0;
};

/// Probability that an image with this evidence is wrong (error over 0.1 of the root of T's area): logistic models,
/// fitted on the extended maps of 28 pairs of ten kinds, with drift of 80 pairs of fourteen kinds; closed pairs and
/// others apart. With each kind left out of the fit in turn, drift raises the area under the curve from 0.82 to 0.84
/// and from 0.945 to 0.948, and the right samples kept at 1 % false ones of closed pairs from 71 to 84 %.
double doubt(const Evidence& evidence);

/// What the patches, right and wrong ones, say of every sample: wrong ones contradict each other, right ones agree.
class Support {
  public:
    Support(const std::vector<Patch>& patches, int samples, double radius, double decay);

    /// Weighted share of the patches' images of `sample` that lie within the radius of `x`; 0.5 if there are none.
    [[nodiscard]] double share(int sample, const Eigen::Vector3d& x) const;
    /// The same of the place that most of them favour beyond twice the radius from `x`.
    [[nodiscard]] double rival(int sample, const Eigen::Vector3d& x) const;

  private:
    struct Say {
        Eigen::Vector3d position;
        double weight;
    };
    std::vector<std::vector<Say>> says_;
    double radius_;
};

}  // namespace isograft
