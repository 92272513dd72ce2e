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
#include "feature/curvature.h"
#include "growth/patches.h"
#include "scale/find_scale.h"
#include "seed/oriented_match.h"
#include "surface/clean.h"

namespace isograft {

namespace {

void note(MatchReport& report, const std::string& name, double seconds, std::int64_t bytes) {
    const auto found =
        std::find_if(report.stages.begin(), report.stages.end(), [&](const StageReport& s) { return s.name == name; });
    if (found != report.stages.end()) {
        found->seconds += seconds;
        found->bytes = std::max(found->bytes, bytes);
    } else {
        report.stages.push_back({name, seconds, bytes});
    }
}

Detail make_detail(const Surface& surface, const CoarseMesh& base, double base_edge, double factor, double edge,
                   Monitor& monitor) {
    Detail detail{surface, scaled(surface.mesh(), factor), {}};
    if (edge <= 1.25 * base_edge * factor) {
        detail.coarse = base;
        detail.coarse.mesh = scaled(base.mesh, factor);
    } else {
        detail.coarse = coarsen(detail.fine, edge, monitor);
    }
    return detail;
}

std::vector<SurfacePoint> landmark_points(const Detail& detail, const std::vector<Landmark>& landmarks,
                                          int Landmark::* end) {
    std::vector<SurfacePoint> points;
    const std::vector<int> working = working_vertices(detail.surface);
    for (const Landmark& l : landmarks) {
        // match() has refused vertices that are not there.
        const int v = working[l.*end];
        points.push_back(detail.coarse.place.empty() ? point_near_vertex(detail.fine, v) : detail.coarse.place[v]);
    }
    return points;
}

// A surface with the coarse mesh that serves every setting in which it is the larger one.
struct Side {
    Surface surface;
    CoarseMesh coarse;
    double edge = 0.0;
};

Side make_side(const Surface& surface, const HierarchyOptions& options, Monitor& monitor) {
    const double side = std::sqrt(surface.mesh().area);
    Side result{surface, {}, options.coarse_edge * sample_spacing(1.0, options.samples) * side};
    if (result.edge > 0.0) {
        result.coarse = coarsen(surface.mesh(), result.edge, monitor);
    } else {
        result.coarse.mesh = surface.mesh();
    }
    return result;
}

PreparedPair prepare(const Side& source, const Side& target, const Setting& setting, const MatchOptions& options,
                     MatchReport& report, Monitor& monitor, double from, double to) {
    Stopwatch watch;
    const Surface& s = source.surface;
    const Surface& t = target.surface;
    const double source_area = s.mesh().area * setting.scale * setting.scale;
    const double unit = std::sqrt(std::max(source_area, t.mesh().area));
    const double smaller = std::min(source_area, t.mesh().area) / (unit * unit);
    const HierarchyOptions& hierarchy = options.hierarchy;
    const double spacing =
        std::min(sample_spacing(1.0, hierarchy.samples), sample_spacing(smaller, hierarchy.min_samples));
    const double edge = hierarchy.coarse_edge * spacing;
    PreparedPair prepared{setting,
                          make_detail(s, source.coarse, source.edge, setting.scale / unit, edge, monitor),
                          make_detail(t, target.coarse, target.edge, 1.0 / unit, edge, monitor),
                          {},
                          unit};
    Pair& pair = prepared.pair;
    pair.source.mesh = prepared.source.coarse.mesh;
    pair.target.mesh = prepared.target.coarse.mesh;
    const double third = (to - from) / 3.0;
    pair.source.samples =
        make_samples(pair.source.mesh, spacing, hierarchy, options.random_seed + 1, options.threads, monitor, from,
                     from + 0.5 * third, landmark_points(prepared.source, options.landmarks, &Landmark::source));
    pair.target.samples = make_samples(pair.target.mesh, spacing, hierarchy, options.random_seed + 2, options.threads,
                                       monitor, from + 0.5 * third, from + third,
                                       landmark_points(prepared.target, options.landmarks, &Landmark::target));
    note(report, "samples", watch.lap(), pair.source.samples.bytes() + pair.target.samples.bytes());
    const auto curvature = [&](const Detail& detail, double time) {
        monitor.check();
        return at_coarse(detail.coarse, mean_curvature(detail.fine, time));
    };
    pair.source_curvature = curvature(prepared.source, curvature_time(options.feature));
    pair.target_curvature = curvature(prepared.target, curvature_time(options.feature));
    pair.source_detail = curvature(prepared.source, detail_time);
    pair.target_detail = curvature(prepared.target, detail_time);
    describe(pair, options.feature, options.random_seed + 3, options.threads, monitor, from + third, to);
    const auto descriptors = pair.source_descriptor.size() + pair.target_descriptor.size();
    note(report, "features", watch.lap(), static_cast<std::int64_t>(descriptors * sizeof(PolarDescriptor)));
    return prepared;
}

// Mean quality of the better half of a few probes; lower is better.
double probe_setting(const Pair& pair, const MatchOptions& options, Monitor& monitor, double at) {
    const PatchSettings settings{options.feature, options.seed, options.growth, options.blend, options.threads};
    const auto matches = oriented_matches(pair, options.feature, options.seed, options.threads, monitor, at, at);
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

struct Choice {
    Setting setting;
    const Side* source;
    const Side* target;
    ScaleVotes votes{};
};

// Whether the votes of one side leave nothing to be said for the other.
bool outvoted(const ScaleVotes& loser, const ScaleVotes& winner, bool is_given) {
    constexpr double clearly = 0.8;
    const bool fits_better = winner.fit < clearly * loser.fit;
    const bool surer = votes_agree(winner) && !votes_agree(loser);
    // A winding as given is seldom wrong, so it takes both to rule it out.
    return is_given ? fits_better && surer : (fits_better && votes_agree(winner)) || surer;
}

std::vector<Choice> possible_settings(const std::vector<Side>& sources, const std::vector<Side>& targets,
                                      const MatchOptions& options, MatchReport& report, Monitor& monitor, double from,
                                      double to) {
    const bool automatic = options.scale.mode == ScaleMode::automatic;
    const double given = options.scale.mode == ScaleMode::given ? options.scale.value : 1.0;
    Stopwatch watch;
    std::vector<Choice> sides;
    for (const Side& s : sources) {
        for (const Side& t : targets) {
            sides.push_back({{given, &s != &sources.front(), &t != &targets.front()}, &s, &t});
            if (!automatic) continue;
            sides.back().votes = vote_scale(s.coarse.mesh, t.coarse.mesh, options.feature, options.scale,
                                            options.random_seed + 4, options.threads, monitor, from, to);
        }
    }
    note(report, "scale", watch.lap(), 0);
    if (!automatic) return sides;
    if (sides.size() == 2) {
        if (outvoted(sides[1].votes, sides[0].votes, false)) {
            sides.pop_back();
        } else if (outvoted(sides[0].votes, sides[1].votes, true)) {
            sides.erase(sides.begin());
        }
    }
    std::vector<Choice> choices;
    for (Choice side : sides) {
        const double root = std::sqrt(side.target->surface.mesh().area / side.source->surface.mesh().area);
        for (const double scale : scale_candidates(side.votes, root)) {
            side.setting.scale = scale;
            choices.push_back(side);
        }
    }
    return choices;
}

}  // namespace

PreparedPair prepare_pair(const Surface& source, const Surface& target, const MatchOptions& options,
                          MatchReport& report, Monitor& monitor, double from, double to) {
    const double voted = from + 0.3 * (to - from);
    Stopwatch coarsening;
    std::vector<Side> sources{make_side(source, options.hierarchy, monitor)};
    std::vector<Side> targets{make_side(target, options.hierarchy, monitor)};
    // Turning both over changes nothing, so one is enough.
    if (source.orientation_is_ambiguous()) {
        sources.push_back(make_side(source.with_open_parts_reversed(), options.hierarchy, monitor));
    } else if (target.orientation_is_ambiguous()) {
        targets.push_back(make_side(target.with_open_parts_reversed(), options.hierarchy, monitor));
    }
    note(report, "surface", coarsening.lap(), 0);
    const std::vector<Choice> settings = possible_settings(sources, targets, options, report, monitor, from, voted);
    std::optional<PreparedPair> best;
    double best_quality = 0.0;
    for (std::size_t i = 0; i < settings.size(); ++i) {
        const double step = (to - voted) / static_cast<double>(settings.size());
        const double begin = voted + static_cast<double>(i) * step;
        PreparedPair prepared = prepare(*settings[i].source, *settings[i].target, settings[i].setting, options, report,
                                        monitor, begin, begin + 0.8 * step);
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
