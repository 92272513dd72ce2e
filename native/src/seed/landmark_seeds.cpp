// SPDX-License-Identifier: GPL-3.0-or-later
#include "seed/landmark_seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "feature/feature_match.h"

namespace isograft {

namespace {

// What a pose does to the geodesics between two points far apart, as a share of them.
constexpr double bearable_stretch = 0.15;
// Nearer landmarks than this, in the unit length, give no direction.
constexpr double least_baseline = 0.04;
constexpr double same_turn = M_PI / 6.0;
// Descriptor distances that differ by less, in those of chance, say nothing.
constexpr double indifferent = 0.1;

struct Opinion {
    double turn;
    double weight;
};

std::vector<Opinion> opinions(const FeatureGeodesics& source, const FeatureGeodesics& target,
                              const std::vector<Landmark>& landmarks, int of) {
    std::vector<Opinion> said;
    for (int j = 0; j < static_cast<int>(landmarks.size()); ++j) {
        const double a = source.distance(of, j), b = target.distance(of, j);
        if (!std::isfinite(a) || !std::isfinite(b) || std::min(a, b) < least_baseline) continue;
        if (std::abs(a - b) > bearable_stretch * std::max(a, b)) continue;
        said.push_back({target.angle(of, j) - source.angle(of, j), landmarks[j].weight});
    }
    return said;
}

std::optional<Complex> agreed_turn(const std::vector<Opinion>& said) {
    Complex best(0.0, 0.0);
    for (const Opinion& chosen : said) {
        Complex sum(0.0, 0.0);
        for (const Opinion& other : said) {
            if (std::abs(std::remainder(other.turn - chosen.turn, 2.0 * M_PI)) > same_turn) continue;
            sum += std::polar(other.weight, other.turn);
        }
        if (std::abs(sum) > std::abs(best)) best = sum;
    }
    return best == Complex(0.0, 0.0) ? std::nullopt : std::optional(unit(best));
}

}  // namespace

std::vector<OrientedMatch> landmark_seeds(const Pair& pair, const std::vector<Landmark>& landmarks,
                                          const FeatureOptions& options, int threads, Monitor& monitor, double at) {
    const auto count = static_cast<std::ptrdiff_t>(landmarks.size());
    std::vector<OrientedMatch> matches;
    if (count == 0) return matches;
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    const auto between = [&](const SampledMesh& side) {
        const auto& points = side.samples.point;
        return feature_geodesics(side.mesh, {points.begin(), points.begin() + count}, everywhere, threads, monitor, at,
                                 at);
    };
    const FeatureGeodesics source = between(pair.source), target = between(pair.target);
    for (int i = 0; i < static_cast<int>(count); ++i) {
        const PolarDescriptor &a = pair.source_descriptor[i], &b = pair.target_descriptor[i];
        const BestShift best = best_shift(a, b, options);
        Complex rotation = rotation_of(best.shift);
        if (const auto turn = agreed_turn(opinions(source, target, landmarks, i))) {
            const double there = descriptor_distance(a, b, shift_of(*turn), options);
            if (there - best.distance < indifferent * pair.chance) rotation = *turn;
        }
        matches.push_back({i, pair.target.samples.point[i], rotation, 0.0});
    }
    return matches;
}

}  // namespace isograft
