// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "isograft/monitor.h"
#include "isograft/options/feature.h"
#include "isograft/options/scale.h"
#include "surface/mesh.h"

namespace isograft {

/// Two readings of the ratio of two surfaces' units from the sizes at which their descriptors fit best.
struct ScaleVotes {
    /// Target units per source unit, from the mean fit over the surer half of the votes.
    double by_fit = 1.0;
    /// The same from the most frequent best size of single votes.
    double by_vote = 1.0;
    /// Mean fit at the size of `by_fit`: how near the best target point is against the best twentieth; lower is better.
    double fit = 1.0;
};

/// Compare ray descriptors of `options.votes` source points at 19 sizes with the target's everywhere.
///
/// Distances count relative to what each point meets on the target at the same size: raw distances favour large, plain
/// windows and err by factors of two. \throw Cancelled if `monitor` asks for it.
ScaleVotes vote_scale(const TriangleMesh& source, const TriangleMesh& target, const FeatureOptions& features,
                      const ScaleOptions& options, std::uint64_t seed, int threads, Monitor& monitor, double from,
                      double to);

/// Both readings say the same.
bool votes_agree(const ScaleVotes& votes);

/// Ratios worth trying: exact ones where the votes confirm them, else the votes themselves and the exact ones besides.
/// \param exact likely ratios, the likelier first: a common unit, two whole surfaces of one area.
std::vector<double> scale_candidates(const ScaleVotes& votes, const std::vector<double>& exact);

}  // namespace isograft
