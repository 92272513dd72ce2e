// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace isograft {

/// Options of consensus, merging and second passes. Lengths are in the pair's unit length.
struct BlendOptions {
    /// Probed maps that are grown on.
    int patches = 120;
    /// Samples such a map may hold.
    int patch_size = 200;
    /// Images nearer than this agree.
    double agreement_radius = 0.06;
    /// Weighted share of the overlap on which a map must agree to join a core.
    double min_agreement = 0.6;
    /// Trust in a map decays by exp(-distance from its seed / decay).
    double decay = 0.1;
    /// Disjoint cores that are completed, at most, before one is chosen.
    int cores = 3;
    /// Rounds of second passes.
    int rounds = 4;
    /// Anchors on the core whose full geodesics filter the candidates of a second pass.
    int anchors = 14;
    /// Largest mean relative difference of anchor distances of such a candidate.
    double max_incompatibility = 0.22;
    /// Largest probability of being wrong at which a sample stays in the map. Less of it buys precision with coverage.
    double accept = 0.5;
    /// Rounds of careful extension with second passes before the last one.
    int careful_rounds = 3;
    /// A map that contradicts the best is kept as an alternative if it is worth more than this share of it.
    double alternative = 0.75;
    /// Whole searches, each from other samples and with the best map so far as one core more, while that map is worth
    /// less than `content` and no later search has come to the map of the one before.
    int attempts = 3;
    /// Between 0 and 1: share of the area that is expected to be right, where doubt counts four times; less for bodies
    /// out of shape. Right maps of whole bodies reach 0.7 to 0.9.
    double content = 0.66;

    template <class Visitor>
    void visit(Visitor&& visitor) {
        visitor("patches", patches);
        visitor("patch_size", patch_size);
        visitor("agreement_radius", agreement_radius);
        visitor("min_agreement", min_agreement);
        visitor("decay", decay);
        visitor("cores", cores);
        visitor("rounds", rounds);
        visitor("anchors", anchors);
        visitor("max_incompatibility", max_incompatibility);
        visitor("accept", accept);
        visitor("careful_rounds", careful_rounds);
        visitor("alternative", alternative);
        visitor("attempts", attempts);
        visitor("content", content);
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

}  // namespace isograft
