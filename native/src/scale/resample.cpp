// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/resample.h"

#include <array>

#include "base/parallel.h"

namespace isograft {

void resample(Pair& pair, const MatchOptions& options, std::uint64_t seed, Monitor& monitor, double from, double to) {
    const auto at = [&](double share) { return from + share * (to - from); };
    const std::array<SampledMesh*, 2> sides{&pair.source, &pair.target};
    const auto fixed = static_cast<std::ptrdiff_t>(options.landmarks.size());
    parallel_for(
        2, options.threads,
        [&](int i, int /*worker*/) {
            const Samples& old = sides[i]->samples;
            const std::vector<SurfacePoint> stay(old.point.begin(), old.point.begin() + fixed);
            sides[i]->samples = spread_samples(sides[i]->mesh, old.spacing, options.hierarchy,
                                               seed + static_cast<std::uint64_t>(i), monitor, stay);
        },
        monitor, "samples", from, at(0.2));
    for (int i = 0; i < 2; ++i) {
        join_samples(sides[i]->mesh, sides[i]->samples, options.hierarchy, options.threads, monitor, at(0.2 + 0.1 * i),
                     at(0.3 + 0.1 * i));
    }
    pair.source_descriptor = window_descriptors(pair.source.mesh, pair.source.samples.point, pair.source_curvature, 1.0,
                                                options.feature, options.threads, monitor, at(0.4), at(0.7));
    pair.target_descriptor = window_descriptors(pair.target.mesh, pair.target.samples.point, pair.target_curvature, 1.0,
                                                options.feature, options.threads, monitor, at(0.7), to);
    pair.chance = chance_distance(pair, options.feature, seed + 2);
}

}  // namespace isograft
