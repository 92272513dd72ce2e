// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/match.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <sstream>

#include "base/costs.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "blend/blend.h"
#include "blend/core.h"
#include "blend/core_scale.h"
#include "blend/landmarks.h"
#include "blend/merge.h"
#include "blend/registration.h"
#include "dense/densify.h"
#include "dense/refine.h"
#include "dense/vertex_place.h"
#include "growth/patches.h"
#include "growth/relax.h"
#include "isograft/errors.h"
#include "isograft/memory.h"
#include "paper.h"
#include "scale/resample.h"
#include "scale/rescale.h"
#include "scale/setting.h"
#include "seed/landmark_seeds.h"
#include "seed/oriented_match.h"
#include "surface/clean.h"

namespace isograft {

namespace {

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
        if (!(landmarks[i].weight > 0.0 && landmarks[i].weight <= 1.0)) {
            throw InvalidInput("landmark " + std::to_string(i) + ": its weight must be in (0, 1]");
        }
    }
}

// What the stages work on.
std::vector<Surface> working_surfaces(const Surface& source, const Surface& target, const MatchOptions& options,
                                      Monitor& monitor) {
    std::vector<Surface> surfaces{source, target};
    parallel_for(
        2, options.threads,
        [&](int i, int /*worker*/) {
            if (options.surface.denoise > 0.0) surfaces[i] = surfaces[i].denoised(options.surface.denoise, monitor);
            surfaces[i] = surfaces[i].in_own_frame(monitor);
        },
        monitor, "surface", 0.0, 0.0);
    return surfaces;
}

struct Grown {
    std::vector<Patch> patches;
    std::vector<Core> cores;
    int seeds = 0;
};

/// Ends a stage: its name, and the bytes of what it keeps.
using Lap = std::function<void(const char*, std::int64_t)>;

Grown grow(const Pair& pair, const PatchSettings& settings, const MatchOptions& options, const Lap& lap,
           Monitor& monitor, double from, double to) {
    const double seeded = from + 0.08 * (to - from);
    std::vector<OrientedMatch> seeds =
        landmark_seeds(pair, options.landmarks, options.feature, options.threads, monitor, from);
    const int forced = static_cast<int>(seeds.size());
    if (!options.seed.landmarks_only) {
        const auto found =
            oriented_matches(pair, options.feature, options.seed, options.threads, monitor, from, seeded);
        seeds.insert(seeds.end(), found.begin(), found.end());
    }
    lap("seeds", static_cast<std::int64_t>(seeds.size() * sizeof(OrientedMatch)));
    Grown grown;
    grown.patches = grow_patches(pair, settings, seeds, forced, monitor, seeded, to);
    // A patch's vote is exp(-2 quality).
    for (int i = 0; i < forced; ++i) grown.patches[i].quality -= 0.5 * std::log(options.landmarks[i].weight);
    // Of one that puts all landmarks elsewhere, a twentieth is left.
    for (Patch& patch : grown.patches) {
        const Heed heeded = heed(patch.map, pair, settings.landmarks);
        if (heeded.broken > 0.0) {
            patch.quality -= 0.5 * std::log(1.0 - 0.95 * heeded.broken / (heeded.kept + heeded.broken));
        }
    }
    grown.cores = find_cores(grown.patches, options.blend, forced);
    grown.seeds = std::min(static_cast<int>(seeds.size()), options.seed.probes + forced);
    return grown;
}

// The map of the search before is one more patch, and a core of its own: what one search leaves out, another may reach
// from it, and the two are compared on one set of samples.
void enter(Grown& grown, PartialMap map, const Pair& pair, const MatchOptions& options) {
    if (map.count == 0) return;
    const double quality = mean_mismatch(pair, options.feature, map);
    grown.patches.push_back({std::move(map), quality, 0.0});
    for (Core& core : grown.cores) core.member.push_back(0);
    Core own;
    own.member.assign(grown.patches.size(), 0);
    own.member.back() = 1;
    own.count = 1;
    own.carried = true;
    // After the strongest: whether these two agree settles most.
    const auto second = std::min<std::size_t>(1, grown.cores.size());
    grown.cores.insert(grown.cores.begin() + static_cast<std::ptrdiff_t>(second), std::move(own));
    if (grown.cores.size() > std::max<std::size_t>(2, options.blend.cores)) grown.cores.pop_back();
}

