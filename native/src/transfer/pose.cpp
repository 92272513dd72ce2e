// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/pose.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "base/rotation.h"
#include "transfer/laplacian.h"
#include "transfer/regions.h"

namespace isograft {

using Eigen::Matrix3d;

namespace {

// Lengths in roots of the surface's area.
constexpr double region_radius = 0.03;
constexpr double narrowest = 0.08;
constexpr int widths = 5;       // each twice the one before
constexpr int frame_width = 2;  // of these
// Share of a region's neighbours in the sums at its vertices ends at this distance from their centres.
constexpr double blend = 2.5 * region_radius;

// Turning from the middle width on over that before: up to 0.60 between faces, from 0.73 on between poses.
constexpr double most_turning = 0.66;
// Radians; no two shapes in one pose turn more than this from the middle width on: the faces 0.11.
constexpr double most_far = 0.14;
// Radians; a fold of the skin turns by any angle.
constexpr double most_angle = 0.5;
// Radians; as much as that is not seen in what a key does.
constexpr double unseen = 0.01;

// What is summed, as columns: the product, then the receiver's and the donor's squares.
using Sums = Eigen::Matrix<double, Eigen::Dynamic, 11>;

void put(Sums& sums, Eigen::Index row, const Moments& moments, double weight) {
    for (int k = 0; k < 9; ++k) sums(row, k) += weight * moments.product(k);
    sums(row, 9) += weight * moments.receiver;
    sums(row, 10) += weight * moments.donor;
}

Moments get(const Sums& sums, Eigen::Index row) {
    Moments moments;
    for (int k = 0; k < 9; ++k) moments.product(k) = sums(row, k);
    moments.receiver = sums(row, 9);
    moments.donor = sums(row, 10);
    return moments;
}

// Every vertex counts as its area, not as the lengths of its edges.
Sums by_region(const Regions& regions, const Points& vertices, const Triangles& faces,
               const std::vector<Moments>& moments) {
    const Eigen::VectorXd areas = vertex_areas(vertices, faces);
    Sums sums = Sums::Zero(regions.count(), 11);
    for (std::size_t v = 0; v < moments.size(); ++v) {
        const int region = regions.of[static_cast<Eigen::Index>(v)];
        if (region < 0 || !moments[v].usable()) continue;
        put(sums, region, moments[v],
            areas[static_cast<Eigen::Index>(v)] / std::sqrt(moments[v].receiver * moments[v].donor));
    }
    return sums;
}

class Diffusion {
  public:
    Diffusion(const Regions& regions, const Sums& sums) : regions_(regions), sums_(sums) {}

    // By unit of area.
    [[nodiscard]] std::optional<Sums> over(double width) const {
        Eigen::SparseMatrix<double> matrix = 0.25 * width * width * regions_.stiffness;
        matrix += Eigen::SparseMatrix<double>(regions_.area.asDiagonal());
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
        if (solver.info() != Eigen::Success) return std::nullopt;
        return Sums(solver.solve(sums_));
    }

    // Root mean square of the angle between the rotations of two widths.
    [[nodiscard]] double turning(const Sums& narrow, const Sums& wide) const {
        double turned = 0.0, area = 0.0;
        for (int r = 0; r < regions_.count(); ++r) {
            const Moments a = get(narrow, r), b = get(wide, r);
            if (!a.usable() || !b.usable()) continue;
            const Matrix3d change = rotation_of(a.product).transpose() * rotation_of(b.product);
            turned += regions_.area[r] * std::pow(std::min(Eigen::AngleAxisd(change).angle(), most_angle), 2);
            area += regions_.area[r];
        }
        return area > 0.0 ? std::sqrt(turned / area) : 0.0;
    }

  private:
    const Regions& regions_;
    const Sums& sums_;
};

// From pieces to vertices, without steps at their borders.
std::vector<Moments> at_vertices(const Regions& regions, const Sums& sums, const Points& vertices, double reach) {
    std::vector<Moments> result(vertices.rows());
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
        const int own = regions.of[v];
        if (own < 0) continue;
        double total = 0.0;
        for (Eigen::SparseMatrix<double>::InnerIterator it(regions.stiffness, own); it; ++it) {
            const double away = (vertices.row(v) - regions.centre.row(it.row())).norm() / reach;
            const double weight = std::pow(std::max(0.0, 1.0 - away), 2);
            result[v].add(get(sums, it.row()), weight);
            total += weight;
        }
        if (!(total > 0.0)) result[v] = get(sums, own);
    }
    return result;
}

}  // namespace

std::optional<std::vector<Moments>> fit_in_one_pose(const Points& vertices, const Triangles& faces,
                                                    const std::vector<Moments>& moments, Monitor& monitor) {
    double area = 0.0;
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)),
                              c = vertices.row(faces(f, 2));
        area += 0.5 * (b - a).cross(c - a).norm();
    }
    if (!(area > 0.0)) return std::nullopt;
    const double unit = std::sqrt(area);
    const Regions regions(vertices, faces, region_radius * unit, monitor);
    const Sums sums = by_region(regions, vertices, faces, moments);
    const Diffusion diffusion(regions, sums);
    std::optional<Sums> before, chosen;
    double near = 0.0, far = 0.0;
    double width = narrowest * unit;
    for (int i = 0; i < widths; ++i, width *= 2.0) {
        monitor.check();
        std::optional<Sums> here = diffusion.over(width);
        if (!here) return std::nullopt;
        if (before) (i <= frame_width ? near : far) += diffusion.turning(*before, *here);
        if (i == frame_width) chosen = here;
        before = std::move(here);
    }
    if (far > most_far || (far > unseen && far > most_turning * near)) return std::nullopt;
    return at_vertices(regions, *chosen, vertices, blend * unit);
}

}  // namespace isograft
