// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/regions.h"

#include <algorithm>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "transfer/vertex_graph.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

// Share of the mean area that a piece has at least.
constexpr double least_area = 1e-6;

// Of the border between the cells of two vertices, the part that lies in a triangle, over the length of their edge:
// from the edge's middle to the circumcentre, negative if that is outside.
double border(const Vector3d& corner, const Vector3d& a, const Vector3d& b) {
    const Vector3d u = a - corner, v = b - corner;
    const double sine = u.cross(v).norm();
    return sine > 0.0 ? 0.5 * u.dot(v) / sine : 0.0;
}

}  // namespace

Regions::Regions(const Points& vertices, const Triangles& faces, double radius, Monitor& monitor) {
    const VertexGraph graph(vertices, faces);
    const std::vector<int> seeds = graph.spread_out(radius, monitor);
    const Eigen::VectorXi nearest = graph.nearest(seeds, monitor, 0.0);
    const auto count = static_cast<Eigen::Index>(seeds.size());
    of.resize(vertices.rows());
    centre.setZero(count, 3);
    Eigen::VectorXd members = Eigen::VectorXd::Zero(count);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        const auto seed = std::lower_bound(seeds.begin(), seeds.end(), nearest[v]);
        of[v] = nearest[v] < 0 ? -1 : static_cast<int>(seed - seeds.begin());
        if (of[v] < 0) continue;
        centre.row(of[v]) += vertices.row(v);
        members[of[v]] += 1.0;
    }
    centre.array().colwise() /= members.array();

    area.setZero(count);
    std::map<std::pair<int, int>, Vector3d> borders;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        Vector3d x[3];
        for (int c = 0; c < 3; ++c) x[c] = vertices.row(faces(f, c)).transpose();
        const double third = (x[1] - x[0]).cross(x[2] - x[0]).norm() / 6.0;
        for (int c = 0; c < 3; ++c) {
            const int a = (c + 1) % 3, b = (c + 2) % 3;
            const int i = of[faces(f, a)], j = of[faces(f, b)];
            area[of[faces(f, c)]] += third;
            if (i == j) continue;
            Vector3d& sum = borders.try_emplace(std::minmax(i, j), Vector3d::Zero()).first->second;
            sum += border(x[c], x[a], x[b]) * (i < j ? x[b] - x[a] : x[a] - x[b]);
        }
    }
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& [pair, across] : borders) {
        const auto [i, j] = pair;
        const Vector3d apart = (centre.row(j) - centre.row(i)).transpose();
        const double weight = across.dot(apart) / apart.squaredNorm();
        if (!(weight > 0.0)) continue;
        entries.emplace_back(i, j, -weight);
        entries.emplace_back(j, i, -weight);
        entries.emplace_back(i, i, weight);
        entries.emplace_back(j, j, weight);
    }
    if (count > 0) area = area.cwiseMax(least_area * area.mean());
    stiffness.resize(count, count);
    stiffness.setFromTriplets(entries.begin(), entries.end());
}

}  // namespace isograft
