// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/core_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "geodesic/window.h"

namespace isograft {

namespace {

constexpr int most_seeds = 24;
// Nearer seeds tell more of their own inexactness than of the scale.
constexpr double shortest = 0.2;
constexpr int fewest_ratios = 6;

struct Seed {
    SurfacePoint on_source;
    SurfacePoint on_target;
    Eigen::Vector3d position;
};

// The seeds of the best members, spread out.
std::vector<Seed> spread_seeds(const Pair& pair, const std::vector<Patch>& patches, const Core& core) {
    std::vector<Seed> all;
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const PartialMap& map = patches[i].map;
        if (!core.member[i] || map.seed < 0 || !map.mapped[map.seed]) continue;
        all.push_back(
            {pair.source.samples.point[map.seed], map.image[map.seed], pair.source.samples.position[map.seed]});
    }
    std::vector<Seed> chosen;
    std::vector<double> nearest(all.size(), std::numeric_limits<double>::max());
    std::size_t next = 0;
    while (!all.empty() && chosen.size() < most_seeds && nearest[next] > 1e-9) {
        chosen.push_back(all[next]);
        for (std::size_t i = 0; i < all.size(); ++i) {
            nearest[i] = std::min(nearest[i], (all[i].position - chosen.back().position).norm());
        }
        next = static_cast<std::size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    }
    return chosen;
}

std::optional<double> straight_distance(const TriangleMesh& mesh, const Window& window, const SurfacePoint& to) {
    for (const int v : mesh.face[to.face]) {
        if (!window.has(v) || window.bent(v)) return std::nullopt;
    }
    const auto polar = window.query(to);
    if (!polar) return std::nullopt;
    return polar->distance;
}

}  // namespace

CoreScale measure_core_scale(const Pair& pair, const std::vector<Patch>& patches, const Core& core, Monitor& monitor) {
    const std::vector<Seed> seeds = spread_seeds(pair, patches, core);
    Window source_window(pair.source.mesh);
    Window target_window(pair.target.mesh);
    std::vector<double> ratios;
    constexpr double everywhere = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < seeds.size(); ++i) {
        monitor.check();
        source_window.run(seeds[i].on_source, everywhere);
        target_window.run(seeds[i].on_target, everywhere);
        for (std::size_t j = i + 1; j < seeds.size(); ++j) {
            const auto on_source = straight_distance(pair.source.mesh, source_window, seeds[j].on_source);
            const auto on_target = straight_distance(pair.target.mesh, target_window, seeds[j].on_target);
            if (on_source && on_target && std::min(*on_source, *on_target) > shortest) {
                ratios.push_back(std::log(*on_target / *on_source));
            }
        }
    }
    if (ratios.size() < fewest_ratios) return {};
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    const double median = *middle;
    for (double& r : ratios) r = std::abs(r - median);
    std::nth_element(ratios.begin(), middle, ratios.end());
    // Seeds are independent, their pairs are not.
    return {std::exp(median), 1.5 * *middle / std::sqrt(static_cast<double>(seeds.size()))};
}

}  // namespace isograft
