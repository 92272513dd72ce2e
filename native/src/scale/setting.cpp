// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/setting.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "growth/patches.h"
#include "scale/find_scale.h"
#include "seed/oriented_match.h"

namespace isograft {

namespace {

void note(MatchReport& report, const std::string& name, double seconds, std::int64_t bytes) {
    const auto found = std::find_if(report.stages.begin(), report.stages.end(),
                                    [&](const StageReport& s) { return s.name == name; });
    if (found != report.stages.end()) {
        found->seconds += seconds;
        found->bytes = std::max(found->bytes, bytes);
    } else {
        report.stages.push_back({name, seconds, bytes});
    }
}

std::vector<SurfacePoint> landmark_points(const TriangleMesh& mesh, const std::vector<Landmark>& landmarks,
                                          int Landmark::* end) {
    std::vector<SurfacePoint> points;
    for (const Landmark& l : landmarks) {
        const auto found = std::find(mesh.input_vertex.begin(), mesh.input_vertex.end(), l.*end);
        // An unreferenced vertex has no surface around it; match() has refused those.
        points.push_back(point_near_vertex(mesh, static_cast<int>(found - mesh.input_vertex.begin())));
    }
    return points;
}

PreparedPair prepare(const Surface& source, const Surface& target, const Setting& setting, const MatchOptions& options,
                     MatchReport& report, Monitor& monitor, double from, double to) {
    Stopwatch watch;
    PreparedPair prepared{setting, setting.source_reversed ? source.with_open_parts_reversed() : source,
                          setting.target_reversed ? target.with_open_parts_reversed() : target, {}, 1.0};
    const TriangleMesh& s = prepared.source.mesh();
    const TriangleMesh& t = prepared.target.mesh();
    const double source_area = s.area * setting.scale * setting.scale;
    prepared.unit = std::sqrt(std::max(source_area, t.area));
    const double smaller = std::min(source_area, t.area) / (prepared.unit * prepared.unit);
    const HierarchyOptions& hierarchy = options.hierarchy;
    const double spacing =
        std::min(sample_spacing(1.0, hierarchy.samples), sample_spacing(smaller, hierarchy.min_samples));
    Pair& pair = prepared.pair;
    pair.source.mesh = scaled(s, setting.scale / prepared.unit);
    pair.target.mesh = scaled(t, 1.0 / prepared.unit);
    const double third = (to - from) / 3.0;
    pair.source.samples = make_samples(pair.source.mesh, spacing, hierarchy, options.random_seed + 1, options.threads,
                                       monitor, from, from + 0.5 * third,
                                       landmark_points(pair.source.mesh, options.landmarks, &Landmark::source));
    pair.target.samples = make_samples(pair.target.mesh, spacing, hierarchy, options.random_seed + 2, options.threads,
                                       monitor, from + 0.5 * third, from + third,
                                       landmark_points(pair.target.mesh, options.landmarks, &Landmark::target));
    note(report, "samples", watch.lap(), pair.source.samples.bytes() + pair.target.samples.bytes());
    describe(pair, options.feature, options.random_seed + 3, options.threads, monitor, from + third, to);
    const auto descriptors = pair.source_descriptor.size() + pair.target_descriptor.size();
    note(report, "features", watch.lap(), static_cast<std::int64_t>(descriptors * sizeof(PolarDescriptor)));
    return prepared;
}

// Mean quality of the better half of a few probes; lower is better.
double probe_setting(const Pair& pair, const MatchOptions& options, Monitor& monitor, double at) {
    const PatchSettings settings{options.feature, options.seed, options.growth, options.blend, options.threads};
    const auto matches =
        oriented_matches(pair, options.feature, options.seed, options.threads, monitor, at, at);
    const int count = std::min(options.scale.probes, static_cast<int>(matches.size()));
    if (count == 0) return 10.0;
    std::vector<std::unique_ptr<Grower>> growers;
    for (int w = 0; w < worker_count(options.threads); ++w) {
        growers.push_back(std::make_unique<Grower>(pair.source.samples, pair.target, options.growth));
    }
    std::vector<double> quality(count);
    parallel_for(
        count, options.threads,
        [&](int i, int worker) {
            quality[i] = probe(pair, settings, *growers[worker], matches[i], options.seed.probe_size).quality;
        },
        monitor, "scale", at, at);
    std::sort(quality.begin(), quality.end());
    const int half = std::max(1, count / 2);
    return std::accumulate(quality.begin(), quality.begin() + half, 0.0) / half;
}

std::vector<Setting> possible_settings(const Surface& source, const Surface& target, const MatchOptions& options,
                                       MatchReport& report, Monitor& monitor, double from, double to) {
    std::vector<Setting> sides{Setting{}};
    // Turning both over changes nothing, so one is enough.
    if (source.orientation_is_ambiguous()) {
        sides.push_back({1.0, true, false});
    } else if (target.orientation_is_ambiguous()) {
        sides.push_back({1.0, false, true});
    }
    std::vector<Setting> settings;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        Setting setting = sides[i];
        if (options.scale.mode != ScaleMode::automatic) {
            setting.scale = options.scale.mode == ScaleMode::given ? options.scale.value : 1.0;
            settings.push_back(setting);
            continue;
        }
        const Surface s = setting.source_reversed ? source.with_open_parts_reversed() : source;
        const Surface t = setting.target_reversed ? target.with_open_parts_reversed() : target;
        const double step = (to - from) / static_cast<double>(sides.size());
        Stopwatch watch;
        const ScaleVotes votes =
            vote_scale(s.mesh(), t.mesh(), options.feature, options.scale, options.random_seed + 4, options.threads,
                       monitor, from + static_cast<double>(i) * step, from + static_cast<double>(i + 1) * step);
        for (const double scale : scale_candidates(votes, std::sqrt(t.mesh().area / s.mesh().area))) {
            setting.scale = scale;
            settings.push_back(setting);
        }
        note(report, "scale", watch.lap(), 0);
    }
    return settings;
}

}  // namespace

PreparedPair prepare_pair(const Surface& source, const Surface& target, const MatchOptions& options,
                          MatchReport& report, Monitor& monitor, double from, double to) {
    const double voted = from + 0.3 * (to - from);
    const std::vector<Setting> settings = possible_settings(source, target, options, report, monitor, from, voted);
    std::optional<PreparedPair> best;
    double best_quality = 0.0;
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const double step = (to - voted) / static_cast<double>(settings.size());
        const double begin = voted + static_cast<double>(i) * step;
        PreparedPair prepared =
            prepare(source, target, settings[i], options, report, monitor, begin, begin + 0.8 * step);
        if (settings.size() == 1) {
            best = std::move(prepared);
            break;
        }
        Stopwatch watch;
        const double quality = probe_setting(prepared.pair, options, monitor, begin + 0.8 * step);
        note(report, "scale", watch.lap(), 0);
        // The earlier setting is the likelier one beforehand.
        if (!best || quality < 0.99 * best_quality) {
            best = std::move(prepared);
            best_quality = quality;
        }
    }
    monitor.report("features", to);
    report.scale = best->setting.scale;
    report.unit_length = best->unit;
    report.source_samples = best->pair.source.samples.count();
    report.target_samples = best->pair.target.samples.count();
    if (best->setting.source_reversed) {
        report.warnings.emplace_back("open parts of the source were turned over: they matched better inside out");
    }
    if (best->setting.target_reversed) {
        report.warnings.emplace_back("open parts of the target were turned over: they matched better inside out");
    }
    return std::move(*best);
}

}  // namespace isograft
