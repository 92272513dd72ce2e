// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/choice.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>

#include "base/rotation.h"

namespace isograft {

namespace {

// What a wrong sample costs in right ones.
constexpr double price = 4.0;
// Variance of the squashed curvature below which a surface is flat; bodies, faces and scans have 0.02 to 0.2.
constexpr double flat = 1e-4;
// Surroundings that a bent joint does not yet take out of shape.
constexpr double rigid_reach = 0.16;

std::optional<double> rigid_residual(const Pair& pair, const PartialMap& map, int sample) {
    const Samples& source = pair.source.samples;
    std::vector<int> around{sample};
    for (const int e : source.edges_of[sample]) {
        const int other = source.edges[e].other(sample);
        if (map.mapped[other] && source.edges[e].length < rigid_reach) around.push_back(other);
    }
    if (around.size() < 8) return std::nullopt;
    Eigen::Matrix3Xd p(3, around.size());
    Eigen::Matrix3Xd q(3, around.size());
    for (std::size_t i = 0; i < around.size(); ++i) {
        p.col(static_cast<Eigen::Index>(i)) = source.position[around[i]];
        q.col(static_cast<Eigen::Index>(i)) = map.position[around[i]];
    }
    p.colwise() -= p.rowwise().mean().eval();
    q.colwise() -= q.rowwise().mean().eval();
    const Eigen::Matrix3d rotation = rotation_of(p * q.transpose());
    return std::sqrt((rotation * p - q).squaredNorm() / std::max(1e-300, p.squaredNorm()));
}

struct Moments {
    double weight = 0.0, x = 0.0, y = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;

    void add(double w, double a, double b) {
        weight += w;
        x += w * a;
        y += w * b;
        xx += w * a * a;
        yy += w * b * b;
        xy += w * a * b;
    }
    [[nodiscard]] double correlation() const {
        if (weight <= 0.0) return 0.0;
        const double mx = x / weight;
        const double my = y / weight;
        const double of_x = xx / weight - mx * mx;
        const double of_y = yy / weight - my * my;
        // A flat surface has nothing to compare, and nothing that contradicts.
        if (std::min(of_x, of_y) < flat) return 1.0;
        const double spread = of_x * of_y;
        return spread > 1e-24 ? (xy / weight - mx * my) / std::sqrt(spread) : 0.0;
    }
};

}  // namespace

MapQuality measure_quality(const Pair& pair, const FeatureOptions& options, const PartialMap& map,
                           const std::vector<double>& doubts) {
    MapQuality quality;
    const Samples& source = pair.source.samples;
    Moments moments;
    double area = 0.0;
    double residual = 0.0;
    int rigid = 0;
    for (int s = 0; s < source.count(); ++s) {
        if (!map.mapped[s]) continue;
        const double w = source.area[s];
        area += w;
        quality.expected += w * std::max(0.0, 1.0 - price * doubts[s]);
        quality.mismatch += w * mismatch(pair, options, s, map.image[s], map.rotation[s]);
        const double a = field_at(pair.source.mesh, pair.source_curvature, source.point[s]);
        const double b = field_at(pair.target.mesh, pair.target_curvature, map.image[s]);
        moments.add(w, std::atan(options.squash * a), std::atan(options.squash * b));
        if (const auto r = rigid_residual(pair, map, s)) {
            residual += *r;
            ++rigid;
        }
    }
    quality.expected /= std::max(area, pair.source.mesh.area);
    quality.mismatch /= std::max(1e-300, area);
    quality.curvature = moments.correlation();
    quality.rigidity = residual / std::max(1, rigid);
    return quality;
}

double choice_score(const MapQuality& quality) {
    const double bent = std::sqrt(std::max(0.05, 1.0 - 3.0 * quality.rigidity));
    const double alike = std::sqrt(std::max(0.01, quality.curvature));
    return quality.expected * bent * alike;
}

}  // namespace isograft
