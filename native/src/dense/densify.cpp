// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/densify.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "base/parallel.h"
#include "base/sorting.h"
#include "dense/cloud_rows.h"
#include "dense/vertex_place.h"
#include "geodesic/trace.h"
#include "growth/image_cells.h"
#include "isograft/errors.h"
#include "surface/clean.h"

namespace isograft {

void DenseOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("dense." + what);
    };
    require(refine_weight >= 0.0 && std::isfinite(refine_weight), "refine_weight must not be negative");
    require(refine_coarse_iterations >= 0 && refine_coarse_iterations <= 100,
            "refine_coarse_iterations must be in [0, 100]");
    require(refine_relief_iterations >= 0 && refine_relief_iterations <= 100,
            "refine_relief_iterations must be in [0, 100]");
    require(refine_iterations >= 0 && refine_iterations <= 100, "refine_iterations must be in [0, 100]");
    require(reach > 0.0 && reach <= 1.6, "reach must be in (0, 1.6]");
}

namespace {

struct VertexImage {
    SurfacePoint point;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double confidence = 0.0;
    double stretch = 0.0;
    int region = -1;
};

// Where the samples near coarse vertex `v` say it goes.
VertexImage image_of(int v, const PartialMap& map, const Pair& pair, const SampleNotes& notes,
                     const DenseOptions& options) {
    VertexImage image;
    const auto place = place_of_vertex(v, map, pair, options.reach * pair.source.samples.spacing);
    if (!place) return image;
    const VertexPlace::Say* surest = &place->said.front();
    for (const VertexPlace::Say& say : place->said) {
        image.confidence += say.weight * notes.confidence[say.sample];
        image.stretch += say.weight * notes.stretch[say.sample];
        if (say.weight > surest->weight) surest = &say;
    }
    image.confidence /= place->total;
    image.stretch /= place->total;
    image.region = notes.region[surest->sample];
    image.point = place->point;
    image.position = place->position;
    return image;
}

// A point of a source mesh between the vertices of its triangle.
VertexImage between(const TriangleMesh& mesh, const SurfacePoint& place, const std::vector<VertexImage>& coarse,
                    const Pair& pair) {
    const auto& corners = mesh.face[place.face];
    VertexImage image;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double total = 0.0;
    int heaviest = -1;
    for (int k = 0; k < 3; ++k) {
        const VertexImage& c = coarse[corners[k]];
        if (c.point.face < 0) continue;
        mean += place.weight[k] * c.position;
        image.confidence += place.weight[k] * c.confidence;
        image.stretch += place.weight[k] * c.stretch;
        total += place.weight[k];
        if (heaviest < 0 || place.weight[k] > place.weight[heaviest]) heaviest = k;
    }
    if (total < 0.5) return image;
    mean /= total;
    const VertexImage& nearest = coarse[corners[heaviest]];
    // Corners torn apart do not average to anything.
    const double apart = (nearest.position - mean).norm();
    image.point =
        apart < 2.0 * pair.source.samples.spacing ? walked_to(pair.target.mesh, nearest.point, mean) : nearest.point;
    image.position = position(pair.target.mesh, image.point);
    image.confidence /= total;
    image.stretch /= total;
    image.region = nearest.region;
    return image;
}

void unmatch_all(Correspondence& c, Eigen::Index n) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    c.face = Eigen::VectorXi::Constant(n, -1);
    c.vertex = Eigen::VectorXi::Constant(n, -1);
    c.region = Eigen::VectorXi::Constant(n, -1);
    c.barycentric = Points::Constant(n, 3, nan);
    c.points = Points::Constant(n, 3, nan);
    c.stretch = Eigen::VectorXd::Constant(n, nan);
    c.confidence = Eigen::VectorXd::Zero(n);
}

// The image's point is one of the fine target already.
void write_row(Correspondence& c, Eigen::Index row, const VertexImage& image, const Detail& target,
               const std::optional<CloudRows>& cloud) {
    SurfacePoint point = image.point;
    // What closes a hole is not there.
    if (!cloud && target.fine().input_face[point.face] < 0) return;
    c.confidence[row] = image.confidence;
    c.stretch[row] = image.stretch;
    c.region[row] = image.region;
    if (cloud) {
        cloud->write(c, row, point);
        return;
    }
    const TriangleMesh& mesh = target.fine();
    const Surface& surface = target.surface;
    const int input = mesh.input_face[point.face];
    const auto weight = point.weight;
    for (int k = 0; k < 3; ++k) point.weight[mesh.input_corner(point.face, k)] = weight[k];
    c.face[row] = input;
    Eigen::RowVector3d x = Eigen::RowVector3d::Zero();
    int largest = 0;
    for (int k = 0; k < 3; ++k) {
        c.barycentric(row, k) = point.weight[k];
        x += point.weight[k] * surface.vertices().row(surface.faces()(input, k));
        if (point.weight[k] > point.weight[largest]) largest = k;
    }
    c.points.row(row) = x;
    c.vertex[row] = surface.faces()(input, largest);
}

