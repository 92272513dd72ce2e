// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/blend.h"

#include <limits>
#include <memory>

#include "base/parallel.h"
#include "blend/completion.h"
#include "blend/core.h"

namespace isograft {

namespace {

// A map worse than this fits no better than chance would: nothing is matched then. Right maps of noisy one-sided scans
// reach 0.4 and 0.75.
constexpr double most_mismatch = 0.6;
constexpr double least_curvature = 0.35;

struct Contender {
    std::unique_ptr<Completion> completion;
    /// After the free extension.
    PartialMap free;
    MapQuality quality;
    double score = -1.0;
};

void complete(Contender& contender, const Core& core, const Pair& pair, const PatchSettings& settings) {
    Completion& completion = *contender.completion;
    completion.start(core);
    for (int round = 0; round < settings.blend.rounds; ++round) {
        if (!completion.second_pass()) break;
    }
    // How far a core reaches without a check says most about it, so it is judged after a free extension.
    const PartialMap careful = completion.map();
    completion.extend(std::numeric_limits<double>::infinity());
    contender.quality = measure_quality(pair, settings.feature, completion.map());
    contender.score = choice_score(contender.quality, core.vote);
    contender.free = completion.map();
    completion.map() = careful;
}

// Cores share no patch, so another one that leads to much the same map is a second opinion on the rest of it.
std::vector<PartialMap> witnesses(const std::vector<Contender>& contenders, std::size_t best, double radius) {
    std::vector<PartialMap> result;
    const PartialMap& chosen = contenders[best].free;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        if (i == best) continue;
        const PartialMap& other = contenders[i].free;
        int shared = 0;
        int agreed = 0;
        for (std::size_t s = 0; s < chosen.mapped.size(); ++s) {
            if (!chosen.mapped[s] || !other.mapped[s]) continue;
            ++shared;
            agreed += (chosen.position[s] - other.position[s]).norm() < radius ? 1 : 0;
        }
        if (5 * agreed > 3 * shared && shared > 0) result.push_back(other);
    }
    return result;
}

// The surest parts first: what a careful round adds helps to judge the next one.
void extend_carefully(Completion& completion, double accept) {
    completion.trim(1.0);
    for (int round = 0; round < 3; ++round) {
        const int before = completion.map().count;
        completion.extend(0.8 * accept);
        completion.trim(0.6 * accept);
        completion.second_pass();
        completion.trim(0.6 * accept);
        if (completion.map().count <= before + 2) break;
    }
    completion.extend(accept);
    completion.trim(0.8 * accept);
}

}  // namespace

Blended blend(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches, Monitor& monitor,
              double from, double to) {
    Blended result;
    result.map = PartialMap(pair.source.samples.count());
    const std::vector<Core> cores = find_cores(patches, settings.blend);
    if (cores.empty()) {
        result.risk.assign(pair.source.samples.count(), 0.0);
        return result;
    }
    std::vector<Contender> contenders(cores.size());
    Trials trials(pair, settings, 2 * settings.seed.probe_size);
    const double middle = from + 0.6 * (to - from);
    parallel_for(
        static_cast<int>(cores.size()), settings.threads,
        [&](int i, int /*worker*/) {
            contenders[i].completion = std::make_unique<Completion>(pair, settings, patches, trials, monitor);
            complete(contenders[i], cores[i], pair, settings);
        },
        monitor, "blend", from, middle);
    std::size_t best = 0;
    for (std::size_t i = 1; i < contenders.size(); ++i) {
        if (contenders[i].score > contenders[best].score) best = i;
    }
    result.quality = contenders[best].quality;
    result.maps_in_core = cores[best].count;
    if (result.quality.mismatch > most_mismatch || result.quality.curvature < least_curvature) {
        result.risk.assign(pair.source.samples.count(), 0.0);
        monitor.report("blend", to);
        return result;
    }
    Completion& completion = *contenders[best].completion;
    completion.hear(witnesses(contenders, best, settings.blend.agreement_radius));
    extend_carefully(completion, settings.blend.accept);
    completion.place_anchors();
    result.risk = completion.ring_risk();
    result.map = completion.map();
    monitor.report("blend", to);
    return result;
}

}  // namespace isograft
