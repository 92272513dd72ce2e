// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/setting.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <sstream>

#include "base/costs.h"
#include "base/parallel.h"
#include "base/piece.h"
#include "base/stopwatch.h"
#include "growth/patches.h"
#include "scale/find_scale.h"
#include "scale/half.h"
#include "seed/oriented_match.h"

namespace isograft {

namespace {

std::vector<int> landmark_vertices(const std::vector<Landmark>& landmarks, int Landmark::* end) {
    std::vector<int> vertices;
    for (const Landmark& l : landmarks) vertices.push_back(l.*end);
    return vertices;
}

PreparedPair prepare(Halves& halves, const Side& source, const Side& target, const Setting& setting,
                     const MatchOptions& options, MatchReport& report, Monitor& monitor, double from, double to) {
    const double source_area = source.surface.mesh().area * setting.scale * setting.scale;
    const double target_area = target.surface.mesh().area;
    const double unit = std::sqrt(std::max(source_area, target_area));
    const double smaller = std::min(source_area, target_area) / (unit * unit);
    const HierarchyOptions& hierarchy = options.hierarchy;
    const double spacing =
        std::min(sample_spacing(1.0, hierarchy.samples), sample_spacing(smaller, hierarchy.min_samples));
    const auto& [s, t] = halves.make({HalfRequest{&source, setting.scale / unit, spacing, options.random_seed + 1,
                                                  landmark_vertices(options.landmarks, &Landmark::source)},
                                      HalfRequest{&target, 1.0 / unit, spacing, options.random_seed + 2,
                                                  landmark_vertices(options.landmarks, &Landmark::target)}},
                                     options, report, monitor, from, to);
    PreparedPair prepared{setting, s->detail, t->detail, {}, unit};
    Pair& pair = prepared.pair;
    pair.source = s->sampled;
    pair.target = t->sampled;
    pair.source_curvature = s->curvature;
    pair.target_curvature = t->curvature;
    pair.source_detail = s->fine_curvature;
    pair.target_detail = t->fine_curvature;
    pair.source_descriptor = s->descriptor;
    pair.target_descriptor = t->descriptor;
    pair.chance = chance_distance(pair, options.feature, options.random_seed + 3);
    return prepared;
}

// Quality of a few probes, as better_half(); lower is better.
double probe_setting(const Pair& pair, const MatchOptions& options, Monitor& monitor, double from, double to) {
    const double seeded = from + 0.3 * (to - from);
    const PatchSettings settings{options.feature, options.seed, options.growth, options.blend, options.threads, {}};
    const auto matches = oriented_matches(pair, options.feature, options.seed, options.threads, monitor, from, seeded);
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
        monitor, "scale", seeded, to);
    return better_half(std::move(quality));
}

struct Choice {
    Setting setting;
    const Side* source;
    const Side* target;
    ScaleVotes votes{};
    /// The scale was read off descriptors, and is neither a common unit nor the ratio of two whole areas.
    bool measured = false;