// Vertices that the gate welded share one image.
void share_welded(Correspondence& c, const Detail& source) {
    const std::vector<int> working = working_vertices(source.surface);
    for (Eigen::Index v = 0; v < c.face.size(); ++v) {
        if (working[v] < 0 || c.vertex[v] >= 0) continue;
        const int row = source.fine().input_vertex[working[v]];
        if (c.vertex[row] < 0) continue;
        if (c.corners.rows() > 0) c.corners.row(v) = c.corners.row(row);
        c.face[v] = c.face[row];
        c.barycentric.row(v) = c.barycentric.row(row);
        c.points.row(v) = c.points.row(row);
        c.vertex[v] = c.vertex[row];
        c.confidence[v] = c.confidence[row];
        c.stretch[v] = c.stretch[row];
        c.region[v] = c.region[row];
    }
}

}  // namespace

void drop_collisions(PartialMap& map, const Pair& pair, const std::vector<double>& risk, double radius) {
    const Samples& source = pair.source.samples;
    std::vector<int> order;
    for (int s = 0; s < source.count(); ++s) {
        if (map.mapped[s]) order.push_back(s);
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return risk[a] < risk[b]; });
    ImageCells images(pair);
    for (const int s : order) {
        if (images.taken(map, s, map.image[s], radius * source.spacing)) {
            map.drop(s);
        } else {
            images.put(map, s);
        }
    }
}

Correspondence densify(const PartialMap& map, const Pair& pair, const SampleNotes& notes, const DenseOptions& options,
                       const Detail& source, const Detail& target, int threads, Monitor& monitor, double from,
                       double to) {
    constexpr int block = 256;
    const auto for_each = [&](int count, double begin, double end, const std::function<void(int)>& task) {
        parallel_for((count + block - 1) / block, threads,
                     [&](int b, int /*worker*/) {
                         for (int v = b * block; v < std::min(count, (b + 1) * block); ++v) task(v);
                     },
                     monitor, "dense", begin, end);
    };
    const double middle = 0.5 * (from + to);
    const int coarse_count = pair.source.mesh.vertex_count();
    std::vector<VertexImage> coarse(coarse_count);
    for_each(coarse_count, from, middle, [&](int v) { coarse[v] = image_of(v, map, pair, notes, options); });
    const bool same = source.coarse.fine_vertex.empty();
    const int fine_count = source.fine().vertex_count();
    // Those of a cloud's mesh are on the way only.
    const bool of_cloud = source.surface.is_cloud();
    std::vector<VertexImage> images(fine_count);
    for_each(fine_count, middle, to, [&](int v) {
        if (same) {
            images[v] = coarse[v];
        } else if (source.coarse.place[v].face >= 0) {
            images[v] = between(pair.source.mesh, source.coarse.place[v], coarse, pair);
        }
        if (images[v].point.face >= 0 && !of_cloud) images[v].point = to_fine(target, images[v].point);
    });
    Correspondence result;
    const Eigen::Index rows = source.surface.vertices().rows();
    unmatch_all(result, rows);
    std::optional<CloudRows> cloud;
    if (target.surface.is_cloud()) {
        cloud.emplace(target.surface);
        result.corners = Triangles::Constant(rows, 3, -1);
    }
    const auto write = [&](Eigen::Index row, const VertexImage& image) {
        if (image.point.face >= 0 && image.region >= 0) write_row(result, row, image, target, cloud);
    };
    if (of_cloud) {
        // Every point follows the triangle it lies on.
        const std::vector<SurfacePoint> place = cloud_places(source.surface, monitor);
        for_each(static_cast<int>(rows), to, to, [&](int row) {
            if (place[row].face < 0) return;
            VertexImage image = between(source.fine(), place[row], images, pair);
            if (image.point.face >= 0) image.point = to_fine(target, image.point);
            write(row, image);
        });
        return result;
    }
    for (int v = 0; v < fine_count; ++v) {
        if (v % often == 0) monitor.check();
        const int row = source.fine().input_vertex[v];
        if (row < 0) continue;
        // A vertex that was split keeps its surer copy.
        if (images[v].confidence >= result.confidence[row]) write(row, images[v]);
    }
    monitor.check();
    share_welded(result, source);
    return result;
}

}  // namespace isograft
