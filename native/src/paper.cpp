// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/stopwatch.h"
#include "blend/centroid.h"
#include "blend/dissimilarity.h"
#include "blend/linkage.h"
#include "blend/merge.h"
#include "dense/densify.h"
#include "feature/distinctiveness.h"
#include "feature/fingerprint.h"
#include "geodesic/shoot.h"
#include "growth/flood.h"
#include "isograft/errors.h"
#include "scale/setting.h"
#include "seed/feature_seeds.h"
#include "surface/clean.h"

namespace isograft {

void PaperOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("paper." + what);
    };
    require(vertices >= 100 && vertices <= 200000, "vertices must be in [100, 200000]");
    require(levels >= 1 && levels <= 10, "levels must be in [1, 10]");
    require(radius_min > 0.0 && radius_min < radius_max, "radius_min must be positive and below radius_max");
    require(radius_max <= 20.0, "radius_max must be at most 20, the diameter");
    require(contours >= 2 && contours <= 100, "contours must be in [2, 100]");
    require(candidates >= 1 && candidates <= 1000, "candidates must be in [1, 1000]");
    require(descriptor_weight >= 0.0 && std::isfinite(descriptor_weight), "descriptor_weight must not be negative");
    require(distance_weight >= 0.0 && std::isfinite(distance_weight), "distance_weight must not be negative");
    require(cluster_limit >= 0.0 && std::isfinite(cluster_limit), "cluster_limit must not be negative");
    require(matches >= 1 && matches <= 2000, "matches must be in [1, 2000]");
    require(stretch_limit > 0.0 && stretch_limit <= 10.0, "stretch_limit must be in (0, 10]");
    require(near >= 0.5 && near <= 4.0, "near must be in [0.5, 4]");
    require(iterations >= 1 && iterations <= 100, "iterations must be in [1, 100]");
    require(neighbours >= 1 && neighbours <= 2000, "neighbours must be in [1, 2000]");
    require(threshold >= 0.0 && std::isfinite(threshold), "threshold must not be negative");
    require(decay > 0.0 && std::isfinite(decay), "decay must be positive");
}