    [[nodiscard]] bool turned() const { return setting.source_reversed || setting.target_reversed; }
};

// What the probes of a setting are worth against those of a likelier one. A winding as given is seldom wrong. Nor are
// two surfaces of one unit rare, and where much is missing or changed, votes err by anything, the more where two
// readings disagree. Of 43 pairs whose votes did not confirm an exact ratio, right measured ones had two readings that
// agreed and probes of 0.26 to 0.67 of those of the common unit; wrong ones 0.78 and more, or 0.44 and more of two that
// disagreed.
double handicap(const Choice& choice) {
    constexpr double turned_over = 0.9, agreed = 0.7, doubtful = 0.4;
    double worth = choice.turned() ? turned_over : 1.0;
    if (choice.measured) worth *= votes_agree(choice.votes) ? agreed : doubtful;
    return worth;
}

// Whether neither surface shows which side is which, so that probes would decide on turning one over by chance.
bool is_flat(const Pair& pair, const FeatureOptions& options) {
    constexpr double least = 0.01;
    const auto bulges = [&](double curvature) { return std::abs(std::atan(options.squash * curvature)) > least; };
    return std::none_of(pair.source_curvature.begin(), pair.source_curvature.end(), bulges) &&
           std::none_of(pair.target_curvature.begin(), pair.target_curvature.end(), bulges);
}

// Whether the votes leave nothing to be said for turning open parts over. The winding as given is never ruled out by
// votes: it is seldom wrong, and windows full of holes can fit anything.
bool outvoted(const ScaleVotes& turned, const ScaleVotes& given) {
    constexpr double clearly = 0.8;
    const bool fits_better = given.fit < clearly * turned.fit;
    return votes_agree(given) && (fits_better || !votes_agree(turned));
}

// A common unit; and of two whole surfaces their size, since what keeps distances keeps areas.
std::vector<double> exact_ratios(const Side& source, const Side& target) {
    const Surface& s = source.surface;
    const Surface& t = target.surface;
    std::vector<double> ratios{1.0};
    const double root = std::sqrt(t.mesh().area / s.mesh().area);
    constexpr double same = 0.03;
    if (s.is_closed() && t.is_closed() && std::abs(std::log(root)) > same) ratios.insert(ratios.begin(), root);
    return ratios;
}

double openness(const TriangleMesh& mesh) {
    const auto open = std::count(mesh.on_boundary.begin(), mesh.on_boundary.end(), 1);
    return static_cast<double>(open) / std::max(1, mesh.vertex_count());
}

// Scales worth trying for one side of each surface. Points of a whole surface vote for anything where an open one lacks
// what they show; then those of the open one are asked as well.
std::vector<double> candidates(const Choice& side, const std::vector<double>& exact, const MatchOptions& options,
                               Monitor& monitor) {
    const auto certain = [&](const std::vector<double>& found) {
        return found.size() == 1 && std::find(exact.begin(), exact.end(), found[0]) != exact.end();
    };
    std::vector<double> found = scale_candidates(side.votes, exact);
    const TriangleMesh& source = side.source->coarse.mesh;
    const TriangleMesh& target = side.target->coarse.mesh;
    if (certain(found) || openness(target) <= 2.0 * openness(source)) return found;
    const double at = monitor.fraction();
    ScaleVotes back = vote_scale(target, source, options.feature, options.scale, options.random_seed + 4,
                                 options.threads, monitor, at, at);
    back.by_fit = 1.0 / back.by_fit;
    back.by_vote = 1.0 / back.by_vote;
    // A measured ratio more is one more that probes may mistake for the right one.
    const std::vector<double> others = scale_candidates(back, exact);
    return certain(others) ? others : found;
}

std::vector<Choice> possible_settings(const std::vector<const Side*>& sources, const std::vector<const Side*>& targets,
                                      const MatchOptions& options, MatchReport& report, Monitor& monitor, double from,
                                      double to) {
    const auto combinations = static_cast<double>(sources.size() * targets.size());
    const bool automatic = options.scale.mode == ScaleMode::automatic;
    const double given = options.scale.mode == ScaleMode::given ? options.scale.value : 1.0;
    Stopwatch watch;
    std::vector<Choice> sides;
    for (const Side* s : sources) {
        for (const Side* t : targets) {
            sides.push_back({{given, s != sources.front(), t != targets.front()}, s, t});
            if (!automatic) continue;
            const double step = (to - from) / combinations;
            const double begin = from + step * static_cast<double>(sides.size() - 1);
            sides.back().votes = vote_scale(s->coarse.mesh, t->coarse.mesh, options.feature, options.scale,
                                            options.random_seed + 4, options.threads, monitor, begin, begin + step);
        }
    }
    note(report, "scale", watch.lap(), 0);
    if (!automatic) return sides;
    if (sides.size() == 2 && outvoted(sides[1].votes, sides[0].votes)) sides.pop_back();
    std::vector<Choice> choices;
    for (Choice side : sides) {
        const std::vector<double> exact = exact_ratios(*side.source, *side.target);
        for (const double scale : candidates(side, exact, options, monitor)) {
            side.setting.scale = scale;
            side.measured = std::find(exact.begin(), exact.end(), scale) == exact.end();
            choices.push_back(side);
        }
    }
    note(report, "scale", watch.lap(), 0);
    return choices;
}

}  // namespace

