// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/trials.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace isograft {

const Trial& Trials::of(const TrialSeed& seed, Grower& grower) {
    const std::array<int, 3> key{seed.source, seed.target, seed.shift};
    {
        const std::lock_guard lock(mutex_);
        const auto found = made_.find(key);
        if (found != made_.end()) return found->second;
    }
    const OrientedMatch match{seed.source, pair_.target.samples.point[seed.target], rotation_of(seed.shift), 0.0};
    const Patch patch = probe(pair_, settings_, grower, match, size_);
    Trial trial;
    trial.quality = patch.quality;
    trial.misfit = mean_mismatch(pair_, settings_.feature, patch.map);
    for (int s = 0; s < pair_.source.samples.count(); ++s) {
        if (patch.map.mapped[s] == 0) continue;
        trial.held.push_back({s, patch.map.image[s], patch.map.position[s], patch.map.rotation[s]});
    }
    const std::lock_guard lock(mutex_);
    return made_.emplace(key, std::move(trial)).first->second;
}

void Trials::prepare(const std::vector<TrialSeed>& seeds, int threads, Piece progress) {
    const int workers = std::min(worker_count(threads), static_cast<int>(seeds.size()));
    std::vector<Grower> growers;
    growers.reserve(workers);
    for (int w = 0; w < workers; ++w) growers.emplace_back(pair_.source.samples, pair_.target, settings_.growth);
    std::vector<Piece> pieces = progress.split(1.0, seeds.size());
    parallel_for(
        static_cast<int>(seeds.size()), threads,
        [&](int i, int worker) {
            of(seeds[i], growers[worker]);
            pieces[i].reach(1.0);
        },
        progress.monitor());
}

PartialMap to_map(const Trial& trial, const TrialSeed& seed, const Pair& pair) {
    PartialMap map(pair.source.samples.count());
    map.seed = seed.source;
    for (const Trial::Held& h : trial.held) map.put(pair.target.mesh, h.sample, h.image, h.rotation);
    measure_seed_distance(pair.source.samples, map);
    return map;
}

}  // namespace isograft
