// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/feature_seeds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace isograft {

namespace {

constexpr int directions = 3;
// Two neighbours say the same of the direction if their turns differ by no more than this.
constexpr double same_turn = M_PI / 6.0;

struct Neighbour {
    /// Its d_init and its stretch to the match at hand (eq. 8 with a cluster of one).
    double worth;
    int feature;
    double turn;
};

// How probable the matches of all features are that say the same of the direction, the best of each feature. Where
// features are a few edges off, one neighbour alone is too often wrong.
double support(const std::vector<Neighbour>& neighbours, const Neighbour& chosen, double limit) {
    double sum = 0.0, best = 0.0;
    for (std::size_t i = 0; i < neighbours.size(); ++i) {
        const Neighbour& other = neighbours[i];
        if (std::abs(std::remainder(other.turn - chosen.turn, 2.0 * M_PI)) <= same_turn) {
            best = std::max(best, std::exp(limit - other.worth));
        }
        if (i + 1 < neighbours.size() && neighbours[i + 1].feature == other.feature) continue;
        sum += best;
        best = 0.0;
    }
    return sum;
}

}  // namespace

std::vector<OrientedMatch> feature_seeds(const std::vector<FeatureMatch>& matches, const FeaturePlaces& places,
                                         const FeatureGeodesics& source, const FeatureGeodesics& target,
                                         const ClusterOptions& options, double least_distance) {
    std::vector<int> order(matches.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<int> by_feature = order;
    std::stable_sort(by_feature.begin(), by_feature.end(),
                     [&](int a, int b) { return matches[a].source < matches[b].source; });
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        if (matches[a].priority != matches[b].priority) return matches[a].priority < matches[b].priority;
        return matches[a].dissimilarity < matches[b].dissimilarity;
    });
    // By direction, those of clusters before the others.
    std::vector<OrientedMatch> round[2 * directions];
    std::vector<Neighbour> neighbours;
    for (const int m : order) {
        const FeatureMatch& match = matches[m];
        neighbours.clear();
        for (const int i : by_feature) {
            const FeatureMatch& other = matches[i];
            const double on_source = source.distance(match.source, other.source);
            const double on_target = target.distance(match.target, other.target);
            if (on_source < least_distance || on_target < least_distance || on_source >= options.reach) continue;
            if (!std::isfinite(on_target)) continue;
            const double stretch = on_source - on_target;
            const double worth = other.dissimilarity + options.weight * stretch * stretch;
            if (worth >= options.limit) continue;
            const double turn = target.angle(match.target, other.target) - source.angle(match.source, other.source);
            neighbours.push_back({worth, other.source, turn});
        }
        // By falling support, then rising dissimilarity.
        std::vector<std::pair<std::pair<double, double>, std::size_t>> rank;
        for (std::size_t i = 0; i < neighbours.size(); ++i) {
            rank.push_back({{-support(neighbours, neighbours[i], options.limit), neighbours[i].worth}, i});
        }
        const auto kept = std::min<std::size_t>(directions, rank.size());
        std::partial_sort(rank.begin(), rank.begin() + static_cast<std::ptrdiff_t>(kept), rank.end());
        for (std::size_t k = 0; k < kept; ++k) {
            round[k + (std::isfinite(match.priority) ? 0 : directions)].push_back(
                {places.source[match.source], places.target[match.target],
                 std::polar(1.0, neighbours[rank[k].second].turn), match.priority});
        }
    }
    for (int k = 1; k < 2 * directions; ++k) round[0].insert(round[0].end(), round[k].begin(), round[k].end());
    return std::move(round[0]);
}

}  // namespace isograft
