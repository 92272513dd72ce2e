// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/blend.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "base/piece.h"
#include "blend/completion.h"
#include "blend/contest.h"
#include "blend/core.h"
#include "blend/landmarks.h"
#include "blend/pocket.h"

namespace isograft {

namespace {

// A map worse than this fits no better than chance would: nothing is matched then. Right maps of noisy one-sided scans
// reach 0.4 and 0.75.
constexpr double most_mismatch = 0.6;
constexpr double least_curvature = 0.35;
// Of the best score: what reaches it is extended carefully too, which has made the best of one at three fifths of it.
constexpr double worth_extending = 0.5;

bool fits(const MapQuality& quality) {
    return quality.mismatch <= most_mismatch && quality.curvature >= least_curvature;
}

struct Contender {
    std::unique_ptr<Completion> completion;
    /// Before and after the free extension.
    PartialMap careful, free;
    MapQuality quality;
    Heed heed;
    double score = -1.0;
    /// After the careful extension.
    double worth = 0.0;

    // Landmarks outweigh what the surfaces say: a plane has no shape that could fit.
    [[nodiscard]] bool believable() const { return fits(quality) || heed.vouched(); }
};

void complete(Contender& contender, const Core& core, const Pair& pair, const PatchSettings& settings, Piece progress) {
    const int rounds = settings.blend.rounds;
    Completion& completion = *contender.completion;
    completion.start(core);
    progress.reach(0.1);
    for (int round = 0; round < rounds; ++round) {
        const double share = 0.7 * (round + 1) / rounds;
        if (!completion.second_pass(progress.until(0.1 + share))) break;
    }
    progress.reach(0.8);
    // How far a core reaches without a check says most about it, so it is judged after a free extension; and not by its
    // worth(), since what reaches too far tears.
    contender.careful = completion.map();
    completion.extend(1.0);
    progress.reach(0.95);
    contender.quality = completion.quality();
    contender.heed = heed(completion.map(), pair, settings.landmarks);
    contender.score = choice_score(contender.quality) * contender.heed.share;
    contender.free = completion.map();
    progress.reach(1.0);
}

// Share of the samples that two maps have in common which they put in the same place; nothing if they share too few.
std::optional<double> agreement(const Overlap& overlap) {
    constexpr int fewest = 10;
    if (overlap.shared < fewest) return std::nullopt;
    return static_cast<double>(overlap.agreed) / overlap.shared;
}

std::optional<double> agreement(const PartialMap& a, const PartialMap& b, double radius) {
    return agreement(overlap_of(a, b, radius));
}

// Whether two cores came to much the same map.
bool alike(const Contender& a, const Contender& b, double radius) {
    const auto share = agreement(a.free, b.free, radius);
    return share && *share > 0.6;
}

// Whether two maps put what they share in different places.
bool contradict(const PartialMap& a, const PartialMap& b, double radius) {
    const auto share = agreement(a, b, radius);
    return share && *share < 0.4;
}

// Cores share no patch, so another one that leads to much the same map is a second opinion on the rest of it.
std::vector<PartialMap> witnesses(const std::vector<Contender>& contenders, std::size_t chosen, double radius) {
    std::vector<PartialMap> result;
    for (std::size_t i = 0; i < contenders.size(); ++i) {
        if (i != chosen && alike(contenders[chosen], contenders[i], radius)) result.push_back(contenders[i].free);
    }
    return result;
}

// Whether two maps are one and the same but for their ends.
bool coincide(const PartialMap& a, const PartialMap& b, double radius) {
    constexpr double nearly_all = 0.95;  // of what both have
    constexpr double most = 0.8;         // of the larger one
    const Overlap overlap = overlap_of(a, b, radius);
    const auto share = agreement(overlap);
    return share && *share >= nearly_all && overlap.shared >= most * std::max(a.count, b.count);
}

// Whether weaker cores would not change the map any more: the two strongest came to one that is worth enough, or to
// the very same that is worth something. (Of 90 third cores beside two that coincide, of 172 pairs, three led elsewhere
// and were worth more: two by a twentieth, one where the map was worth a twentieth of a good one.)
bool settled(const Contender& a, const Contender& b, const BlendOptions& options) {
    constexpr double something = 0.25;  // of a good map
    const double score = std::max(a.score, b.score);
    if (score >= options.content) return alike(a, b, options.agreement_radius);
    return score >= something * options.content && coincide(a.free, b.free, options.agreement_radius);
}

// Whether the strongest core of this search came to the map of an earlier one, and `map` is still that.
bool confirmed(const std::vector<Contender>& contenders, const std::vector<Patch>& patches,
               const std::vector<Core>& cores, const PartialMap& map, const BlendOptions& options) {
    const auto carried = std::find_if(cores.begin(), cores.end(), [](const Core& core) { return core.carried; });
    const auto own = std::find_if(cores.begin(), cores.end(), [](const Core& core) { return !core.carried; });
    if (carried == cores.end() || own == cores.end()) return false;
    const Contender& here = contenders[own - cores.begin()];
    if (!settled(here, contenders[carried - cores.begin()], options)) return false;
    // As it came, before this search's patches were heard.
    const auto member = std::find(carried->member.begin(), carried->member.end(), char{1}) - carried->member.begin();
    const PartialMap& earlier = patches[member].map;
    return coincide(here.free, earlier, options.agreement_radius) && coincide(map, earlier, options.agreement_radius);
}

// The best contender, then those that contradict it and each other and may yet be worth more, by falling score.
std::vector<std::size_t> rank(const std::vector<Contender>& contenders, const BlendOptions& options) {
    std::vector<std::size_t> order(contenders.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return contenders[a].score > contenders[b].score; });
    const double enough = std::min(worth_extending, options.alternative);
    std::vector<std::size_t> ranked;
    for (const std::size_t i : order) {
        const bool another = std::all_of(ranked.begin(), ranked.end(), [&](std::size_t k) {
            return contradict(contenders[k].free, contenders[i].free, options.agreement_radius);
        });
        const bool near = ranked.empty() || contenders[i].score > enough * contenders[ranked[0]].score;
        if (another && near && contenders[i].believable()) ranked.push_back(i);
        if (ranked.empty()) break;
    }
    return ranked;
}

// The best, then those that nearly reach it and, as they are now, contradict it and each other, by falling fit.
std::vector<Blended> still_alternatives(std::vector<Blended> all, const BlendOptions& options) {
    std::stable_sort(all.begin(), all.end(), [](const Blended& a, const Blended& b) { return a.fit > b.fit; });
    std::vector<Blended> result;
    for (Blended& candidate : all) {
        const bool near = result.empty() || candidate.fit > options.alternative * result.front().fit;
        const bool another = std::all_of(result.begin(), result.end(), [&](const Blended& other) {
            return contradict(other.map, candidate.map, options.agreement_radius);
        });
        if (near && another) result.push_back(std::move(candidate));
    }
    return result;
}

}  // namespace

