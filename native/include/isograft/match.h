// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isograft/correspondence.h"
#include "isograft/monitor.h"
#include "isograft/options/blend.h"
#include "isograft/options/dense.h"
#include "isograft/options/feature.h"
#include "isograft/options/growth.h"
#include "isograft/options/hierarchy.h"
#include "isograft/options/paper.h"
#include "isograft/options/scale.h"
#include "isograft/options/seed.h"
#include "isograft/options/surface.h"
#include "isograft/surface.h"

namespace isograft {

/// A known pair of points: the vertex `source` of S belongs to the vertex `target` of T.
struct Landmark {
    int source = -1;
    int target = -1;
    /// In (0, 1]: how far it is trusted against the other landmarks.
    double weight = 1.0;
};

/// Options of match(): one struct per stage, and what concerns the whole call.
struct MatchOptions {
    SurfaceOptions surface;
    HierarchyOptions hierarchy;
    FeatureOptions feature;
    SeedOptions seed;
    GrowthOptions growth;
    BlendOptions blend;
    DenseOptions dense;
    ScaleOptions scale;
    PaperOptions paper;

    /// Known pairs; they are tried first and weigh more than any found match.
    std::vector<Landmark> landmarks;
    /// Worker threads; 0 takes all cores. The result does not depend on it.
    int threads = 0;
    /// Bytes that a match may take by the estimate of memory.h; 0 is no limit.
    std::int64_t memory_limit = 0;
    /// Seed of every random choice.
    std::uint64_t random_seed = 0;

    /// Call visitor(stage_name, field_name, reference_to_field) for every plain field (int, double, bool).
    template <class Visitor>
    void visit(Visitor&& visitor) {
        surface.visit([&](const char* name, auto& field) { visitor("surface", name, field); });
        hierarchy.visit([&](const char* name, auto& field) { visitor("hierarchy", name, field); });
        feature.visit([&](const char* name, auto& field) { visitor("feature", name, field); });
        seed.visit([&](const char* name, auto& field) { visitor("seed", name, field); });
        growth.visit([&](const char* name, auto& field) { visitor("growth", name, field); });
        blend.visit([&](const char* name, auto& field) { visitor("blend", name, field); });
        dense.visit([&](const char* name, auto& field) { visitor("dense", name, field); });
        scale.visit([&](const char* name, auto& field) { visitor("scale", name, field); });
        paper.visit([&](const char* name, auto& field) { visitor("paper", name, field); });
    }

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

/// Options by name: "fast", "default", "thorough", "noisy", "paper".
/// \throw InvalidInput for any other name, listing those that exist.
MatchOptions preset_options(const std::string& name);

/// Time and memory of one stage of one call.
struct StageReport {
    std::string name;
    double seconds = 0.0;
    /// Bytes of what the stage keeps for later stages.
    std::int64_t bytes = 0;
};

/// What a call did, for logs and benchmarks.
struct MatchReport {
    std::vector<StageReport> stages;
    double seconds = 0.0;
    /// sigma: target units per source unit.
    double scale = 1.0;
    /// The pair's unit length in the target's units.
    double unit_length = 1.0;
    int source_samples = 0;
    int target_samples = 0;
    int seeds_tried = 0;
    int maps_grown = 0;
    /// Maps that agree with the chosen core.
    int maps_in_core = 0;
    std::vector<std::string> warnings;
};

/// Result of match(): correspondences, the best first, and the report.
struct Match {
    std::vector<Correspondence> correspondences;
    MatchReport report;

    [[nodiscard]] const Correspondence& best() const { return correspondences.front(); }
};

/// Find a dense partial near-isometric correspondence from `source` to `target`.
///
/// Maps are grown from oriented matches, stopped by stretch, clustered by mutual agreement and merged (Brunton, Wand,
/// Wuhrer, Seidel, Weinkauf 2014, sections 4 and 5). No landmarks, no common position, no common scale needed.
/// What cannot be matched is left unmatched; at worst everything is.
/// \param monitor may be null.
/// \return at least one Correspondence; equal bit for bit for any number of threads.
/// \throw InvalidInput if `options` do not validate or a landmark is out of range; ResourceLimit if
/// the estimate exceeds the options' limit; Cancelled if `monitor` asks for it.
Match match(const Surface& source, const Surface& target, const MatchOptions& options = {}, Monitor* monitor = nullptr);

}  // namespace isograft
