// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/doubt.h"

#include <algorithm>
#include <cmath>

namespace isograft {

namespace {
// Of a place that few patches speak of: little weight on both sides is no evidence.
constexpr double prior = 0.05;
}  // namespace

double doubt(const Evidence& e) {
    const double distances = std::log(0.01 + e.incompatibility);
    double odds = e.hearsay;
    if (e.drift >= 0.0 && e.whole) {
        // A limb taken for another fits where it lies: no drift is no evidence.
        odds += 6.05 + 1.89 * distances + 3.01 * std::max(0.0, e.drift - 0.1) - 3.40 * e.support;
    } else if (e.drift >= 0.0) {
        odds += 7.46 + 1.54 * distances + 1.05 * std::log(0.05 + e.mismatch) + 0.52 * std::log(0.01 + e.curvature) +
                1.73 * e.drift - 5.72 * e.support;
    } else if (e.whole) {
        odds += 6.05 + 1.89 * distances - 3.40 * e.support;
    } else {
        odds += 6.44 + 0.96 * distances + 1.04 * std::log(0.05 + e.mismatch) + 1.18 * std::log(0.01 + e.curvature) -
                3.07 * e.support;
    }
    return 1.0 / (1.0 + std::exp(-odds));
}

Support::Support(const std::vector<Patch>& patches, int samples, double radius, double decay)
    : says_(samples), radius_(radius) {
    for (const Patch& patch : patches) {
        const PartialMap& map = patch.map;
        for (int s = 0; s < samples; ++s) {
            if (!map.mapped[s]) continue;
            const double weight = std::exp(-2.0 * patch.quality - map.seed_distance[s] / (2.0 * decay));
            says_[s].push_back({map.position[s], weight});
        }
    }
}

double Support::share(int sample, const Eigen::Vector3d& x) const {
    double all = 2.0 * prior;
    double here = prior;
    for (const Say& say : says_[sample]) {
        all += say.weight;
        if ((say.position - x).squaredNorm() < radius_ * radius_) here += say.weight;
    }
    return here / all;
}

double Support::rival(int sample, const Eigen::Vector3d& x) const {
    double all = 2.0 * prior;
    double most = 0.0;
    for (const Say& say : says_[sample]) all += say.weight;
    for (const Say& there : says_[sample]) {
        if ((there.position - x).norm() < 2.0 * radius_) continue;
        double sum = 0.0;
        for (const Say& say : says_[sample]) {
            if ((say.position - there.position).squaredNorm() < radius_ * radius_) sum += say.weight;
        }
        most = std::max(most, sum);
    }
    return (prior + most) / all;
}

}  // namespace isograft
