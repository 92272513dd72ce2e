// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "base/piece.h"
#include "blend/anchors.h"
#include "blend/choice.h"
#include "blend/core.h"
#include "blend/doubt.h"
#include "blend/drift.h"
#include "blend/trials.h"
#include "growth/grow.h"

namespace isograft {

/// Makes one map out of one core and carries it into what is still uncovered. Every step leaves a valid map. A copy
/// goes its own way.
class Completion {
  public:
    /// The references must outlive it; `patches`, `trials`, `fields` and `drift` are shared between cores.
    Completion(const Pair& pair, const PatchSettings& settings, const std::vector<Patch>& patches, Trials& trials,
               DistanceFields& fields, const DriftFinder& drift, Monitor& monitor);

    /// Merge the core's patches, keep the largest continuous part, run the least squares.
    void start(const Core& core);

    /// One second pass: anchors on the map filter candidates in what is uncovered on both surfaces; maps grown from
    /// them, and old patches that fit after all, are merged in. \return whether the map gained.
    bool second_pass(Piece progress);

    /// Grow the map outward. A sample is refused where its doubt() exceeds `accept`; 1 refuses none.
    void extend(double accept);

    /// Drop samples whose doubt exceeds `limit`, by the evidence of themselves and their mapped neighbours.
    void trim(double limit);

    /// Trim, then extend and second passes in turn, the surest parts first: what a careful round adds helps to judge
    /// the next one.
    void extend_carefully(int rounds, Piece progress);

    /// Patches that may lead into a part of T where no image lies, even from samples that are mapped elsewhere: a limb
    /// left empty beside one covered by the wrong limb, or by two.
    /// \param vacant samples of T. \return sets that may be true together, each as a say per patch of this object; the
    /// most promising first, none if nothing leads there.
    [[nodiscard]] std::vector<std::vector<double>> claims(const std::vector<int>& vacant, Piece progress);
    /// Connected parts of S that most patches put in another place than the map does, the largest first: a limb that
    /// was taken for another one, though no part of T stayed empty.
    /// \param least smallest part, as a share of S's area. \return samples of S, rising.
    [[nodiscard]] std::vector<std::vector<int>> disputed_parts(double least) const;
    /// Patches that put a part of S elsewhere, as claims() has them.
    [[nodiscard]] std::vector<std::vector<double>> dissent(const std::vector<int>& part, Piece progress);
    /// Put in the map what a claim says; what contradicts it gives way.
    void yield_to(const std::vector<double>& claim);

    /// What speaks for and against a sample at a place. Stretch says nothing here: the least squares hides it. The
    /// anchors are those of the last call of place_anchors().
    [[nodiscard]] Evidence evidence(int sample, const SurfacePoint& point, Complex rotation) const;
    /// Per sample the probability that its image is wrong, by the mean evidence of itself and its mapped neighbours; 0
    /// where unmapped.
    [[nodiscard]] std::vector<double> doubts() const;
    bool place_anchors();

    /// Maps grown from other patches. Where one is silent on a sample doubt rises, more where it contradicts.
    void hear(std::vector<PartialMap> witnesses) { witnesses_ = std::move(witnesses); }

    /// Of the map as it is now, see measure_quality().
    [[nodiscard]] MapQuality quality();
    /// choice_score() of that; less for what is torn, see torn_share(), and for landmarks that it does not keep, see
    /// heed().
    [[nodiscard]] double worth();
    /// Threads that it may use by itself from now on, 1 at first: those that no other completion needs. From any
    /// thread.
    void take_threads(int threads) { threads_.count = threads; }
    [[nodiscard]] int threads() const { return threads_.count; }
    /// From now on, of two parts of S on one place of T the less trusted one is doubted.
    void be_exclusive() { exclusive_ = true; }

    [[nodiscard]] const PartialMap& map() const { return map_; }
    [[nodiscard]] PartialMap& map() { return map_; }

  private:
    /// A candidate's whole patch must fit the anchors better than its seed alone had to.
    static constexpr double patch_strictness = 0.7;

    // A copy begins with as many.
    struct ThreadCount {
        std::atomic<int> count{1};
        ThreadCount() = default;
        ThreadCount(const ThreadCount& other) : count(other.count.load()) {}
        ThreadCount& operator=(const ThreadCount&) = delete;
    };

    struct Candidate {
        double score;
        TrialSeed seed;
    };

    void optimise(int iterations, double trim);
    void revive();
    /// Nothing if the anchors or the descriptors exclude it.
    [[nodiscard]] std::optional<Candidate> candidate(int s, int t) const;
    [[nodiscard]] static std::vector<TrialSeed> seeds_of(const std::vector<Candidate>& candidates);
    [[nodiscard]] std::vector<Candidate> candidates() const;
    [[nodiscard]] std::vector<char> covered_target() const;
    [[nodiscard]] bool failed(const Trial& trial) const;
    /// Make a trial one of the patches.
    void adopt(const Trial& trial, const TrialSeed& seed, double weight);
    void try_candidate(const TrialSeed& seed);
    [[nodiscard]] std::vector<Candidate> challengers(const std::vector<int>& vacant) const;
    [[nodiscard]] double incompatibility(const PartialMap& map) const;
    template <class Concerned>
    void speak(std::size_t i, Concerned&& concerned, std::vector<std::size_t>& index, std::vector<double>& says) const;
    [[nodiscard]] std::vector<std::vector<double>> claims_of(const std::vector<std::size_t>& index,
                                                             const std::vector<double>& says) const;

    const Pair& pair_;
    PatchSettings settings_;
    Trials& trials_;
    const DriftFinder& drift_;
    Monitor& monitor_;
    Grower grower_;
    Anchors anchors_;
    PartialMap map_;
    std::vector<const Patch*> patches_;
    std::vector<double> weights_;
    // Shared by copies.
    std::vector<std::shared_ptr<const Patch>> own_;
    Support support_;
    ThreadCount threads_;
    bool whole_;
    bool exclusive_ = false;
    std::vector<PartialMap> witnesses_;
};

}  // namespace isograft
