// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/match.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "blend/blend.h"
#include "blend/merge.h"
#include "dense/densify.h"
#include "dense/refine.h"
#include "growth/patches.h"
#include "growth/relax.h"
#include "isograft/errors.h"
#include "isograft/memory.h"
#include "scale/setting.h"
#include "seed/oriented_match.h"
#include "surface/clean.h"

namespace isograft {

namespace {

// Progress at the end of each stage.
constexpr double prepared_by = 0.4, seeded_by = 0.45, grown_by = 0.65, blended_by = 0.88, refined_by = 0.95;

void check_landmarks(const std::vector<Landmark>& landmarks, const Surface& surface, int Landmark::* end,
                     const std::string& name) {
    const std::vector<int> working = working_vertices(surface);
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
        const int vertex = landmarks[i].*end;
        const std::string which = "landmark " + std::to_string(i) + ": " + name + " vertex " + std::to_string(vertex);
        if (vertex < 0 || vertex >= surface.vertices().rows()) {
            throw InvalidInput(which + " is out of range, the " + name + " has " +
                               std::to_string(surface.vertices().rows()) + " vertices");
        }
        if (working[vertex] < 0) {
            throw InvalidInput(which + " is not part of any usable triangle; choose another vertex");
        }
    }
}

// Landmarks are the first samples of both surfaces; what is missing is the angle, which descriptors give.
std::vector<OrientedMatch> landmark_matches(const Pair& pair, const MatchOptions& options) {
    std::vector<OrientedMatch> matches;
    for (int i = 0; i < static_cast<int>(options.landmarks.size()); ++i) {
        const BestShift best = best_shift(pair.source_descriptor[i], pair.target_descriptor[i], options.feature);
        matches.push_back({i, pair.target.samples.point[i], rotation_of(best.shift), 0.0});
    }
    return matches;
}

// Share of right vertices among those of equal risk, fitted on pairs with a known truth.
double confidence_of(double risk) { return 1.0 / (1.0 + std::exp((risk - 0.95) / 0.25)); }

}  // namespace

void MatchOptions::validate() const {
    hierarchy.validate();
    feature.validate();
    seed.validate();
    growth.validate();
    blend.validate();
    dense.validate();
    scale.validate();
    if (memory_limit < 0) throw InvalidInput("memory_limit must not be negative; 0 is no limit");
    if (threads < 0 || threads > 1024) throw InvalidInput("threads must be in [0, 1024]; 0 takes all cores");
}

MatchOptions preset_options(const std::string& name) {
    MatchOptions options;
    if (name == "default") return options;
    if (name == "fast") {
        options.hierarchy.samples = 700;
        options.seed.probes = 150;
        options.blend.patches = 70;
        options.blend.cores = 2;
        options.blend.rounds = 2;
        return options;
    }
    if (name == "thorough") {
        options.hierarchy.samples = 1600;
        options.seed.probes = 500;
        options.seed.candidates = 4;
        options.blend.patches = 240;
        options.blend.patch_size = 300;
        options.blend.cores = 4;
        options.blend.rounds = 6;
        return options;
    }
    throw InvalidInput("there is no preset \"" + name + "\"; there are fast, default and thorough");
}

Match match(const Surface& source, const Surface& target, const MatchOptions& options, Monitor* monitor) {
    options.validate();
    check_memory({source.vertices().rows(), source.faces().rows()}, {target.vertices().rows(), target.faces().rows()},
                 options, options.memory_limit);
    check_landmarks(options.landmarks, source, &Landmark::source, "source");
    check_landmarks(options.landmarks, target, &Landmark::target, "target");
    Monitor silent;
    Monitor& watcher = monitor != nullptr ? *monitor : silent;
    watcher.report("start", 0.0);
    Match result;
    MatchReport& report = result.report;
    for (const auto& w : source.warnings()) report.warnings.push_back("source: " + w);
    for (const auto& w : target.warnings()) report.warnings.push_back("target: " + w);
    Stopwatch whole;
    Stopwatch watch;
    const auto lap = [&](const char* name, std::int64_t bytes) { report.stages.push_back({name, watch.lap(), bytes}); };

    const PreparedPair prepared = prepare_pair(source, target, options, report, watcher, 0.0, prepared_by);
    const Pair& pair = prepared.pair;
    watch.lap();

    std::vector<OrientedMatch> seeds = landmark_matches(pair, options);
    const int forced = static_cast<int>(seeds.size());
    const auto found =
        oriented_matches(pair, options.feature, options.seed, options.threads, watcher, prepared_by, seeded_by);
    seeds.insert(seeds.end(), found.begin(), found.end());
    lap("seeds", static_cast<std::int64_t>(seeds.size() * sizeof(OrientedMatch)));

    const PatchSettings settings{options.feature, options.seed, options.growth, options.blend, options.threads};
    const std::vector<Patch> patches = grow_patches(pair, settings, seeds, forced, watcher, seeded_by, grown_by);
    report.seeds_tried = std::min(static_cast<int>(seeds.size()), options.seed.probes + forced);
    report.maps_grown = static_cast<int>(patches.size());
    const std::int64_t map_bytes = pair.source.samples.count() * static_cast<std::int64_t>(sizeof(SurfacePoint) + 48);
    lap("growth", map_bytes * report.maps_grown);

    Blended blended = blend(pair, settings, patches, watcher, grown_by, blended_by);
    report.maps_in_core = blended.maps_in_core;
    lap("blend", map_bytes);
    if (blended.map.count == 0) {
        report.warnings.emplace_back(
            "no map was found that fits both surfaces, so everything is unmatched; check that they show the same "
            "shape, "
            "try preset thorough, or give landmarks");
    }

    drop_collisions(blended.map, pair, blended.risk, options.growth.collision_radius);
    refine(blended.map, pair, options.feature, options.growth, options.dense, options.threads, watcher, blended_by,
           refined_by);
    lap("refinement", map_bytes);

    SampleNotes notes;
    RelaxSettings still;
    still.iterations = 0;
    notes.stretch = relax(pair.source.samples, pair.target.mesh, options.growth, still, blended.map);
    notes.region = continuous_parts(blended.map, pair);
    for (const double risk : blended.risk) notes.confidence.push_back(confidence_of(risk));
    result.correspondences.push_back(densify(blended.map, pair, notes, options.dense, prepared.source, prepared.target,
                                             options.threads, watcher, refined_by, 1.0));
    lap("dense", static_cast<std::int64_t>(source.vertices().rows()) * 88);
    report.seconds = whole.lap();
    watcher.report("done", 1.0);
    return result;
}

}  // namespace isograft
