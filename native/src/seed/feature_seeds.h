// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/feature_match.h"
#include "seed/oriented_match.h"

namespace isograft {

/// The features of both surfaces as the seeds need them.
struct FeaturePlaces {
    /// Per source feature its vertex, per target feature its point.
    std::vector<int> source;
    std::vector<SurfacePoint> target;
};

/// Oriented matches in the order in which to try them (section 4.2): by rising priority of the feature match, each
/// with the direction that its surest neighbouring match gives, then again with the second and third surest.
///
/// A neighbour (s', t') of (s, t) is worth d = d_init(s', t') + w_C |d_S(s, s') - d_T(t, t')|^2; it has to be at least
/// `least_distance` away on both sides, since the direction to a point nearby is noise. The surest is the one whose
/// direction has the greatest support: the sum of exp(-d), the probability that eq. 8 stands for, over the best matches
/// of all features that agree with it within 30 degrees. Matches without a neighbour below `options.limit` have no
/// direction and are left out.
std::vector<OrientedMatch> feature_seeds(const std::vector<FeatureMatch>& matches, const FeaturePlaces& places,
                                         const FeatureGeodesics& source, const FeatureGeodesics& target,
                                         const ClusterOptions& options, double least_distance);

}  // namespace isograft
