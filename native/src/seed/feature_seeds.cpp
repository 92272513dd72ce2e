// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/feature_seeds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace isograft {

namespace {
constexpr int directions = 3;
}

std::vector<OrientedMatch> feature_seeds(const std::vector<FeatureMatch>& matches, const FeaturePlaces& places,
                                         const FeatureGeodesics& source, const FeatureGeodesics& target,
                                         const ClusterOptions& options, double least_distance) {
    std::vector<int> order(matches.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        if (matches[a].priority != matches[b].priority) return matches[a].priority < matches[b].priority;
        return matches[a].dissimilarity < matches[b].dissimilarity;
    });
    // By direction, those of clusters before the others.
    std::vector<OrientedMatch> round[2 * directions];
    std::vector<std::pair<double, int>> neighbours;
    for (const int m : order) {
        const FeatureMatch& match = matches[m];
        neighbours.clear();
        for (std::size_t i = 0; i < matches.size(); ++i) {
            const FeatureMatch& other = matches[i];
            const double on_source = source.distance(match.source, other.source);
            const double on_target = target.distance(match.target, other.target);
            if (on_source < least_distance || on_target < least_distance || on_source >= options.reach) continue;
            if (!std::isfinite(on_target)) continue;
            const double stretch = on_source - on_target;
            const double worth = other.dissimilarity + options.weight * stretch * stretch;
            if (worth < options.limit) neighbours.emplace_back(worth, static_cast<int>(i));
        }
        const auto kept = std::min<std::size_t>(directions, neighbours.size());
        std::partial_sort(neighbours.begin(), neighbours.begin() + static_cast<std::ptrdiff_t>(kept), neighbours.end());
        for (std::size_t k = 0; k < kept; ++k) {
            const FeatureMatch& other = matches[neighbours[k].second];
            const double turn = target.angle(match.target, other.target) - source.angle(match.source, other.source);
            round[k + (std::isfinite(match.priority) ? 0 : directions)].push_back(
                {places.source[match.source], places.target[match.target], std::polar(1.0, turn), match.priority});
        }
    }
    for (int k = 1; k < 2 * directions; ++k) round[0].insert(round[0].end(), round[k].begin(), round[k].end());
    return std::move(round[0]);
}

}  // namespace isograft
