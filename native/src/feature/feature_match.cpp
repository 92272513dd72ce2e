// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/feature_match.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/parallel.h"
#include "geodesic/window.h"

namespace isograft {

namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
// F is 0 where all descriptors are equal; nothing is less distinct.
constexpr double least_distinct = 1e-12;
}  // namespace

FeatureGeodesics feature_geodesics(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points, double reach,
                                   int threads, Monitor& monitor, double from, double to) {
    const auto n = static_cast<Eigen::Index>(points.size());
    FeatureGeodesics result{Eigen::MatrixXd::Constant(n, n, infinity), Eigen::MatrixXd::Zero(n, n)};
    std::vector<Window> windows(worker_count(threads), Window(mesh));
    parallel_for(
        static_cast<int>(n), threads,
        [&](int i, int worker) {
            Window& window = windows[worker];
            window.run(points[i], std::isfinite(reach) ? 1.05 * reach + mesh.mean_edge : reach);
            for (Eigen::Index j = 0; j < n; ++j) {
                const auto polar = window.query(points[j]);
                if (!polar || polar->distance > reach) continue;
                result.distance(i, j) = polar->distance;
                result.angle(i, j) = polar->angle;
            }
            result.distance(i, i) = 0.0;
        },
        monitor, "features", from, to);
    return result;
}

std::vector<FeatureMatch> candidate_matches(const FeatureSet& source, const FeatureSet& target, int candidates,
                                            double weight) {
    std::vector<FeatureMatch> matches;
    const Eigen::Index count = target.descriptor.rows();
    std::vector<int> order(count);
    for (Eigen::Index s = 0; s < source.descriptor.rows(); ++s) {
        const Eigen::VectorXd squared =
            (target.descriptor.rowwise() - source.descriptor.row(s)).rowwise().squaredNorm();
        std::iota(order.begin(), order.end(), 0);
        const auto kept = std::min<Eigen::Index>(candidates, count);
        std::partial_sort(order.begin(), order.begin() + kept, order.end(),
                          [&](int a, int b) { return squared[a] != squared[b] ? squared[a] < squared[b] : a < b; });
        const double rarity = std::log(std::max(source.distinctiveness[s], least_distinct));
        for (Eigen::Index k = 0; k < kept; ++k) {
            const double d = -rarity + weight * squared[order[k]];
            matches.push_back({static_cast<int>(s), order[k], d, infinity});
        }
    }
    return matches;
}

std::vector<std::vector<int>> cluster_matches(std::vector<FeatureMatch>& matches, const FeatureGeodesics& source,
                                              const FeatureGeodesics& target, const ClusterOptions& options,
                                              Monitor& monitor) {
    std::vector<std::vector<int>> clusters;
    const auto count = static_cast<int>(matches.size());
    std::vector<std::vector<int>> of_feature(source.distance.rows());
    for (int m = 0; m < count; ++m) {
        matches[m].priority = infinity;
        of_feature[matches[m].source].push_back(m);
    }
    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return matches[a].dissimilarity < matches[b].dissimilarity; });
    const auto stretch = [&](int a, int b) {
        const double d = source.distance(matches[a].source, matches[b].source) -
                         target.distance(matches[a].target, matches[b].target);
        return std::isfinite(d) ? options.weight * d * d : infinity;
    };
    std::vector<double> value(count);
    std::vector<char> near(source.distance.rows());
    int members = 0;
    for (int start : order) {
        if (members > count) break;
        monitor.check();
        std::vector<int> cluster;
        std::fill(near.begin(), near.end(), 0);
        for (int m = 0; m < count; ++m) value[m] = matches[m].dissimilarity;
        for (int next = start; next >= 0;) {
            cluster.push_back(next);
            const int feature = matches[next].source;
            for (std::size_t f = 0; f < near.size(); ++f) {
                if (near[f] == 0 && source.distance(feature, static_cast<Eigen::Index>(f)) < options.reach) near[f] = 1;
            }
            near[feature] = 2;  // in the cluster
            const int joined = next;
            next = -1;
            double least = options.limit;
            for (std::size_t f = 0; f < near.size(); ++f) {
                if (near[f] == 2) continue;
                for (const int m : of_feature[f]) {
                    value[m] += stretch(joined, m);
                    if (near[f] != 1 || value[m] >= least) continue;
                    least = value[m];
                    next = m;
                }
            }
        }
        for (const int m : cluster) {
            double d = matches[m].dissimilarity;
            for (const int other : cluster) d += other == m ? 0.0 : stretch(other, m);
            matches[m].priority = std::min(matches[m].priority, d);
        }
        members += static_cast<int>(cluster.size());
        clusters.push_back(std::move(cluster));
    }
    return clusters;
}

}  // namespace isograft