// What the seeds of the strongest core say of the scale; 1 if it is near enough, or not to be touched.
double scale_correction(const Pair& pair, const Grown& grown, const MatchOptions& options, MatchReport& report,
                        Monitor& monitor) {
    // Growth bears a few per cent, and a body that bends stretches by as much. A common unit is the likeliest of all
    // beforehand: it takes more to give that up than to correct a scale that votes had measured.
    const bool likely = report.scale == 1.0;
    const double bearable = likely ? 0.08 : 0.025;
    const double errors = likely ? 4.0 : 2.0;
    constexpr double believable = 0.25;
    if (grown.cores.empty() || options.scale.mode == ScaleMode::given) return 1.0;
    const CoreScale said = measure_core_scale(pair, grown.patches, grown.cores.front(), monitor);
    const double off = std::abs(std::log(said.ratio));
    if (off < std::max(bearable, errors * said.error) || off > believable) return 1.0;
    if (options.scale.mode == ScaleMode::automatic) return said.ratio;
    if (off > 0.1) {
        std::ostringstream text;
        text.precision(3);
        text << "scale is fixed, but the surfaces do not seem to be in one unit: lengths on the target are about "
             << said.ratio << " times those on the source; try scale \"auto\"";
        report.warnings.push_back(text.str());
    }
    return 1.0;
}

// Whether patches grown at a corrected scale confirm it. Seeds err where both surfaces lack much: of 7 corrections of a
// common unit on real pairs, 6 were wrong and made patches worse or hardly better.
bool bears_out(const Grown& corrected, const Grown& before, double scale) {
    const auto quality = [](const Grown& grown) {
        std::vector<double> all;
        for (const Patch& patch : grown.patches) all.push_back(patch.quality);
        return better_half(std::move(all));
    };
    constexpr double clearly = 0.95, hardly_worse = 1.05;
    if (corrected.patches.empty()) return false;
    return quality(corrected) < (scale == 1.0 ? clearly : hardly_worse) * quality(before);
}

// Doubt is about errors above 0.1 of the root of T's area, before the refinement; confidence promises half of that
// after it. Of 97 pairs with a known truth, vertices with 1 - doubt = 0.58, 0.73, 0.84, 0.94 and 0.99 were then right
// in 0.59, 0.71, 0.78, 0.90 and 0.98 of the cases: of what was off, the refinement mends nearly half.
double confidence_of(double doubt) { return 0.45 + 0.54 * std::pow(1.0 - doubt, 2.45); }

void warn_of_answers(const std::vector<Blended>& answers, MatchReport& report) {
    if (answers.front().map.count == 0) {
        report.warnings.emplace_back(
            "no map was found that fits both surfaces, so everything is unmatched; check that they show the same "
            "shape, try preset thorough, or give landmarks");
    }
    for (std::size_t i = 1; i < answers.size(); ++i) {
        std::ostringstream text;
        text.precision(2);
        text << "alternative " << i << " contradicts the best map and is worth "
             << answers[i].fit / std::max(1e-9, answers[0].fit)
             << " of it: the surfaces may map onto themselves; compare both, or give a landmark";
        report.warnings.push_back(text.str());
    }
}

}  // namespace

void MatchOptions::validate() const {
    surface.validate();
    hierarchy.validate();
    feature.validate();
    seed.validate();
    growth.validate();
    blend.validate();
    dense.validate();
    scale.validate();
    paper.validate();
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
        options.blend.attempts = 1;
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
        options.blend.attempts = 4;
        return options;
    }
    if (name == "noisy") {
        // Everything that reads shape looks farther, everything that tests lengths gives more.
        options.surface.denoise = 3.0;
        options.feature.smoothing = 14;
        options.feature.radius = 0.25;
        options.growth.stretch_limit = 0.7;
        options.growth.huber = 0.15;
        options.blend.accept = 0.6;
        return options;
    }
    if (name == "paper") {
        options.paper.steps = true;
        return options;
    }
    throw InvalidInput("there is no preset \"" + name + "\"; there are fast, default, thorough, noisy and paper");
}

