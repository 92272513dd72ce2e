// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/patches.h"

#include <algorithm>
#include <memory>
#include <numeric>

#include "base/parallel.h"

namespace isograft {

namespace {

// Patches worse than this are kept only while there are few.
constexpr double poor_quality = 0.9;
constexpr int few_patches = 20;

std::vector<std::unique_ptr<Grower>> make_growers(const Pair& pair, const PatchSettings& settings) {
    std::vector<std::unique_ptr<Grower>> growers;
    for (int w = 0; w < worker_count(settings.threads); ++w) {
        growers.push_back(std::make_unique<Grower>(pair.source.samples, pair.target, settings.growth));
    }
    return growers;
}

}  // namespace

double better_half(std::vector<double> quality) {
    std::sort(quality.begin(), quality.end());
    const std::size_t half = std::max<std::size_t>(1, quality.size() / 2);
    return std::accumulate(quality.begin(), quality.begin() + static_cast<std::ptrdiff_t>(half), 0.0) /
           static_cast<double>(half);
}

double mean_mismatch(const Pair& pair, const FeatureOptions& options, const PartialMap& map) {
    double sum = 0.0;
    for (int s = 0; s < pair.source.samples.count(); ++s) {
        if (map.mapped[s]) sum += mismatch(pair, options, s, map.image[s], map.rotation[s]);
    }
    return sum / std::max(1, map.count);
}

Patch probe(const Pair& pair, const PatchSettings& settings, Grower& grower, const OrientedMatch& match, int size) {
    Patch patch;
    patch.map = PartialMap(pair.source.samples.count());
    patch.map.seed = match.sample;
    patch.map.put(pair.target.mesh, match.sample, match.point, match.rotation);
    GrowthRun run;
    run.max_samples = size;
    grower.grow(patch.map, run);
    const double full = std::min(1.0, static_cast<double>(patch.map.count) / size);
    patch.quality = mean_mismatch(pair, settings.feature, patch.map) + 2.0 * patch.map.stress + 0.7 * (1.0 - full);
    return patch;
}

std::vector<Patch> grow_patches(const Pair& pair, const PatchSettings& settings,
                                const std::vector<OrientedMatch>& matches, int forced, Monitor& monitor, double from,
                                double to) {
    const int count = std::min(static_cast<int>(matches.size()), settings.seed.probes + forced);
    const double middle = from + 0.18 * (to - from);
    const auto growers = make_growers(pair, settings);
    std::vector<Patch> probed(count);
    parallel_for(
        count, settings.threads,
        [&](int i, int worker) {
            probed[i] = probe(pair, settings, *growers[worker], matches[i], settings.seed.probe_size);
        },
        monitor, "probes", from, middle);

    std::vector<int> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin() + forced, order.end(),
                     [&](int a, int b) { return probed[a].quality < probed[b].quality; });
    std::vector<Patch> patches;
    for (int rank = 0; rank < count; ++rank) {
        const Patch& p = probed[order[rank]];
        const int kept = static_cast<int>(patches.size());
        if (rank >= forced && (kept >= settings.blend.patches || (p.quality > poor_quality && kept >= few_patches))) {
            break;
        }
        patches.push_back(p);
    }
    parallel_for(
        static_cast<int>(patches.size()), settings.threads,
        [&](int i, int worker) {
            PartialMap& map = patches[i].map;
            GrowthRun run;
            run.max_samples = settings.blend.patch_size;
            run.schedule = {0.6, 1.0};
            run.first_relax = 2 * map.count;
            growers[worker]->grow(map, run);
            measure_seed_distance(pair.source.samples, map);
        },
        monitor, "growth", middle, to);
    return patches;
}

}  // namespace isograft
