// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/locate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/projection.h"

namespace isograft {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double weight_tolerance = 1e-6;
constexpr int points_a_task = 1024;

void check_points(const SurfacePoints& points, Eigen::Index face_count) {
    if (points.weights.rows() != points.face.rows()) {
        throw InvalidInput("`weights` has " + std::to_string(points.weights.rows()) + " rows, expected " +
                           std::to_string(points.face.rows()) + ", one per row of `face`");
    }
    for (Eigen::Index i = 0; i < points.face.rows(); ++i) {
        if (points.face[i] < -1 || points.face[i] >= face_count) {
            throw InvalidInput("the points' `face` is out of range in row " + std::to_string(i) + ": " +
                               std::to_string(points.face[i]) + ", the receiver has " + std::to_string(face_count) +
                               " triangles");
        }
        const auto row = points.weights.row(i);
        if (points.face[i] < 0 ||
            (std::abs(row.sum() - 1.0) <= weight_tolerance && row.minCoeff() >= -weight_tolerance)) {
            continue;
        }
        throw InvalidInput("the points' `weights` are not >= 0 with sum 1 in row " + std::to_string(i));
    }
}

}  // namespace

SurfacePoints locate(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                     const SurfacePoints& points, int threads, Monitor* monitor) {
    const Eigen::VectorXi no_polygons;
    const ReceiverMesh alone{receiver.vertices, receiver.faces, no_polygons};
    const CornerValues no_values = no_corner_values(donor.faces);
    check_placement(correspondence, alone, donor, no_values);
    check_points(points, receiver.faces.rows());
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();
    const DonorView view(donor, no_values, 0.0);
    const ReceiverImages images(correspondence, alone, view);
    const Points normals = image_normals(images);

    const auto count = static_cast<int>(points.face.rows());
    SurfacePoints found{Eigen::VectorXi::Constant(count, -1), Points::Zero(count, 3)};
    std::vector<std::unique_ptr<Projection>> projections(worker_count(threads));
    const auto task = [&](int index, int worker) {
        if (!projections[worker]) projections[worker] = std::make_unique<Projection>(view, images, normals);
        const int end = std::min(count, (index + 1) * points_a_task);
        for (int i = index * points_a_task; i < end; ++i) {
            const int f = points.face[i];
            if (f < 0 || images.extent[f] == infinity) continue;
            projections[worker]->enter(f);
            Eigen::Vector3d weights = points.weights.row(i).transpose().cwiseMax(0.0);
            weights /= weights.sum();
            const Place place = projections[worker]->find(weights);
            found.face[i] = place.face;
            found.weights.row(i) = place.weights.transpose();
        }
    };
    parallel_for((count + points_a_task - 1) / points_a_task, threads, task, watched, "locate", 0.0, 1.0);
    return found;
}

}  // namespace isograft