Match match(const Surface& source, const Surface& target, const MatchOptions& options, Monitor* monitor) {
    options.validate();
    check_memory({source.vertices().rows(), source.faces().rows()}, {target.vertices().rows(), target.faces().rows()},
                 options, options.memory_limit);
    check_landmarks(options.landmarks, source, &Landmark::source, "source");
    check_landmarks(options.landmarks, target, &Landmark::target, "target");
    if (options.seed.landmarks_only && options.landmarks.empty()) {
        throw InvalidInput("seed.landmarks_only needs landmarks, and there are none");
    }
    Monitor silent;
    Monitor& watcher = monitor != nullptr ? *monitor : silent;
    watcher.report("start", 0.0);
    if (options.paper.steps) return match_by_paper(source, target, options, watcher);
    Match result;
    MatchReport& report = result.report;
    for (const auto& w : source.warnings()) report.warnings.push_back("source: " + w);
    for (const auto& w : target.warnings()) report.warnings.push_back("target: " + w);
    Stopwatch whole;
    Stopwatch watch;
    const Lap lap = [&](const char* name, std::int64_t bytes) {
        const auto known = std::find_if(report.stages.begin(), report.stages.end(),
                                        [&](const StageReport& stage) { return stage.name == name; });
        if (known == report.stages.end()) {
            report.stages.push_back({name, watch.lap(), bytes});
        } else {
            known->seconds += watch.lap();
            known->bytes += bytes;
        }
    };

    const Costs costs(options);
    const auto points = source.vertices().rows();
    double refining = costs.refinement();
    double finish = refining + costs.dense(points);
    // Descriptors made anew, and the blend of as many cores as there may be.
    const double describing = 0.3 * costs.setting();
    const double blending = costs.cores(options.blend.cores) + costs.answers(1);
    const double another = describing + costs.growth() + blending;
    // Nobody knows yet whether there will be another search: a share for those after so many that is not far off either
    // way. Of three pairs that need a second one, two are confirmed by it; of later ones little is known.
    const auto more = [&](int searches) {
        constexpr double second = 0.4, further = 0.35;
        double sum = 0.0;
        double likely = 1.0;
        for (int k = searches; k < options.blend.attempts; ++k) {
            likely *= k == 1 ? second : further;
            sum += likely * another;
        }
        return sum;
    };
    const double perhaps = more(1);
    double expected = costs.preparation({points, target.vertices().rows()}) + costs.search(points);
    const double search = costs.search(points) + perhaps;
    std::vector<Surface> surfaces = working_surfaces(source, target, options, watcher);
    lap("surface", 0);
    PreparedPair prepared =
        prepare_pair(std::move(surfaces[0]), std::move(surfaces[1]), options, report, watcher, 0.0, 1.0, search);
    Pair& pair = prepared.pair;
    watch.lap();
    // Only what is on the source is refined, and of a small part there are few samples.
    refining *= std::min(1.0, static_cast<double>(pair.source.samples.count()) / options.hierarchy.samples);
    finish = refining + costs.dense(points);
    const double carry = costs.answers(1) + perhaps + finish;

    PatchSettings settings{options.feature, options.seed, options.growth, options.blend, options.threads, {}};
    for (const Landmark& landmark : options.landmarks) settings.landmarks.push_back(landmark.weight);
    double at = watcher.fraction();
    const double rest = blending + perhaps + finish;
    double until = end_of_part(at, 1.0, costs.growth(), rest);
    Grown grown = grow(pair, settings, options, lap, watcher, at, until);
    if (const double factor = scale_correction(pair, grown, options, report, watcher); factor != 1.0) {
        lap("growth", 0);
        at = watcher.fraction();
        const double described = end_of_part(at, 1.0, describing, costs.growth() + rest);
        PreparedPair corrected = prepared;
        rescale(corrected, factor, options, watcher, at, described);
        until = end_of_part(described, 1.0, costs.growth(), rest);
        lap("scale", 0);
        Grown again = grow(corrected.pair, settings, options, lap, watcher, described, until);
        if (bears_out(again, grown, report.scale)) {
            prepared = std::move(corrected);
            grown = std::move(again);
            report.scale = prepared.setting.scale;
        }
    }
    report.seeds_tried = grown.seeds;
    report.maps_grown = static_cast<int>(grown.patches.size());
    const std::int64_t map_bytes = pair.source.samples.count() * static_cast<std::int64_t>(sizeof(SurfacePoint) + 48);
    lap("growth", map_bytes * report.maps_grown);

    at = watcher.fraction();
    const int cores = static_cast<int>(grown.cores.size());
    const double completed = end_of_part(at, 1.0, costs.cores(cores), carry);
    until = end_of_part(completed, 1.0, costs.answers(1), perhaps + finish);
    std::vector<Blended> answers = blend(pair, settings, grown.patches, grown.cores, watcher, at, completed, until);
    report.maps_in_core = answers.front().maps_in_core;
    lap("blend", map_bytes * static_cast<std::int64_t>(answers.size()));
    bool confirmed = false;
    for (int attempt = 1; attempt < options.blend.attempts && answers.front().fit < options.blend.content && !confirmed;
         ++attempt) {
        expected += another;
        at = watcher.fraction();
        const double end = end_of_part(at, 1.0, another, more(attempt + 1) + finish);
        const double sampled = end_of_part(at, end, describing, costs.growth() + blending);
        until = end_of_part(sampled, end, costs.growth(), blending);
        Pair other = pair;
        resample(other, options, options.random_seed + 16 * static_cast<std::uint64_t>(attempt), watcher, at, sampled);
        lap("samples", other.source.samples.bytes() + other.target.samples.bytes());
        Grown again = grow(other, settings, options, lap, watcher, sampled, until);
        report.seeds_tried += again.seeds;
        report.maps_grown += static_cast<int>(again.patches.size());
        lap("growth", map_bytes * static_cast<std::int64_t>(again.patches.size()));
        enter(again, carried_over(answers.front().map, pair, other), other, options);
        std::vector<Blended> found =
            blend(other, settings, again.patches, again.cores, watcher, until,
                  end_of_part(until, end, costs.cores(options.blend.cores), costs.answers(1)), end);
        lap("blend", map_bytes * static_cast<std::int64_t>(found.size()));
        confirmed = found.front().confirmed;
        if (found.front().fit <= answers.front().fit) continue;
        pair = std::move(other);
        answers = std::move(found);
        report.maps_in_core = answers.front().maps_in_core;
        report.source_samples = pair.source.samples.count();
        report.target_samples = pair.target.samples.count();
    }
    // What was kept back for a search that did not come.
    watcher.report("blend", 1.0 - finish / expected);
    warn_of_answers(answers, report);

    for (std::size_t i = 0; i < answers.size(); ++i) {
        at = watcher.fraction();
        const double begin = at;
        const double end = at + (1.0 - at) / static_cast<double>(answers.size() - i);
        const double refined = end_of_part(at, end, refining, costs.dense(points));
        PartialMap& map = answers[i].map;
        watcher.report("refinement", begin);
        extend_by_registration(map, pair, answers[i].risk, options.threads, watcher);
        drop_collisions(map, pair, answers[i].risk, options.growth.collision_radius);
        refine(map, pair, options.feature, options.growth, options.dense, options.threads, watcher, begin, refined);
        lap("refinement", map_bytes);
        SampleNotes notes;
        RelaxSettings still;
        still.iterations = 0;
        still.threads = options.threads;
        notes.stretch = relax(pair.source.samples, pair.target.mesh, options.growth, still, map);
        notes.region = continuous_parts(map, pair);
        for (const double doubt : answers[i].risk) notes.confidence.push_back(confidence_of(doubt));
        result.correspondences.push_back(densify(map, pair, notes, options.dense, prepared.source, prepared.target,
                                                 options.threads, watcher, refined, end));
        lap("dense", static_cast<std::int64_t>(source.vertices().rows()) * 88);
    }
    report.seconds = whole.lap();
    watcher.report("done", 1.0);
    return result;
}

}  // namespace isograft