PreparedPair prepare_pair(Surface source, Surface target, const MatchOptions& options, MatchReport& report,
                          Monitor& monitor, double from, double to, double later) {
    Stopwatch coarsening;
    const bool turn_source = source.orientation_is_ambiguous();
    std::vector<Surface> surfaces;
    surfaces.reserve(3);
    surfaces.push_back(std::move(source));
    surfaces.push_back(std::move(target));
    // Turning both over changes nothing, so one is enough.
    if (const Surface& either = surfaces[turn_source ? 0 : 1]; either.orientation_is_ambiguous()) {
        surfaces.push_back(either.with_open_parts_reversed(&monitor).in_own_frame(monitor));
    }
    const Costs costs(options);
    const bool automatic = options.scale.mode == ScaleMode::automatic;
    const double votes = automatic ? costs.votes(static_cast<int>(surfaces.size()) - 1) : 0.0;
    std::vector<std::int64_t> vertices;
    for (const Surface& s : surfaces) vertices.push_back(s.mesh().vertex_count());
    const double all = static_cast<double>(std::accumulate(vertices.begin(), vertices.end(), std::int64_t{0}));
    const double coarse_by = end_of_part(from, to, costs.coarsening(vertices), votes + costs.setting() + later);
    std::vector<Side> made(surfaces.size());
    parallel_for(
        static_cast<int>(surfaces.size()), options.threads,
        [&](int i, int /*worker*/) {
            const double share = static_cast<double>(vertices[i]) / all;
            // A mesh whose holes are closed takes the place of the one before.
            surfaces[i] = surfaces[i].with_holes_closed(options.surface.close_holes, monitor);
            made[i] = make_side(surfaces[i], options.hierarchy, Piece(monitor, share * (coarse_by - from)));
        },
        monitor, "surface", from, from);
    std::vector<const Side*> sources{made.data()}, targets{&made[1]};
    if (made.size() > 2) (turn_source ? sources : targets).push_back(&made[2]);
    note(report, "surface", coarsening.lap(), 0);
    const double voted = end_of_part(coarse_by, to, votes, costs.setting() + later);
    const std::vector<Choice> settings =
        possible_settings(sources, targets, options, report, monitor, coarse_by, voted);
    Halves halves;
    std::optional<PreparedPair> best;
    double best_worth = 0.0;
    const bool probed = settings.size() > 1;
    const double probes = probed ? costs.probes_of_setting() : 0.0;
    double begin = voted;
    for (std::size_t i = 0; i < settings.size(); ++i) {
        if (best && settings[i].turned() && is_flat(best->pair, options.feature)) break;
        const auto left = static_cast<double>(settings.size() - i - 1);
        const double done = end_of_part(begin, to, costs.setting() + probes, left * (costs.setting() + probes) + later);
        const double end = end_of_part(begin, done, costs.setting(), probes);
        PreparedPair prepared = prepare(halves, *settings[i].source, *settings[i].target, settings[i].setting, options,
                                        report, monitor, begin, end);
        if (!probed) {
            best = std::move(prepared);
            break;
        }
        Stopwatch watch;
        const double quality = probe_setting(prepared.pair, options, monitor, end, done);
        begin = done;
        note(report, "scale", watch.lap(), 0);
        // Of two that are as likely, the earlier one has a little more for it.
        const double worth = quality / handicap(settings[i]);
        if (!best || worth < 0.95 * best_worth) {
            best = std::move(prepared);
            best_worth = worth;
        }
    }
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
