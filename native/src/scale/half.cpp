// SPDX-License-Identifier: GPL-3.0-or-later
#include "scale/half.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/stopwatch.h"
#include "feature/curvature.h"
#include "surface/clean.h"

namespace isograft {

namespace {

Detail make_detail(const HalfRequest& request, const HierarchyOptions& options, Monitor& monitor) {
    Detail detail{request.side->surface, request.factor, {}};
    const double edge = options.coarse_edge * request.spacing / request.factor;
    if (edge <= 1.25 * request.side->edge) {
        detail.coarse = request.side->coarse;
    } else {
        detail.coarse = coarsen_further(detail.fine(), request.side->coarse, edge, monitor);
    }
    return detail;
}

std::vector<SurfacePoint> fixed_points(const Detail& detail, const std::vector<int>& vertices) {
    std::vector<SurfacePoint> points;
    if (vertices.empty()) return points;
    const std::vector<int> working = working_vertices(detail.surface);
    for (const int vertex : vertices) {
        // match() has refused vertices that are not there.
        const int v = working[vertex];
        points.push_back(detail.coarse.place.empty() ? point_near_vertex(detail.fine(), v) : detail.coarse.place[v]);
    }
    return points;
}

// Curvature goes down as lengths go up, and heat needs the square of them.
void add_curvature(Half& half, const FeatureOptions& options, Monitor& monitor) {
    const double factor = half.detail.factor;
    CoarseMesh& coarse = half.detail.coarse;
    const std::vector<double> times{curvature_time(options) / (factor * factor), detail_time / (factor * factor)};
    std::vector<std::vector<double>> fields = coarse_curvatures(half.detail.fine(), coarse, times, monitor);
    for (std::vector<double>& field : fields) {
        for (double& h : field) h /= factor;
    }
    half.curvature = std::move(fields[0]);
    half.fine_curvature = std::move(fields[1]);
}

}  // namespace

void note(MatchReport& report, const std::string& stage, double seconds, std::int64_t bytes) {
    const auto found =
        std::find_if(report.stages.begin(), report.stages.end(), [&](const StageReport& s) { return s.name == stage; });
    if (found != report.stages.end()) {
        found->seconds += seconds;
        found->bytes = std::max(found->bytes, bytes);
    } else {
        report.stages.push_back({stage, seconds, bytes});
    }
}

Side make_side(const Surface& surface, const HierarchyOptions& options, Piece progress) {
    const double side = std::sqrt(surface.mesh().area);
    Side result{surface, {}, options.coarse_edge * sample_spacing(1.0, options.samples) * side};
    if (result.edge > 0.0) {
        result.coarse = coarsen(surface.mesh(), result.edge, progress.until(1.0));
    } else {
        result.coarse.mesh = surface.mesh();
        measure_paths(result.coarse.mesh, progress.monitor());
    }
    return result;
}

const Halves::Both& Halves::make(const std::array<HalfRequest, 2>& requests, const MatchOptions& options,
                                 MatchReport& report, Monitor& monitor, double from, double to) {
    Stopwatch watch;
    std::vector<std::shared_ptr<Half>> made;
    std::vector<const HalfRequest*> wanted;
    for (int side = 0; side < 2; ++side) {
        if (half_[side] != nullptr && requests[side] == request_[side]) continue;
        const auto half = std::make_shared<Half>();
        half_[side] = half;
        request_[side] = requests[side];
        made.push_back(half);
        wanted.push_back(&requests[side]);
    }
    const int count = static_cast<int>(made.size());
    const auto at = [&](double share) { return from + share * (to - from); };
    parallel_for(
        count, options.threads,
        [&](int i, int /*worker*/) {
            Half& half = *made[i];
            half.detail = make_detail(*wanted[i], options.hierarchy, monitor);
            half.sampled.mesh = scaled(half.detail.coarse.mesh, half.detail.factor);
        },
        monitor, "samples", from, from);
    // Two jobs for either surface: the points, and the curvature.
    parallel_for(
        2 * count, options.threads,
        [&](int job, int /*worker*/) {
            Half& half = *made[job / 2];
            const HalfRequest& request = *wanted[job / 2];
            if (job % 2 == 0) {
                half.sampled.samples = spread_samples(half.sampled.mesh, request.spacing, options.hierarchy,
                                                      request.seed, monitor, fixed_points(half.detail, request.fixed));
            } else {
                add_curvature(half, options.feature, monitor);
            }
        },
        monitor, "samples", from, at(0.15));
    for (int i = 0; i < count; ++i) {
        Half& half = *made[i];
        join_samples(half.sampled.mesh, half.sampled.samples, options.hierarchy, options.threads, monitor,
                     at(0.15 + 0.2 * i / count), at(0.15 + 0.2 * (i + 1) / count));
        half.detail.coarse.mesh = half.sampled.mesh;
        note(report, "samples", watch.lap(), half.sampled.samples.bytes());
    }
    for (int i = 0; i < count; ++i) {
        Half& half = *made[i];
        half.descriptor = window_descriptors(half.sampled.mesh, half.sampled.samples.point, half.curvature, 1.0,
                                             options.feature, options.threads, monitor, at(0.35 + 0.65 * i / count),
                                             at(0.35 + 0.65 * (i + 1) / count));
        note(report, "features", watch.lap(),
             static_cast<std::int64_t>(half.descriptor.size() * sizeof(PolarDescriptor)));
    }
    return half_;
}

}  // namespace isograft
