// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud_input.h"

#include <Eigen/Eigenvalues>

#include "isograft/errors.h"
#include "surface/clean.h"
#include "surface/edges.h"

namespace isograft {

namespace {

// Extent across over extent along, below which all points are on a line.
constexpr double thin = 1e-6;

std::string rows_of(Eigen::Index count) { return std::to_string(count) + (count == 1 ? " row" : " rows"); }

void check_normals(const Points& vertices, const Points& normals) {
    if (normals.rows() == 0) return;
    if (normals.rows() != vertices.rows()) {
        throw InvalidInput("`normals` has " + rows_of(normals.rows()) + ", `vertices` has " + rows_of(vertices.rows()) +
                           "; give one normal for every point, or none at all");
    }
    const auto refuse = [&](auto&& is_bad, const std::string& what, const std::string& remedy) {
        Eigen::Index first = -1, bad = 0;
        for (Eigen::Index v = normals.rows(); v-- > 0;) {
            if (!is_bad(normals.row(v))) continue;
            first = v;
            ++bad;
        }
        if (bad > 0) {
            throw InvalidInput("`normals` " + what + " in " + rows_of(bad) + ", the first is row " +
                               std::to_string(first) + "; " + remedy);
        }
    };
    const std::string remedy = "correct these rows, or pass no normals to have them estimated";
    refuse([](const auto& n) { return !n.array().isFinite().all(); }, "holds NaN or infinity", remedy);
    refuse([](const auto& n) { return !(n.stableNorm() > 1e-150); }, "has no length", remedy);
}

}  // namespace

CloudInput check_cloud(const Points& vertices, const Points& normals, Monitor& monitor) {
    if (vertices.rows() < fewest_points) {
        throw InvalidInput("a point cloud of " + rows_of(vertices.rows()) + " is too small: at least " +
                           std::to_string(fewest_points) + " points make a surface; pass more points, or triangles");
    }
    check_size(vertices.rows(), 1);
    check_coordinates(vertices);
    check_normals(vertices, normals);
    std::vector<Eigen::Vector3d> all(vertices.rows());
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) all[v] = vertices.row(v);
    const std::vector<int> place = find_places(all, monitor);
    CloudInput cloud;
    int repeated = 0, first = -1;
    for (int v = 0; v < static_cast<int>(all.size()); ++v) {
        if (place[v] != v) {
            ++repeated;
            if (first < 0) first = v;
            continue;
        }
        cloud.position.push_back(all[v]);
        if (normals.rows() > 0) cloud.normal.emplace_back(normals.row(v).stableNormalized());
    }
    if (repeated > 0) {
        throw InvalidInput("`vertices` repeats points: " + rows_of(repeated) + " of " + std::to_string(all.size()) +
                           " equal an earlier one, the first is row " + std::to_string(first) + ", equal to row " +
                           std::to_string(place[first]) + "; keep one of each, as numpy.unique(vertices, axis=0) does");
    }
    // About the mean of points brought into the unit box, so that no square leaves the range of double.
    const Eigen::RowVector3d low = vertices.colwise().minCoeff();
    const double extent = (vertices.colwise().maxCoeff() - low).maxCoeff();
    const Points unit = (vertices.rowwise() - low) / extent;
    const Points centred = unit.rowwise() - unit.colwise().mean();
    const Eigen::Matrix3d covariance = centred.transpose() * centred;
    const Eigen::Vector3d spread = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues();
    if (spread[1] <= thin * thin * spread[2]) {
        throw InvalidInput("the " + std::to_string(all.size()) +
                           " points lie on a line and make no surface; check the coordinates");
    }
    return cloud;
}

}  // namespace isograft
