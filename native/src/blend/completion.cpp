// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/completion.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "blend/landmarks.h"
#include "blend/merge.h"
#include "blend/vacancy.h"

namespace isograft {

namespace {
constexpr double compatible_reach = 0.12;
// Share of the samples that a second pass must add if another is to follow.
constexpr double worth_a_pass = 0.02;
// Doubt of a sample whose place another part of S has with more right.
constexpr double beaten = 0.9;
constexpr std::size_t most_challengers = 60;
// What another map's word is worth in log-odds.
constexpr double unconfirmed = 0.3;
constexpr double contradicted = 1.0;
// A map loses a hundredth of its worth with every 5,000th of its edges that is torn. Limbs that were exchanged fit
// wherever they hang, and still tear at the rest of the joint: both legs of a walking man 0.2 to 0.5 % of the edges.
constexpr double price_of_tears = 50.0;

// The two best of `here` go into `all`.
template <class Candidate>
void add_best(std::vector<Candidate>& here, std::vector<Candidate>& all) {
    const auto keep = static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, here.size()));
    std::partial_sort(here.begin(), here.begin() + keep, here.end(),
                      [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    all.insert(all.end(), here.begin(), here.begin() + keep);
}

template <class Candidate>
std::vector<Candidate> best_of(std::vector<Candidate> all, std::size_t most) {
    std::stable_sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
    if (all.size() > most) all.resize(most);
    return all;
}

// A few small holes bend hardly any path.
bool is_whole(const TriangleMesh& mesh) {
    const auto open = std::count(mesh.on_boundary.begin(), mesh.on_boundary.end(), 1);
    return 100 * open < mesh.vertex_count();
}
}  // namespace

Completion::Completion(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches,
                       Trials& trials, DistanceFields& fields, const DriftFinder& drift, Monitor& monitor)
    : pair_(pair),
      settings_(settings),
      trials_(trials),
      drift_(drift),
      monitor_(monitor),
      grower_(pair.source.samples, pair.target, settings.growth),
      anchors_(fields),
      map_(pair.source.samples.count()),
      weights_(patches.size(), 0.0),
      support_(patches, pair.source.samples.count(), settings.blend.agreement_radius, settings.blend.decay),
      whole_(is_whole(pair.source.mesh) && is_whole(pair.target.mesh)) {
    for (const Patch& p : patches) patches_.push_back(&p);
}

void Completion::optimise(int iterations, double trim) {
    monitor_.check();
    RelaxSettings relax_settings;
    relax_settings.iterations = iterations;
    relax_settings.trim = trim;
    relax_settings.threads = threads();
    relax(pair_.source.samples, pair_.target.mesh, settings_.growth, relax_settings, map_);
}

void Completion::start(const Core& core) {
    weights_.assign(patches_.size(), 0.0);
    for (std::size_t i = 0; i < patches_.size(); ++i) {
        if (core.member[i]) weights_[i] = std::exp(-2.0 * patches_[i]->quality);
    }
    map_ = PartialMap(pair_.source.samples.count());
    merge_into(map_, pair_, settings_, patches_, weights_);
    const std::vector<int> part = continuous_parts(map_, pair_);
    for (std::size_t s = 0; s < part.size(); ++s) {
        if (part[s] > 0) map_.drop(static_cast<int>(s));
    }
    optimise(3, 0.5 * settings_.growth.stretch_limit);
}

bool Completion::place_anchors() { return anchors_.place(map_, settings_.blend.anchors, monitor_); }

std::vector<char> Completion::covered_target() const {
    const Samples& target = pair_.target.samples;
    std::vector<char> covered(target.count(), 0);
    for (std::size_t s = 0; s < map_.mapped.size(); ++s) {
        if (!map_.mapped[s]) continue;
        for (const int v : pair_.target.mesh.face[map_.image[s].face]) {
            if (target.owner[v] >= 0) covered[target.owner[v]] = 1;
        }
    }
    return covered;
}

// Patches outside the core whose beginning fits the anchors were right after all, only isolated.
void Completion::revive() {
    for (std::size_t i = 0; i < patches_.size(); ++i) {
        if (weights_[i] > 1e-4) continue;
        const PartialMap& m = patches_[i]->map;
        double sum = 0.0;
        int count = 0;
        for (std::size_t s = 0; s < m.mapped.size(); ++s) {
            if (!m.mapped[s] || m.seed_distance[s] >= compatible_reach) continue;
            sum += anchors_.incompatibility(static_cast<int>(s), m.image[s]);
            ++count;
        }
        if (count == 0 || sum / count >= patch_strictness * settings_.blend.max_incompatibility) continue;
        weights_[i] = std::exp(-2.0 * patches_[i]->quality - 10.0 * sum / count);
    }
}

std::optional<Completion::Candidate> Completion::candidate(int s, int t) const {
    const double incompatible = anchors_.incompatibility(s, pair_.target.samples.point[t]);
    if (incompatible > settings_.blend.max_incompatibility) return std::nullopt;
    const BestShift best = best_shift(pair_.source_descriptor[s], pair_.target_descriptor[t], settings_.feature);
    if (best.distance >= not_comparable) return std::nullopt;
    return Candidate{best.distance / pair_.chance + 3.0 * incompatible, {s, t, best.shift}};
}

std::vector<TrialSeed> Completion::seeds_of(const std::vector<Candidate>& candidates) {
    std::vector<TrialSeed> seeds;
    seeds.reserve(candidates.size());
    for (const Candidate& candidate : candidates) seeds.push_back(candidate.seed);
    return seeds;
}

std::vector<Completion::Candidate> Completion::candidates() const {
    const Samples& source = pair_.source.samples;
    const std::vector<char> covered = covered_target();
    std::vector<std::vector<Candidate>> best(source.count());
    parallel_for(
        source.count(), threads(),
        [&](int s, int /*worker*/) {
            if (map_.mapped[s] || (source.level[s] == 0 && s % 2 != 0)) return;
            std::vector<Candidate> here;
            for (int t = 0; t < pair_.target.samples.count(); ++t) {
                if (covered[t]) continue;
                if (const auto found = candidate(s, t)) here.push_back(*found);
            }
            add_best(here, best[s]);
        },
        monitor_);
    std::vector<Candidate> all;
    for (const std::vector<Candidate>& here : best) all.insert(all.end(), here.begin(), here.end());
    return best_of(std::move(all), static_cast<std::size_t>(settings_.seed.probes / 2));
}

bool Completion::failed(const Trial& trial) const {
    return static_cast<int>(trial.held.size()) < settings_.seed.probe_size / 3 || trial.misfit > 0.6;
}

void Completion::adopt(const Trial& trial, const TrialSeed& seed, double weight) {
    own_.push_back(std::make_shared<const Patch>(Patch{to_map(trial, seed, pair_), trial.quality, weight}));
    patches_.push_back(own_.back().get());
    weights_.push_back(weight);
}

void Completion::try_candidate(const TrialSeed& seed) {
    const Trial& trial = trials_.of(seed, grower_);
    if (failed(trial)) return;
    double incompatible = 0.0;
    double agree = 0.0;
    int overlap = 0;
    for (const Trial::Held& h : trial.held) {
        incompatible += anchors_.incompatibility(h.sample, h.image);
        if (!map_.mapped[h.sample]) continue;
        ++overlap;
        if ((h.position - map_.position[h.sample]).norm() < settings_.blend.agreement_radius) agree += 1.0;
    }
    incompatible /= static_cast<double>(trial.held.size());
    if (incompatible > patch_strictness * settings_.blend.max_incompatibility) return;
    if (overlap > 3 && agree < settings_.blend.min_agreement * overlap) return;
    adopt(trial, seed, std::exp(-2.0 * trial.misfit - 10.0 * incompatible) * (overlap > 3 ? 2.0 : 1.0));
}

bool Completion::second_pass(Piece progress) {
    const int before = map_.count;
    if (!place_anchors()) return false;
    revive();
    const std::vector<Candidate> all = candidates();
    progress.reach(0.2);
    trials_.prepare(seeds_of(all), threads(), progress.until(0.9));
    for (const Candidate& candidate : all) try_candidate(candidate.seed);
    merge_into(map_, pair_, settings_, patches_, weights_);
    drop_torn_parts(map_, pair_, anchors_);
    optimise(3, 0.5 * settings_.growth.stretch_limit);
    return map_.count > before + worth_a_pass * pair_.source.samples.count();
}

std::vector<Completion::Candidate> Completion::challengers(const std::vector<int>& vacant) const {
    std::vector<Candidate> all;
    std::vector<Candidate> here;
    for (const int t : vacant) {
        monitor_.check();
        here.clear();
        for (int s = 0; s < pair_.source.samples.count(); ++s) {
            if (const auto found = candidate(s, t)) here.push_back(*found);
        }
        add_best(here, all);
    }
    return best_of(std::move(all), most_challengers);
}

Evidence Completion::evidence(int sample, const SurfacePoint& point, Complex rotation) const {
    const double squash = settings_.feature.squash;
    const double on_source = field_at(pair_.source.mesh, pair_.source_curvature, pair_.source.samples.point[sample]);
    const double on_target = field_at(pair_.target.mesh, pair_.target_curvature, point);
    const Eigen::Vector3d x = position(pair_.target.mesh, point);
    Evidence result;
    result.mismatch = mismatch(pair_, settings_.feature, sample, point, rotation);
    result.incompatibility = anchors_.incompatibility(sample, point);
    result.curvature = std::abs(std::atan(squash * on_source) - std::atan(squash * on_target));
    result.support = support_.share(sample, x);
    result.whole = whole_;
    for (const PartialMap& w : witnesses_) {
        const bool speaks = w.mapped[sample] != 0;
        if (speaks && (w.position[sample] - x).norm() < settings_.blend.agreement_radius) continue;
        result.hearsay += speaks ? contradicted : unconfirmed;
    }
    return result;
}

std::vector<double> Completion::doubts() const {
    const Samples& source = pair_.source.samples;
    std::vector<Evidence> own(source.count());
    parallel_for(
        source.count(), threads(),
        [&](int s, int /*worker*/) {
            if (map_.mapped[s]) own[s] = evidence(s, map_.image[s], map_.rotation[s]);
        },
        monitor_);
    const std::vector<Drift> drifts = drift_.find(map_, threads(), monitor_);
    std::vector<double> result(source.count(), 0.0);
    for (int s = 0; s < source.count(); ++s) {
        if (!map_.mapped[s]) continue;
        Evidence ring = own[s];
        int count = 1;
        for (const int e : source.base_edges_of[s]) {
            const int other = source.edges[e].other(s);
            if (!map_.mapped[other]) continue;
            ring.mismatch += own[other].mismatch;
            ring.incompatibility += own[other].incompatibility;
            ring.curvature += own[other].curvature;
            ++count;
        }
        ring.mismatch /= count;
        ring.incompatibility /= count;
        ring.curvature /= count;
        ring.drift = std::max(0.0, drifts[s].gain());
        result[s] = doubt(ring);
    }
    if (!exclusive_) return result;
    const std::vector<char> loses = doubled(pair_, map_, result);
    for (int s = 0; s < source.count(); ++s) {
        if (loses[s]) result[s] = std::max(result[s], beaten);
    }
    return result;
}

void Completion::extend(double accept) {
    optimise(4, 0.5 * settings_.growth.stretch_limit);
    if (!place_anchors()) return;
    GrowthRun run;
    run.schedule = {0.3, 0.6, 1.0};
    run.first_relax = 1 << 28;
    run.final_iterations = 3;
    run.slack = 2.0;
    run.threads = threads();
    run.mismatch = [&](int s, const SurfacePoint& p, Complex turn) {
        monitor_.check();
        return mismatch(pair_, settings_.feature, s, p, turn);
    };
    run.mismatch_weight = 0.3;
    if (accept < 1.0) {
        run.refuse = [&](int s, const SurfacePoint& p, Complex turn) { return doubt(evidence(s, p, turn)) > accept; };
    }
    grower_.grow(map_, run);
    drop_torn_parts(map_, pair_, anchors_);
}

void Completion::trim(double limit) {
    if (!place_anchors()) return;
    const std::vector<double> doubtful = doubts();
    for (std::size_t s = 0; s < doubtful.size(); ++s) {
        if (map_.mapped[s] && doubtful[s] > limit) map_.drop(static_cast<int>(s));
    }
}

void Completion::extend_carefully(int rounds, Piece progress) {
    const BlendOptions& options = settings_.blend;
    trim(options.accept);
    for (int round = 0; round < rounds; ++round) {
        const int before = map_.count;
        const double share = 0.8 / rounds;
        extend(options.accept);
        trim(0.8 * options.accept);
        progress.reach(share * (round + 0.5));
        second_pass(progress.until(share * (round + 1)));
        trim(0.8 * options.accept);
        if (map_.count <= before + 2) break;
    }
    progress.reach(0.8);
    // A single sample's evidence is noisier than that of its ring, so the last extension is free and judged as a whole.
    extend(1.0);
    trim(options.accept);
    progress.reach(1.0);
}

MapQuality Completion::quality() {
    place_anchors();
    return measure_quality(pair_, settings_.feature, map_, doubts());
}

double Completion::worth() {
    const double whole = std::exp(-price_of_tears * torn_share(map_, pair_.source.samples));
    return choice_score(quality()) * whole * heed(map_, pair_, settings_.landmarks).share;
}

}  // namespace isograft