namespace {

// Progress at the end of each step.
constexpr double prepared_by = 0.05, levels_by = 0.07, features_by = 0.15, grown_by = 0.85, clustered_by = 0.92,
                 merged_by = 0.97;
// Features whose geodesic distance is below this many top-level spacings are neighbours in the hierarchy.
constexpr double feature_reach = 2.0;
// Nearer neighbours than this many e0 give no direction.
constexpr double least_baseline = 4.0;
// R in diameters of S.
constexpr double radius_share = 0.05;
constexpr int most_alternatives = 3;
constexpr double worthy_alternative = 0.5;

struct Work {
    Detail source, target;
    Pair pair;
    VertexLevels levels;
};

Detail work_detail(const Surface& surface, double factor, int vertices, const std::string& name, MatchReport& report,
                   Monitor& monitor) {
    Detail detail{surface, factor, {}};
    const int given = surface.mesh().vertex_count();
    if (given > vertices) {
        const TriangleMesh fine = scaled(surface.mesh(), factor);
        // An even mesh of equilateral triangles has two of them a vertex.
        detail.coarse = coarsen(fine, std::sqrt(fine.area / (0.866 * vertices)), monitor, 1.0);
    } else {
        // Paths first, as everywhere: measured on the scaled mesh they would be rounded otherwise.
        detail.coarse.mesh = scaled(surface.mesh_with_paths(), factor);
    }
    if (!detail.coarse.fine_vertex.empty()) {
        report.warnings.push_back(name + ": decimated from " + std::to_string(given) + " to " +
                                  std::to_string(detail.coarse.mesh.vertex_count()) +
                                  " vertices for preset paper; set paper_vertices for another size");
    }
    return detail;
}

Work prepare(const Surface& source, const Surface& target, const MatchOptions& options, MatchReport& report,
             Monitor& monitor) {
    Work work;
    Setting setting;
    Surface s = source, t = target;
    const bool sides_known =
        options.seed.landmarks_only || (!source.orientation_is_ambiguous() && !target.orientation_is_ambiguous());
    if (options.scale.mode == ScaleMode::automatic || !sides_known) {
        // The paper has both in one scale and oriented beforehand; here that is found as in preset fast.
        MatchOptions quick = options;
        const MatchOptions fast = preset_options("fast");
        quick.hierarchy = fast.hierarchy;
        quick.seed = fast.seed;
        quick.landmarks.clear();
        quick.surface.close_holes = 0.0;
        const PreparedPair prepared = prepare_pair(source, target, quick, report, monitor, 0.0, prepared_by);
        setting = prepared.setting;
        // Given features fix the side too: that of the input.
        if (!options.seed.landmarks_only) {
            s = prepared.source.surface;
            t = prepared.target.surface;
        }
    } else if (options.scale.mode == ScaleMode::given) {
        setting.scale = options.scale.value;
    }
    const double source_area = s.mesh().area * setting.scale * setting.scale;
    const double unit = std::sqrt(std::max(source_area, t.mesh().area));
    report.scale = setting.scale;
    report.unit_length = unit;
    work.source = work_detail(s, setting.scale / unit, options.paper.vertices, "source", report, monitor);
    work.target = work_detail(t, 1.0 / unit, options.paper.vertices, "target", report, monitor);
    work.pair.source.mesh = work.source.coarse.mesh;
    work.pair.target.mesh = work.target.coarse.mesh;
    return work;
}

SurfacePoint place_of(const Detail& detail, int input_vertex) {
    const int v = working_vertices(detail.surface)[input_vertex];
    return detail.coarse.place.empty() ? point_near_vertex(detail.coarse.mesh, v) : detail.coarse.place[v];
}

struct Features {
    FeatureSet set;
    std::vector<int> vertex;
};

Features find_features(const TriangleMesh& mesh, const std::vector<double>& radii, int threads, Monitor& monitor,
                       double from, double to) {
    std::vector<SurfacePoint> points;
    for (int v = 0; v < mesh.vertex_count(); ++v) points.push_back(point_near_vertex(mesh, v));
    const Eigen::MatrixXd descriptor = fingerprints(mesh, points, radii, threads, monitor, from, to);
    const Eigen::VectorXd distinct = distinctiveness(descriptor);
    Features features;
    features.vertex = local_maxima(mesh, distinct);
    features.set.descriptor = descriptor(features.vertex, Eigen::all);
    features.set.distinctiveness = distinct(features.vertex);
    return features;
}

// Sections 4.2 and 5.1, up to the queue of oriented matches.
std::vector<OrientedMatch> find_seeds(const Work& work, const MatchOptions& options, Monitor& monitor) {
    const PaperOptions& paper = options.paper;
    const TriangleMesh& source = work.pair.source.mesh;
    const TriangleMesh& target = work.pair.target.mesh;
    const double e0 = work.levels.samples.spacing;
    const double step = (features_by - levels_by) / 4.0;
    FeaturePlaces places;
    std::vector<SurfacePoint> source_points;
    std::vector<FeatureMatch> matches;
    if (!options.seed.landmarks_only) {
        const auto radii = contour_radii(paper, geodesic_diameter(source, monitor));
        const Features s = find_features(source, radii, options.threads, monitor, levels_by, levels_by + step);
        const Features t =
            find_features(target, radii, options.threads, monitor, levels_by + step, levels_by + 2.0 * step);
        matches = candidate_matches(s.set, t.set, paper.candidates, paper.descriptor_weight);
        places.source = s.vertex;
        for (const int v : t.vertex) places.target.push_back(point_near_vertex(target, v));
    }
    for (const int v : places.source) source_points.push_back(point_near_vertex(source, v));
    double least = 0.0;
    for (const FeatureMatch& m : matches) least = std::min(least, m.dissimilarity);
    for (const Landmark& l : options.landmarks) {
        const int v = nearest_corner(source, place_of(work.source, l.source));
        matches.push_back({static_cast<int>(places.source.size()), static_cast<int>(places.target.size()),
                           least - std::log(l.weight), 0.0});
        places.source.push_back(v);
        source_points.push_back(point_near_vertex(source, v));
        places.target.push_back(place_of(work.target, l.target));
    }
    ClusterOptions cluster;
    cluster.weight = stretch_weight(paper, e0);
    cluster.limit = paper.cluster_limit;
    // A few given features may lie far apart; found ones are dense.
    cluster.reach = options.seed.landmarks_only ? std::numeric_limits<double>::infinity()
                                                : feature_reach * work.levels.spacing(paper.levels - 1);
    constexpr double unbounded = std::numeric_limits<double>::infinity();
    const auto on_source = feature_geodesics(source, source_points, cluster.reach, options.threads, monitor,
                                             levels_by + 2.0 * step, levels_by + 3.0 * step);
    const auto on_target = feature_geodesics(target, places.target, unbounded, options.threads, monitor,
                                             levels_by + 3.0 * step, features_by);
    cluster_matches(matches, on_source, on_target, cluster, monitor);
    return feature_seeds(matches, places, on_source, on_target, cluster, least_baseline * e0);
}

// Mean relative stretch over the mesh edges at every mapped vertex.
std::vector<double> mean_stretch(const VertexLevels& levels, const TriangleMesh& target, const PartialMap& map) {
    const Samples& samples = levels.samples;
    std::vector<double> sum(samples.count(), 0.0);
    std::vector<int> count(samples.count(), 0);
    for (const SampleEdge& e : samples.edges) {
        if (e.level > 0 || !is_active(e, map)) continue;
        const auto shot = shoot(target, map.image[e.u], map.image[e.v], e.at_u * map.rotation[e.u], e.length);
        const double stretch = shot ? std::abs(shot->length / e.length - 1.0) : 1.0;
        for (const int s : {e.u, e.v}) {
            sum[s] += stretch;
            ++count[s];
        }
    }
    for (std::size_t s = 0; s < sum.size(); ++s) sum[s] /= std::max(1, count[s]);
    return sum;
}

double covered(const Samples& samples, const std::vector<PartialMap>& maps, const std::vector<int>& members) {
    double area = 0.0;
    for (int s = 0; s < samples.count(); ++s) {
        if (std::any_of(members.begin(), members.end(), [&](int m) { return maps[m].mapped[s] != 0; })) {
            area += samples.area[s];
        }
    }
    return area;
}

}  // namespace

