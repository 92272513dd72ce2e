// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/densify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/parallel.h"
#include "geodesic/trace.h"
#include "isograft/errors.h"

namespace isograft {

void DenseOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("dense." + what);
    };
    require(refine_weight >= 0.0 && std::isfinite(refine_weight), "refine_weight must not be negative");
    require(refine_iterations >= 0 && refine_iterations <= 100, "refine_iterations must be in [0, 100]");
    require(reach > 0.0 && reach <= 1.6, "reach must be in (0, 1.6]");
}

namespace {

struct Landing {
    SurfacePoint point;
    Eigen::Vector3d position;
    double weight;
    int sample;
};

struct VertexImage {
    SurfacePoint point;
    double confidence = 0.0;
    double stretch = 0.0;
    int region = -1;
};

// Where the samples near vertex `v` say it goes.
VertexImage image_of(int v, const PartialMap& map, const Pair& pair, const SampleNotes& notes,
                     const DenseOptions& options) {
    const TriangleMesh& target = pair.target.mesh;
    std::vector<Landing> landings;
    double nearest = std::numeric_limits<double>::max();
    for (const NearSample& near : pair.source.samples.near_vertex[v]) {
        if (!map.mapped[near.sample]) continue;
        const double d = std::max<double>(near.distance, 1e-6);
        const Trace t = trace(target, map.image[near.sample], std::polar(1.0, static_cast<double>(near.angle)) *
                                                                  map.rotation[near.sample], d);
        if (!t.complete) continue;
        landings.push_back({t.end, position(target, t.end), 1.0 / (d * d), near.sample});
        nearest = std::min(nearest, d);
    }
    VertexImage image;
    if (nearest > options.reach * pair.source.samples.spacing) return image;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double total = 0.0;
    const Landing* surest = &landings.front();
    for (const Landing& l : landings) {
        mean += l.weight * l.position;
        total += l.weight;
        image.confidence += l.weight * notes.confidence[l.sample];
        image.stretch += l.weight * notes.stretch[l.sample];
        if (l.weight > surest->weight) surest = &l;
    }
    mean /= total;
    image.confidence /= total;
    image.stretch /= total;
    image.region = notes.region[surest->sample];
    const auto start = std::min_element(landings.begin(), landings.end(), [&](const Landing& a, const Landing& b) {
        return (a.position - mean).squaredNorm() < (b.position - mean).squaredNorm();
    });
    const Complex step = flatten(target, start->point.face, mean - start->position);
    image.point = std::abs(step) > 1e-12 ? trace(target, start->point, step, std::abs(step)).end : start->point;
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

void write_row(Correspondence& c, Eigen::Index row, const VertexImage& image, const TriangleMesh& mesh,
               const Surface& target) {
    const int f = image.point.face;
    const int input = mesh.input_face[f];
    std::array<double, 3> weight = image.point.weight;
    if (mesh.input_reversed[f]) std::swap(weight[1], weight[2]);
    c.face[row] = input;
    Eigen::RowVector3d point = Eigen::RowVector3d::Zero();
    int largest = 0;
    for (int k = 0; k < 3; ++k) {
        c.barycentric(row, k) = weight[k];
        point += weight[k] * target.vertices().row(target.faces()(input, k));
        if (weight[k] > weight[largest]) largest = k;
    }
    c.points.row(row) = point;
    c.vertex[row] = target.faces()(input, largest);
    c.confidence[row] = image.confidence;
    c.stretch[row] = image.stretch;
    c.region[row] = image.region;
}

}  // namespace

void drop_collisions(PartialMap& map, const Pair& pair, const std::vector<double>& risk, double radius) {
    const Samples& source = pair.source.samples;
    const Samples& target = pair.target.samples;
    std::vector<std::vector<int>> cell(target.count());
    std::vector<int> order;
    for (int s = 0; s < source.count(); ++s) {
        if (map.mapped[s]) order.push_back(s);
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return risk[a] < risk[b]; });
    const double limit = radius * source.spacing;
    for (const int s : order) {
        const int home = target.nearest(pair.target.mesh, map.image[s]);
        if (home < 0) continue;
        const auto collides = [&](int index) {
            return std::any_of(cell[index].begin(), cell[index].end(), [&](int other) {
                if ((map.position[other] - map.position[s]).norm() >= limit) return false;
                return (source.position[other] - source.position[s]).norm() > 2.0 * source.spacing;
            });
        };
        bool hit = collides(home);
        for (const int e : target.base_edges_of[home]) hit = hit || collides(target.edges[e].other(home));
        if (hit) {
            map.drop(s);
        } else {
            cell[home].push_back(s);
        }
    }
}

Correspondence densify(const PartialMap& map, const Pair& pair, const SampleNotes& notes, const DenseOptions& options,
                       const Surface& source, const Surface& target, int threads, Monitor& monitor, double from,
                       double to) {
    const TriangleMesh& mesh = pair.source.mesh;
    std::vector<VertexImage> images(mesh.vertex_count());
    constexpr int block = 256;
    parallel_for(
        (mesh.vertex_count() + block - 1) / block, threads,
        [&](int b, int /*worker*/) {
            const int end = std::min(mesh.vertex_count(), (b + 1) * block);
            for (int v = b * block; v < end; ++v) images[v] = image_of(v, map, pair, notes, options);
        },
        monitor, "dense", from, to);
    Correspondence result;
    unmatch_all(result, source.vertices().rows());
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const int row = mesh.input_vertex[v];
        // A vertex that was split keeps its surer copy.
        if (images[v].point.face < 0 || images[v].confidence < result.confidence[row]) continue;
        if (images[v].region >= 0) write_row(result, row, images[v], pair.target.mesh, target);
    }
    return result;
}

}  // namespace isograft
