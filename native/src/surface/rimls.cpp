// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/rimls.h"

#include <algorithm>
#include <cmath>

namespace isograft {

namespace {

constexpr double precision = 1e-4;
constexpr int fewest = 4;

}  // namespace

struct Rimls::Value {
    double f = 0.0;
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double spacing = 0.0;
    bool known = false;
};

Rimls::Rimls(const KdTree& tree, const std::vector<Eigen::Vector3d>& normal, const std::vector<double>& spacing,
             const RimlsOptions& options)
    : tree_(&tree), normal_(&normal), spacing_(&spacing), options_(options) {}

Rimls::Value Rimls::value(const Eigen::Vector3d& x, const Eigen::Vector3d& side) const {
    Value value;
    std::vector<KdTree::Found> found;
    tree_->nearest(x, 1, found);
    value.spacing = (*spacing_)[found.front().index];
    const double support = options_.support * value.spacing;
    tree_->within(x, support, found);
    const std::vector<Eigen::Vector3d>& points = tree_->points();
    const auto gone = [&](const KdTree::Found& f) { return (*normal_)[f.index].dot(side) <= 0.0; };
    found.erase(std::remove_if(found.begin(), found.end(), gone), found.end());
    if (found.size() < fewest) return value;
    Eigen::Vector3d gradient = side;
    double f = 0.0;
    const double residual = options_.residual * value.spacing;
    for (int refit = 0; refit <= options_.refits; ++refit) {
        double sum = 0.0, sum_f = 0.0;
        Eigen::Vector3d sum_gradient = Eigen::Vector3d::Zero(), sum_f_gradient = Eigen::Vector3d::Zero(),
                        sum_normal = Eigen::Vector3d::Zero();
        for (const KdTree::Found& item : found) {
            const Eigen::Vector3d& n = (*normal_)[item.index];
            const Eigen::Vector3d d = x - points[item.index];
            const double height = d.dot(n);
            double trust = std::exp(-(n - gradient).squaredNorm() / (options_.normal * options_.normal));
            // There is no surface to be off yet.
            if (refit > 0) trust *= std::exp(-(height - f) * (height - f) / (residual * residual));
            const double rest = 1.0 - item.squared_distance / (support * support);
            const double weight = trust * rest * rest * rest * rest;
            const Eigen::Vector3d slope = trust * -8.0 * rest * rest * rest / (support * support) * d;
            sum += weight;
            sum_f += weight * height;
            sum_gradient += slope;
            sum_f_gradient += slope * height;
            sum_normal += weight * n;
        }
        if (!(sum > 1e-12)) return value;
        const double previous = f;
        f = sum_f / sum;
        gradient = (sum_f_gradient - f * sum_gradient + sum_normal) / sum;
        if (refit > 0 && std::abs(f - previous) < 0.1 * precision * value.spacing) break;
    }
    value.f = f;
    value.gradient = gradient;
    value.known = gradient.squaredNorm() > 1e-6;
    return value;
}

Rimls::Projection Rimls::project(const Eigen::Vector3d& x, const Eigen::Vector3d& side) const {
    Projection result{x, side, false};
    for (int step = 0; step < options_.steps; ++step) {
        const Value v = value(result.position, result.normal);
        if (!v.known) return result;
        const double norm = v.gradient.norm();
        result.normal = v.gradient / norm;
        // f is a distance near the surface; its gradient far from it is not a unit vector.
        result.position -= std::clamp(v.f / std::max(norm, 0.5), -v.spacing, v.spacing) * result.normal;
        if (std::abs(v.f) < precision * v.spacing) {
            result.converged = true;
            return result;
        }
    }
    return result;
}

}  // namespace isograft