std::vector<double> contour_radii(const PaperOptions& paper, double diameter) {
    const double radius = radius_share * diameter;
    return even_radii(paper.radius_min * radius, paper.radius_max * radius, paper.contours);
}

double stretch_weight(const PaperOptions& paper, double e0) { return paper.distance_weight / (e0 * e0); }

double merge_decay(const PaperOptions& paper, double e0) { return paper.decay * 2.0 * e0; }

Match match_by_paper(const Surface& source, const Surface& target, const MatchOptions& options, Monitor& monitor) {
    const PaperOptions& paper = options.paper;
    if (options.seed.landmarks_only && options.landmarks.size() < 2) {
        throw InvalidInput(
            "seed.landmarks_only needs at least 2 landmarks, since each direction comes from a second one; " +
            std::to_string(options.landmarks.size()) + " given");
    }
    Match result;
    MatchReport& report = result.report;
    for (const auto& w : source.warnings()) report.warnings.push_back("source: " + w);
    for (const auto& w : target.warnings()) report.warnings.push_back("target: " + w);
    Stopwatch whole, watch;
    const auto lap = [&](const char* name, std::int64_t bytes) { report.stages.push_back({name, watch.lap(), bytes}); };

    Work work = prepare(source, target, options, report, monitor);
    report.stages.clear();
    lap("surface", 0);
    work.levels = make_vertex_levels(work.pair.source.mesh, paper.levels, options.threads, monitor, prepared_by,
                                     levels_by, paper.near);
    work.pair.source.samples = work.levels.samples;
    const VertexLevels& levels = work.levels;
    const TriangleMesh& mesh = work.pair.target.mesh;
    report.source_samples = levels.samples.count();
    report.target_samples = mesh.vertex_count();
    lap("hierarchy", levels.samples.bytes() + static_cast<std::int64_t>(levels.near.size() * sizeof(SampleEdge)));

    const std::vector<OrientedMatch> seeds = find_seeds(work, options, monitor);
    lap("features", static_cast<std::int64_t>(seeds.size() * sizeof(OrientedMatch)));

    const FloodOptions flood_options{.stretch_limit = paper.stretch_limit, .fit = {.iterations = paper.iterations}};
    const Floods floods =
        flood_all(levels, mesh, seeds, paper.matches, flood_options, options.threads, monitor, features_by, grown_by);
    report.seeds_tried = floods.tried;
    report.maps_grown = static_cast<int>(floods.maps.size());
    const std::int64_t map_bytes = levels.samples.count() * static_cast<std::int64_t>(sizeof(SurfacePoint) + 48);
    lap("growth", map_bytes * report.maps_grown);

    const double third = (clustered_by - grown_by) / 3.0;
    Clusters clusters;
    if (!floods.maps.empty()) {
        const double cell = levels.spacing(2);
        const DistanceTable on_source(work.pair.source.mesh, cell, options.threads, monitor, grown_by,
                                      grown_by + third);
        const DistanceTable on_target(mesh, cell, options.threads, monitor, grown_by + third, grown_by + 2.0 * third);
        const Eigen::MatrixXd d = map_dissimilarities(levels, on_source, mesh, on_target, floods.maps, options.threads,
                                                      monitor, grown_by + 2.0 * third, clustered_by);
        clusters = graph_degree_linkage(d, {paper.neighbours, paper.threshold});
    } else {
        report.warnings.emplace_back(
            "no feature match could be grown, so everything is unmatched; check that both surfaces show the same "
            "shape, "
            "try preset default, or give landmarks");
        clusters.members.emplace_back();
        clusters.affinity.push_back(0.0);
    }
    lap("clustering", 0);

    std::vector<double> area;
    for (const auto& members : clusters.members) area.push_back(covered(levels.samples, floods.maps, members));
    const std::vector<int> order = by_affinity_and_area(clusters, area);
    report.maps_in_core = static_cast<int>(clusters.members[order.front()].size());
    for (const int c : order) {
        const std::vector<int>& members = clusters.members[c];
        if (area[c] < worthy_alternative * area[order.front()]) continue;
        if (static_cast<int>(result.correspondences.size()) > most_alternatives) break;
        std::vector<const PartialMap*> maps;
        for (const int m : members) maps.push_back(&floods.maps[m]);
        const MergedMap merged = merge_by_centroid(levels, mesh, maps, merge_decay(paper, levels.samples.spacing),
                                                   options.threads, monitor, clustered_by, merged_by);
        SampleNotes notes;
        notes.stretch = mean_stretch(levels, mesh, merged.map);
        notes.region = continuous_parts(merged.map, work.pair);
        // The paper has no confidence; here it falls with the disagreement of the cluster's maps, by e per e1.
        for (const double spread : merged.spread) notes.confidence.push_back(std::exp(-0.5 * spread));
        result.correspondences.push_back(densify(merged.map, work.pair, notes, options.dense, work.source, work.target,
                                                 options.threads, monitor, merged_by, 1.0));
    }
    if (result.correspondences.size() > 1) {
        report.warnings.push_back(
            std::to_string(result.correspondences.size() - 1) +
            " other cluster(s) of maps cover at least half as much as the chosen one and contradict "
            "it; they are returned as alternatives");
    }
    lap("merging", map_bytes);
    report.seconds = whole.lap();
    monitor.report("done", 1.0);
    return result;
}

}  // namespace isograft
