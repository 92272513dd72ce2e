// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/find_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "feature/curvature.h"
#include "feature/descriptor.h"
#include "isograft/errors.h"

namespace isograft {

void ScaleOptions::validate() const {
    if (!(value > 0.0) || !std::isfinite(value)) throw InvalidInput("scale.value must be positive");
    if (votes < 10 || votes > 10000) throw InvalidInput("scale.votes must be in [10, 10000]");
    if (probes < 10 || probes > 10000) throw InvalidInput("scale.probes must be in [10, 10000]");
}

namespace {

constexpr int sizes = 19;
constexpr double smallest = 0.4;
constexpr double step = 1.1;
constexpr int target_points = 600;
constexpr double smoothing_time = 4e-4;
// Two readings nearer than this agree.
constexpr double agreement = 0.07;
// A reading this near an exact ratio means that one: should it not, the seeds' distances tell later.
constexpr double snap = 0.1;

// Random points, evenly by area.
std::vector<SurfacePoint> scatter(const TriangleMesh& mesh, int count, Random& random) {
    std::vector<double> until(mesh.face_count());
    double total = 0.0;
    for (int f = 0; f < mesh.face_count(); ++f) {
        total += 0.5 * cross(mesh.corner[f][1], mesh.corner[f][2]);
        until[f] = total;
    }
    std::vector<SurfacePoint> points(count);
    for (SurfacePoint& p : points) {
        const auto found = std::lower_bound(until.begin(), until.end(), random.uniform() * total);
        p.face = std::min(mesh.face_count() - 1, static_cast<int>(found - until.begin()));
        const double r = std::sqrt(random.uniform());
        const double s = random.uniform();
        p.weight = {1.0 - r, r * (1.0 - s), r * s};
        for (double& w : p.weight) w = 0.94 * w + 0.02;
    }
    return points;
}

using Row = std::array<double, sizes>;

// Per size, how much nearer the best target point is than the best twentieth.
Row relative_fit(const TriangleMesh& mesh, const SurfacePoint& point, const std::vector<double>& curvature,
                 const std::vector<PolarDescriptor>& target, const FeatureOptions& features) {
    Row row{};
    std::vector<double> distance(target.size());
    for (int k = 0; k < sizes; ++k) {
        const double ratio = smallest * std::pow(step, k);
        const PolarDescriptor mine =
            ray_descriptor(mesh, point, curvature, features.radius / ratio, 1.0 / ratio, 0.0, features);
        for (std::size_t t = 0; t < target.size(); ++t) distance[t] = best_shift(mine, target[t], features).distance;
        const auto twentieth = distance.begin() + static_cast<std::ptrdiff_t>(target.size() / 20);
        std::nth_element(distance.begin(), twentieth, distance.end());
        const double usual = *twentieth;
        const double best = *std::min_element(distance.begin(), twentieth + 1);
        row[k] = usual < not_comparable ? best / std::max(usual, 1e-12) : 1.0;
    }
    return row;
}

// The place of the extremum between the sizes, by a parabola through it and its neighbours.
double between(const Row& values, int k) {
    double offset = 0.0;
    if (k > 0 && k + 1 < sizes) {
        const double bend = values[k - 1] - 2.0 * values[k] + values[k + 1];
        if (bend > 1e-12) offset = std::clamp(0.5 * (values[k - 1] - values[k + 1]) / bend, -0.5, 0.5);
    }
    return smallest * std::pow(step, k + offset);
}

Row mean_fit(const std::vector<Row>& rows) {
    Row mean{};
    for (int k = 0; k < sizes; ++k) {
        std::vector<double> column;
        for (const Row& row : rows) column.push_back(row[k]);
        std::sort(column.begin(), column.end());
        const std::size_t half = std::max<std::size_t>(1, column.size() / 2);
        for (std::size_t i = 0; i < half; ++i) mean[k] += column[i] / static_cast<double>(half);
    }
    return mean;
}

double ratio_by_vote(const std::vector<Row>& rows) {
    Row votes{};
    for (const Row& row : rows) {
        const auto best = static_cast<int>(std::min_element(row.begin(), row.end()) - row.begin());
        // A vote counts for its neighbours too, the more the surer it is.
        for (int k = std::max(0, best - 2); k <= std::min(sizes - 1, best + 2); ++k) {
            votes[k] -= (1.0 - row[best]) * std::exp(-0.5 * (k - best) * (k - best));
        }
    }
    return between(votes, static_cast<int>(std::min_element(votes.begin(), votes.end()) - votes.begin()));
}

bool near(double a, double b, double share) { return std::abs(std::log(a / b)) < share; }

}  // namespace

ScaleVotes vote_scale(const TriangleMesh& source, const TriangleMesh& target, const FeatureOptions& features,
                      const ScaleOptions& options, std::uint64_t seed, int threads, Monitor& monitor, double from,
                      double to) {
    const double source_side = std::sqrt(source.area);
    const double target_side = std::sqrt(target.area);
    const TriangleMesh s = scaled(source, 1.0 / source_side);
    const TriangleMesh t = scaled(target, 1.0 / target_side);
    std::array<std::vector<double>, 2> curvature;
    parallel_for(
        2, threads,
        [&](int i, int /*worker*/) { curvature[i] = mean_curvature(i == 0 ? s : t, smoothing_time, monitor); }, monitor,
        "scale", from, from + 0.2 * (to - from));
    const auto& [s_curvature, t_curvature] = curvature;
    Random random(seed);
    const auto s_points = scatter(s, options.votes, random);
    const auto t_points = scatter(t, target_points, random);
    std::vector<PolarDescriptor> descriptor(t_points.size());
    parallel_for(
        static_cast<int>(t_points.size()), threads,
        [&](int i, int /*worker*/) {
            descriptor[i] = ray_descriptor(t, t_points[i], t_curvature, features.radius, 1.0, 0.0, features);
        },
        monitor, "scale", from + 0.2 * (to - from), from + 0.25 * (to - from));
    std::vector<Row> rows(s_points.size());
    parallel_for(
        static_cast<int>(s_points.size()), threads,
        [&](int i, int /*worker*/) { rows[i] = relative_fit(s, s_points[i], s_curvature, descriptor, features); },
        monitor, "scale", from + 0.25 * (to - from), to);
    const Row fit = mean_fit(rows);
    const auto best = std::min_element(fit.begin(), fit.end());
    const double unit_ratio = target_side / source_side;
    return {between(fit, static_cast<int>(best - fit.begin())) * unit_ratio, ratio_by_vote(rows) * unit_ratio, *best};
}

bool votes_agree(const ScaleVotes& votes) { return near(votes.by_fit, votes.by_vote, agreement); }

std::vector<double> scale_candidates(const ScaleVotes& votes, const std::vector<double>& exact) {
    std::vector<double> heard{votes.by_fit};
    if (votes_agree(votes)) {
        heard[0] = std::sqrt(votes.by_fit * votes.by_vote);
    } else {
        heard.push_back(votes.by_vote);
    }
    std::vector<double> candidates;
    const auto add = [&](double ratio) {
        const bool known =
            std::any_of(candidates.begin(), candidates.end(), [&](double c) { return near(c, ratio, 0.015); });
        if (!known) candidates.push_back(ratio);
    };
    // Exact ratios beat measured ones.
    bool confirmed = heard.size() == 1;
    for (const double h : heard) {
        const auto found = std::find_if(exact.begin(), exact.end(), [&](double e) { return near(e, h, snap); });
        add(found != exact.end() ? *found : h);
        confirmed = confirmed && found != exact.end();
    }
    // Doubtful votes do not rule the exact ones out.
    if (!confirmed) {
        for (const double ratio : exact) add(ratio);
    }
    return candidates;
}

}  // namespace isograft
