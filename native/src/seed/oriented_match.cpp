// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/oriented_match.h"

#include <algorithm>
#include <string>

#include "base/parallel.h"
#include "isograft/errors.h"

namespace isograft {

void SeedOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("seed." + what);
    };
    require(candidates >= 1 && candidates <= 100, "candidates must be in [1, 100]");
    require(probes >= 1 && probes <= 100000, "probes must be in [1, 100000]");
    require(probe_size >= 8 && probe_size <= 1000, "probe_size must be in [8, 1000]");
    require(min_visible >= 0.0 && min_visible <= 1.0, "min_visible must be in [0, 1]");
    require(separation >= 0.0 && separation <= 100.0, "separation must be in [0, 100]");
}

namespace {

std::vector<int> seed_samples(const Pair& pair, const SeedOptions& options) {
    const Samples& samples = pair.source.samples;
    std::vector<int> seeds;
    const auto take = [&](bool coarse, std::size_t limit) {
        for (int s = 0; s < samples.count() && seeds.size() < limit; ++s) {
            const bool sees = pair.source_descriptor[s].visible > options.min_visible;
            if (sees && (samples.level[s] > 0) == coarse) seeds.push_back(s);
        }
    };
    take(true, static_cast<std::size_t>(samples.count()));
    // A small part has few coarse samples; its fine ones help out.
    if (seeds.size() < 100) take(false, 140);
    return seeds;
}

struct Ranked {
    double distance;
    int target;
    int shift;
};

}  // namespace

std::vector<OrientedMatch> oriented_matches(const Pair& pair, const FeatureOptions& features,
                                            const SeedOptions& options, int threads, Monitor& monitor, double from,
                                            double to) {
    const Samples& target = pair.target.samples;
    const std::vector<int> seeds = seed_samples(pair, options);
    std::vector<std::vector<OrientedMatch>> found(seeds.size());
    const auto rank = [&](int i, int /*worker*/) {
        const PolarDescriptor& a = pair.source_descriptor[seeds[i]];
        std::vector<Ranked> ranked(target.count());
        for (int t = 0; t < target.count(); ++t) {
            const PolarDescriptor& b = pair.target_descriptor[t];
            const BestShift best = best_shift(a, b, features);
            ranked[t] = {best.distance + features.ring_weight * ring_distance(a, b), t, best.shift};
        }
        std::sort(ranked.begin(), ranked.end(), [](const Ranked& x, const Ranked& y) {
            return x.distance != y.distance ? x.distance < y.distance : x.target < y.target;
        });
        const double usual = std::max(1e-12, ranked[std::min(target.count() - 1, target.count() / 20)].distance);
        const double apart = options.separation * target.spacing;
        std::vector<int> chosen;
        for (const Ranked& r : ranked) {
            if (r.distance >= not_comparable) break;
            const bool near = std::any_of(chosen.begin(), chosen.end(), [&](int c) {
                return (target.position[r.target] - target.position[c]).norm() < apart;
            });
            if (near) continue;
            chosen.push_back(r.target);
            found[i].push_back({seeds[i], target.point[r.target], rotation_of(r.shift), r.distance / usual});
            if (static_cast<int>(chosen.size()) >= options.candidates) break;
        }
    };
    parallel_for(static_cast<int>(seeds.size()), threads, rank, monitor, "seeds", from, to);
    std::vector<OrientedMatch> matches;
    for (const auto& list : found) matches.insert(matches.end(), list.begin(), list.end());
    std::stable_sort(matches.begin(), matches.end(),
                     [](const OrientedMatch& a, const OrientedMatch& b) { return a.score < b.score; });
    return matches;
}

}  // namespace isograft
