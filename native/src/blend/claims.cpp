// SPDX-License-Identifier: GPL-3.0-or-later
// What speaks for another map than the one that a completion holds, and how it is put in.
#include <algorithm>
#include <cmath>

#include "blend/completion.h"
#include "blend/merge.h"
#include "blend/vacancy.h"

namespace isograft {

namespace {

constexpr std::size_t most_claims = 3;

// Whether a map puts most of the samples that it shares with `claimed` elsewhere.
bool contradicts(const PartialMap& map, const PartialMap& claimed, double radius) {
    const Overlap overlap = overlap_of(map, claimed, radius);
    return overlap.shared > 3 && 2 * overlap.agreed < overlap.shared;
}

}  // namespace

double Completion::incompatibility(const PartialMap& map) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t s = 0; s < map.mapped.size(); ++s) {
        if (!map.mapped[s]) continue;
        sum += anchors_.incompatibility(static_cast<int>(s), map.image[s]);
        ++count;
    }
    return count > 0 ? sum / count : 1.0;
}

// A patch that concerns the part in question, and fits the anchors, has a say.
template <class Concerned>
void Completion::speak(std::size_t i, Concerned&& concerned, std::vector<std::size_t>& index,
                       std::vector<double>& says) const {
    const PartialMap& map = patches_[i]->map;
    if (!concerned(map)) return;
    const double incompatible = incompatibility(map);
    if (incompatible > patch_strictness * settings_.blend.max_incompatibility) return;
    index.push_back(i);
    says.push_back(std::exp(-2.0 * patches_[i]->quality - 10.0 * incompatible));
}

std::vector<std::vector<double>> Completion::claims_of(const std::vector<std::size_t>& index,
                                                       const std::vector<double>& says) const {
    std::vector<const PartialMap*> maps;
    maps.reserve(index.size());
    for (const std::size_t i : index) maps.push_back(&patches_[i]->map);
    std::vector<std::vector<double>> result;
    for (const std::vector<std::size_t>& set :
         compatible_sets(pair_.source.samples, maps, says, settings_.blend.agreement_radius, most_claims)) {
        std::vector<double> claim(patches_.size(), 0.0);
        for (const std::size_t k : set) claim[index[k]] = says[k];
        result.push_back(std::move(claim));
    }
    return result;
}

std::vector<std::vector<double>> Completion::claims(const std::vector<int>& vacant, Piece progress) {
    if (!place_anchors()) return {};
    const Samples& target = pair_.target.samples;
    std::vector<char> inside(target.count(), 0);
    for (const int t : vacant) inside[t] = 1;
    const auto lands = [&](const PartialMap& map) {
        const std::vector<int> homes = homes_of(map, pair_.target);
        const auto count = std::count_if(homes.begin(), homes.end(), [&](int t) { return t >= 0 && inside[t] != 0; });
        return 2 * count > std::min<int>(map.count, static_cast<int>(vacant.size()));
    };
    std::vector<std::size_t> index;
    std::vector<double> says;
    // Those of the search that lost against the core, and new ones.
    for (std::size_t i = 0; i < patches_.size(); ++i) {
        if (i % 16 == 0) progress.check();
        speak(i, lands, index, says);
    }
    const std::vector<Candidate> all = challengers(vacant);
    trials_.prepare(seeds_of(all), threads(), progress.until(1.0));
    for (const Candidate& challenger : all) {
        const Trial& trial = trials_.of(challenger.seed, grower_);
        if (failed(trial)) continue;
        adopt(trial, challenger.seed, 0.0);
        speak(patches_.size() - 1, lands, index, says);
    }
    return claims_of(index, says);
}

std::vector<std::vector<int>> Completion::disputed_parts(double least) const {
    const Samples& source = pair_.source.samples;
    std::vector<char> disputed(source.count(), 0);
    for (int s = 0; s < source.count(); ++s) {
        if (!map_.mapped[s]) continue;
        disputed[s] = support_.rival(s, map_.position[s]) > support_.share(s, map_.position[s]) ? 1 : 0;
    }
    return parts_by_area(source, std::move(disputed), least);
}

std::vector<std::vector<double>> Completion::dissent(const std::vector<int>& part, Piece progress) {
    if (!place_anchors()) return {};
    const auto objects = [&](const PartialMap& map) {
        int shared = 0;
        int elsewhere = 0;
        for (const int s : part) {
            if (!map.mapped[s] || !map_.mapped[s]) continue;
            ++shared;
            elsewhere += (map.position[s] - map_.position[s]).norm() > 2.0 * settings_.blend.agreement_radius ? 1 : 0;
        }
        return 2 * shared > std::min<int>(map.count, static_cast<int>(part.size())) && 2 * elsewhere > shared;
    };
    std::vector<std::size_t> index;
    std::vector<double> says;
    for (std::size_t i = 0; i < patches_.size(); ++i) {
        if (i % 16 == 0) progress.check();
        speak(i, objects, index, says);
    }
    return claims_of(index, says);
}

void Completion::yield_to(const std::vector<double>& claim) {
    PartialMap claimed(pair_.source.samples.count());
    merge_into(claimed, pair_, settings_, patches_, claim);
    for (std::size_t s = 0; s < claimed.mapped.size(); ++s) {
        if (!claimed.mapped[s]) continue;
        if (map_.mapped[s]) map_.drop(static_cast<int>(s));
        map_.put(pair_.target.mesh, static_cast<int>(s), claimed.image[s], claimed.rotation[s]);
    }
    // What now hangs in the air, or would vote for the old places again, goes.
    drop_torn_parts(map_, pair_, anchors_);
    for (std::size_t i = 0; i < claim.size(); ++i) {
        weights_[i] = std::max(weights_[i], claim[i]);
        if (contradicts(patches_[i]->map, claimed, settings_.blend.agreement_radius)) weights_[i] = 0.0;
    }
    optimise(3, 0.5 * settings_.growth.stretch_limit);
}

}  // namespace isograft
