// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/dissimilarity.h"

#include <algorithm>
#include <limits>

#include "base/parallel.h"
#include "geodesic/window.h"

namespace isograft {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Per map and source vertex the target vertex nearest to its image, -1 where unmapped.
std::vector<int> images_of(const PartialMap& map, const TriangleMesh& target) {
    std::vector<int> result(map.mapped.size(), -1);
    for (std::size_t s = 0; s < result.size(); ++s) {
        if (map.mapped[s]) result[s] = nearest_corner(target, map.image[s]);
    }
    return result;
}

// Per target vertex the source vertex whose image is nearest to it, -1 where no image has it as nearest corner.
std::vector<int> preimages_of(const PartialMap& map, const TriangleMesh& target, const std::vector<int>& image) {
    std::vector<int> result(target.vertex_count(), -1);
    std::vector<double> nearest(target.vertex_count(), infinity);
    for (std::size_t s = 0; s < image.size(); ++s) {
        const int t = image[s];
        if (t < 0) continue;
        const double d = (map.position[s] - target.position[t]).squaredNorm();
        if (d >= nearest[t]) continue;
        nearest[t] = d;
        result[t] = static_cast<int>(s);
    }
    return result;
}

}  // namespace

DistanceTable::DistanceTable(const TriangleMesh& mesh, double spacing, int threads, Monitor& monitor, double from,
                             double to)
    : mesh_(mesh), near_(spacing), centre_(mesh.vertex_count(), -1) {
    std::vector<int> centres;
    std::vector<double> offset(mesh.vertex_count(), infinity);
    Window window(mesh);
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        if (centre_[v] >= 0) continue;
        monitor.check();
        const int index = static_cast<int>(centres.size());
        centres.push_back(v);
        window.run(point_near_vertex(mesh, v), spacing);
        centre_[v] = index;
        offset[v] = 0.0;
        for (const int x : window.reached()) {
            const double d = window.distance(x);
            if (d >= spacing || d >= offset[x]) continue;
            centre_[x] = index;
            offset[x] = d;
        }
    }
    constexpr float unreached = std::numeric_limits<float>::infinity();
    table_ = Eigen::MatrixXf::Constant(static_cast<Eigen::Index>(centres.size()), mesh.vertex_count(), unreached);
    std::vector<Window> windows(worker_count(threads), Window(mesh));
    parallel_for(
        static_cast<int>(centres.size()), threads,
        [&](int i, int worker) {
            Window& full = windows[worker];
            full.run(point_near_vertex(mesh, centres[i]), infinity);
            for (const int x : full.reached()) table_(i, x) = static_cast<float>(full.distance(x));
        },
        monitor, "blend", from, to);
}

Eigen::MatrixXd map_dissimilarities(const VertexLevels& source, const DistanceTable& source_distance,
                                    const TriangleMesh& target, const DistanceTable& target_distance,
                                    const std::vector<PartialMap>& maps, int threads, Monitor& monitor, double from,
                                    double to) {
    const auto n = static_cast<int>(maps.size());
    std::vector<std::vector<int>> image, preimage;
    for (const PartialMap& map : maps) {
        image.push_back(images_of(map, target));
        preimage.push_back(preimages_of(map, target, image.back()));
    }
    const int vertices = source.samples.count();
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(n, n);
    const auto compare = [&](int i, int j) {
        double forward = 0.0, backward = 0.0;
        int shared = 0, covered = 0;
        for (int s = 0; s < vertices; ++s) {
            if (image[i][s] < 0 || image[j][s] < 0) continue;
            ++shared;
            // Where both are in one cell of the table, the images themselves and not their corners.
            const double straight = (maps[i].position[s] - maps[j].position[s]).norm();
            forward += std::max(straight, image[i][s] == image[j][s] ? 0.0 : target_distance(image[i][s], image[j][s]));
        }
        for (int t = 0; t < target.vertex_count(); ++t) {
            const int a = preimage[i][t], b = preimage[j][t];
            // Both preimages have to lie in both domains: y is in f_i(U_ij) and in f_j(U_ij).
            if (a < 0 || b < 0 || image[j][a] < 0 || image[i][b] < 0) continue;
            ++covered;
            backward += a == b ? 0.0 : source_distance(a, b);
        }
        return shared > 0 && covered > 0 ? forward / shared + backward / covered : infinity;
    };
    parallel_for(
        n, threads,
        [&](int i, int /*worker*/) {
            for (int j = i + 1; j < n; ++j) {
                monitor.check();
                result(i, j) = compare(i, j);
            }
        },
        monitor, "blend", from, to);
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < i; ++j) result(i, j) = result(j, i);
    }
    return result;
}

}  // namespace isograft