std::vector<Blended> blend(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches,
                           const std::vector<Core>& cores, Monitor& monitor, double from, double middle, double to) {
    std::vector<Contender> contenders(cores.size());
    Trials trials(pair, settings, 2 * settings.seed.probe_size);
    DistanceFields fields(pair);
    const DriftFinder drift(pair, settings.feature);
    monitor.report("blend", from);
    const double part = (middle - from) / std::max<double>(1.0, static_cast<double>(cores.size()));
    const int threads = worker_count(settings.threads);
    const auto complete_cores = [&](std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i) {
            contenders[i].completion =
                std::make_unique<Completion>(pair, settings, patches, trials, fields, drift, monitor);
        }
        // Whoever is through leaves its threads to the others.
        std::atomic<int> open = static_cast<int>(end - first);
        const auto share_threads = [&] {
            const int left = open.load();
            for (std::size_t i = first; left > 0 && left <= threads && i < end; ++i) {
                contenders[i].completion->take_threads(threads / left);
            }
        };
        share_threads();
        parallel_for(
            static_cast<int>(end - first), threads,
            [&](int i, int /*worker*/) {
                complete(contenders[first + i], cores[first + i], pair, settings, Piece(monitor, part));
                --open;
                share_threads();
            },
            monitor, "blend", monitor.fraction(), monitor.fraction());
    };
    constexpr std::size_t strongest = 2;
    complete_cores(0, std::min(strongest, cores.size()));
    if (cores.size() > strongest) {
        if (settled(contenders[0], contenders[1], settings.blend)) {
            contenders.resize(strongest);
        } else {
            complete_cores(strongest, cores.size());
        }
    }
    monitor.report("blend", middle);
    std::vector<std::size_t> ranked = rank(contenders, settings.blend);
    std::vector<Blended> result(std::max<std::size_t>(1, ranked.size()));
    const int share = std::max(1, threads / std::max(1, static_cast<int>(ranked.size())));
    // Contests take nothing or as much again, and more where a map is bad.
    const double extending = 0.5 * (to - middle);
    parallel_for(
        static_cast<int>(ranked.size()), settings.threads,
        [&](int i, int /*worker*/) {
            Contender& chosen = contenders[ranked[i]];
            Completion& completion = *chosen.completion;
            completion.take_threads(share);
            completion.hear(witnesses(contenders, ranked[i], settings.blend.agreement_radius));
            completion.map() = chosen.careful;
            completion.extend_carefully(settings.blend.careful_rounds,
                                        Piece(monitor, extending / static_cast<double>(ranked.size())));
            chosen.worth = completion.worth();
        },
        monitor, "blend", middle, middle);
    // What they were ranked by was measured before the careful extension, which may turn them round.
    std::stable_sort(ranked.begin(), ranked.end(),
                     [&](std::size_t a, std::size_t b) { return contenders[a].worth > contenders[b].worth; });
    if (!ranked.empty()) {
        Contender& first = contenders[ranked[0]];
        first.completion->take_threads(threads);
        first.completion =
            contest(std::move(first.completion), first.worth, pair, settings, Piece(monitor, to - middle - extending));
    }
    const int landmarks = static_cast<int>(settings.landmarks.size());
    parallel_for(
        static_cast<int>(ranked.size()), settings.threads,
        [&](int i, int /*worker*/) {
            Contender& chosen = contenders[ranked[i]];
            Completion& completion = *chosen.completion;
            completion.take_threads(share);
            // Only what is contested is held to account for what it doubles, if there is ground for a contest.
            const double fit = i == 0 ? completion.worth() : chosen.worth;
            fill_pockets(completion.map(), pair, landmarks, completion.threads(), monitor);
            completion.place_anchors();
            result[i] = {completion.map(), completion.doubts(), cores[ranked[i]].count, fit};
        },
        monitor, "blend", middle, middle);
    result = still_alternatives(std::move(result), settings.blend);
    monitor.report("blend", to);
    if (!ranked.empty()) {
        result[0].confirmed = confirmed(contenders, patches, cores, result[0].map, settings.blend);
    } else {
        result[0].map = PartialMap(pair.source.samples.count());
        result[0].risk.assign(pair.source.samples.count(), 0.0);
    }
    return result;
}

}  // namespace isograft
