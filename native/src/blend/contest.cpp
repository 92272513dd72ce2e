// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/contest.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "base/parallel.h"
#include "blend/vacancy.h"

namespace isograft {

namespace {

// Of T's area; what growth leaves out at rims and tips is less.
constexpr double least_vacancy = 0.01;
// A map worth more leaves out no limb that is smaller than this: of 35 such claims four gained, 1.8 per cent at most.
constexpr double beyond_limbs = 0.75;
constexpr double least_limb = 0.05;
// Of S's area.
constexpr double least_dispute = 0.02;
// A map worth more is right where patches contradict it: of a dozen such disputes none gained two per cent.
constexpr double beyond_dispute = 0.7;
constexpr int most_contests = 9;
// Of extension after a claim: what it leaves out is contested in turn.
constexpr int rounds_of_a_claim = 1;
// Without a gain, one after the other.
constexpr int most_failures = 3;
// A claim must be worth more than the map by this factor.
constexpr double margin = 1.01;
// What a claim leaves of the map must, before it is extended, be worth this share of the map, sample for sample. Of 182
// claims below that, of 102 pairs, 13 would have won; 9 of 84 rounds lose their only winner, a fourteenth of all gain.
constexpr double promising = 0.8;

// The same part but for its rim.
bool same_part(const std::vector<int>& a, const std::vector<int>& b) {
    std::vector<int> shared;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    return 5 * shared.size() > 4 * std::max(a.size(), b.size());
}

// What a claim is about.
struct Ground {
    /// Nothing came to a part of T; else a part of S that most patches put elsewhere.
    bool vacant;
    std::vector<int> part;
};

std::vector<Ground> grounds(const Completion& completion, const Pair& pair, double worth) {
    std::vector<Ground> result;
    const double least = worth > beyond_limbs ? least_limb : least_vacancy;
    for (std::vector<int>& part : vacant_parts(pair, completion.map(), least)) {
        result.push_back({true, std::move(part)});
    }
    if (worth > beyond_dispute) return result;
    for (std::vector<int>& part : completion.disputed_parts(least_dispute)) result.push_back({false, std::move(part)});
    return result;
}

}  // namespace

std::unique_ptr<Completion> contest(std::unique_ptr<Completion> completion, double worth, const Pair& pair,
                                    const PatchSettings& settings, Piece progress) {
    std::vector<Ground> open = grounds(*completion, pair, worth);
    if (open.empty()) return completion;
    completion->be_exclusive();
    double best = completion->worth();
    const int threads = worker_count(settings.threads);
    std::vector<Ground> settled;
    int failures = 0;
    bool changed = false;
    for (int round = 0; round < most_contests && failures < most_failures; ++round) {
        progress.reach(static_cast<double>(round) / (most_contests + 1));
        const auto next = std::find_if(open.begin(), open.end(), [&](const Ground& ground) {
            return std::none_of(settled.begin(), settled.end(), [&](const Ground& old) {
                return old.vacant == ground.vacant && same_part(ground.part, old.part);
            });
        });
        if (next == open.end()) break;
        Piece asking = progress.until((round + 0.3) / (most_contests + 1));
        const std::vector<std::vector<double>> claims =
            next->vacant ? completion->claims(next->part, asking) : completion->dissent(next->part, asking);
        std::vector<std::unique_ptr<Completion>> tries(claims.size());
        std::vector<double> scores(claims.size(), 0.0);
        std::vector<Piece> pieces = progress.split(static_cast<double>(round + 1) / (most_contests + 1), claims.size());
        parallel_for(
            static_cast<int>(claims.size()), settings.threads,
            [&](int i, int /*worker*/) {
                tries[i] = std::make_unique<Completion>(*completion);
                tries[i]->take_threads(std::max(1, threads / static_cast<int>(claims.size())));
                tries[i]->yield_to(claims[i]);
                const double left = static_cast<double>(tries[i]->map().count) / std::max(1, completion->map().count);
                if (tries[i]->worth() < promising * left * best) return;
                tries[i]->extend_carefully(rounds_of_a_claim, pieces[i]);
                scores[i] = tries[i]->worth();
            },
            progress.monitor(), "blend", 0.0, 0.0);
        const auto winner = std::max_element(scores.begin(), scores.end());
        settled.push_back(*next);
        ++failures;
        if (winner == scores.end() || *winner <= margin * best) continue;
        failures = 0;
        changed = true;
        best = *winner;
        completion = std::move(tries[winner - scores.begin()]);
        completion->take_threads(threads);
        open = grounds(*completion, pair, best);
        // What failed against the old map may fit the new one.
        settled.clear();
    }
    if (changed) {
        std::unique_ptr<Completion> extended = std::make_unique<Completion>(*completion);
        extended->extend_carefully(settings.blend.careful_rounds, progress.until(1.0));
        if (extended->worth() > best) completion = std::move(extended);
    }
    progress.reach(1.0);
    return completion;
}

}  // namespace isograft
