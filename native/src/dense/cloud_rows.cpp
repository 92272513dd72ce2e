// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/cloud_rows.h"

#include <algorithm>
#include <array>

#include "hierarchy/closest.h"

namespace isograft {

namespace {

// Points looked at for three that are on the image's sheet.
constexpr int looked_at = 12;

// Points that are part of the surface.
std::vector<int> used_points(const Surface& cloud) {
    std::vector<int> used;
    for (int v = 0; v < static_cast<int>(cloud.cloud_vertex().size()); ++v) {
        if (cloud.cloud_vertex()[v] >= 0) used.push_back(v);
    }
    return used;
}

std::vector<Eigen::Vector3d> positions_of(const Surface& cloud, const std::vector<int>& rows) {
    std::vector<Eigen::Vector3d> positions;
    positions.reserve(rows.size());
    for (const int v : rows) positions.emplace_back(cloud.vertices().row(v));
    return positions;
}

}  // namespace

std::vector<SurfacePoint> cloud_places(const Surface& cloud, Monitor& monitor) {
    const std::vector<int>& vertex = cloud.cloud_vertex();
    std::vector<SurfacePoint> places(vertex.size());
    for (std::size_t i = 0; i < vertex.size(); ++i) {
        if (i % 1024 == 0) monitor.check();
        if (vertex[i] < 0) continue;
        places[i] = closest_from(cloud.mesh(), vertex[i], cloud.vertices().row(static_cast<Eigen::Index>(i)));
    }
    return places;
}

CloudRows::CloudRows(const Surface& cloud)
    : cloud_(&cloud), input_(used_points(cloud)), tree_(positions_of(cloud, input_)) {}

void CloudRows::write(Correspondence& c, Eigen::Index row, const SurfacePoint& point) const {
    const TriangleMesh& mesh = cloud_->mesh();
    const Eigen::Vector3d x = position(mesh, point);
    const Eigen::RowVector3d side = mesh.normal[point.face].transpose();
    std::vector<KdTree::Found> found;
    tree_.nearest(x, looked_at, found);
    std::array<KdTree::Found, 3> chosen{};
    std::size_t count = 0;
    for (const bool alike : {true, false}) {
        for (const KdTree::Found& f : found) {
            if (count == chosen.size()) break;
            if ((cloud_->normals().row(input_[f.index]).dot(side) > 0.0) == alike) chosen[count++] = f;
        }
    }
    // Inverse squares of distances give a point's own value at the point itself.
    const double least = 1e-12 * mesh.mean_edge * mesh.mean_edge;
    double total = 0.0;
    for (std::size_t k = 0; k < chosen.size(); ++k) total += 1.0 / (chosen[k].squared_distance + least);
    for (int k = 0; k < 3; ++k) {
        c.corners(row, k) = input_[chosen[k].index];
        c.barycentric(row, k) = 1.0 / (chosen[k].squared_distance + least) / total;
    }
    c.points.row(row) = x.transpose();
    c.vertex[row] = c.corners(row, 0);
}

}  // namespace isograft
