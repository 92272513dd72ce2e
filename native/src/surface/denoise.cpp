// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/denoise.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "isograft/errors.h"
#include "surface/kd_tree.h"
#include "surface/rimls.h"

namespace isograft {

void SurfaceOptions::validate() const {
    if (!(denoise == 0.0 || (denoise >= 1.0 && denoise <= 10.0))) {
        throw InvalidInput("surface.denoise must be 0 or in [1, 10]");
    }
    if (!(close_holes >= 0.0 && close_holes <= 2.0)) throw InvalidInput("surface.close_holes must be in [0, 2]");
}

namespace {

// Height over longest edge, and the cosine between a triangle and the surface at its corners, at least.
constexpr double least_height = 0.02;
constexpr double least_facing = 0.2;

std::vector<double> edge_lengths(const TriangleMesh& mesh) {
    std::vector<double> sum(mesh.vertex_count(), 0.0), count(mesh.vertex_count(), 0.0);
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        const double length = std::abs(mesh.edge(h));
        for (const int v : {mesh.from(h), mesh.to(h)}) {
            sum[v] += length;
            count[v] += 1.0;
        }
    }
    for (std::size_t v = 0; v < sum.size(); ++v) sum[v] /= count[v];
    return sum;
}

// Put back the corners of triangles that turn over or lose their area at the new places, until there are none. Noisy
// triangles tell no side of their own: the smoothed normals do.
void keep_triangles(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& normal,
                    std::vector<Eigen::Vector3d>& place) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int f = 0; f < mesh.face_count(); ++f) {
            const auto& [a, b, c] = mesh.face[f];
            const Eigen::Vector3d after = (place[b] - place[a]).cross(place[c] - place[a]);
            const Eigen::Vector3d side = normal[a] + normal[b] + normal[c];
            const double longest = std::max({(place[b] - place[a]).squaredNorm(), (place[c] - place[b]).squaredNorm(),
                                             (place[a] - place[c]).squaredNorm()});
            const double size = after.norm();
            if (size >= least_height * longest && after.dot(side) >= least_facing * size * side.norm()) continue;
            for (const int v : {a, b, c}) {
                changed = changed || place[v] != mesh.position[v];
                place[v] = mesh.position[v];
            }
        }
    }
}

}  // namespace

TriangleMesh denoised(const TriangleMesh& mesh, double support, Monitor& monitor) {
    const KdTree tree(mesh.position);
    const std::vector<double> spacing = edge_lengths(mesh);
    RimlsOptions options;
    options.support = support;
    std::vector<Eigen::Vector3d> normal = mesh.vertex_normal;
    std::vector<Eigen::Vector3d> place = mesh.position;
    // The first round is for its normals: those of single triangles are noisier than their corners.
    for (int round = 0; round < 2; ++round) {
        const Rimls surface(tree, normal, spacing, options);
        std::vector<Eigen::Vector3d> smoothed = normal;
        for (int v = 0; v < mesh.vertex_count(); ++v) {
            if (v % 256 == 0) monitor.check();
            const Rimls::Projection p = surface.project(mesh.position[v], normal[v]);
            const bool fits = p.converged && (p.position - mesh.position[v]).norm() < spacing[v];
            place[v] = fits ? p.position : mesh.position[v];
            if (fits) smoothed[v] = p.normal;
        }
        normal = std::move(smoothed);
    }
    keep_triangles(mesh, normal, place);
    return with_positions(mesh, std::move(place), monitor);
}

}  // namespace isograft
