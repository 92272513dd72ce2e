// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/transfer.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/piece.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/pace.h"
#include "transfer/seams.h"

namespace isograft {

namespace {

int heaviest(const Eigen::RowVector3d& weights) {
    int corner = 0;
    weights.maxCoeff(&corner);
    return corner;
}

CornerValues read(const CornerPlacement& placement, const CornerValues& values, TransferMode mode) {
    CornerValues moved = CornerValues::Zero(placement.triangle.rows(), values.cols());
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        const Eigen::Index f = placement.triangle[i];
        if (f < 0) continue;
        if (mode == TransferMode::nearest) {
            moved.row(i) = values.row(3 * f + heaviest(placement.weights.row(i)));
        } else {
            moved.row(i) = placement.weights.row(i) * values.middleRows(3 * f, 3);
        }
    }
    return moved;
}

}  // namespace

void CornerTransferOptions::validate() const {
    const auto refuse = [](const char* field, double value) {
        throw InvalidInput(std::string(field) + " must be a finite number >= 0, got " + std::to_string(value));
    };
    if (!(tolerance >= 0.0 && std::isfinite(tolerance))) refuse("tolerance", tolerance);
    if (!(extrapolation >= 0.0 && std::isfinite(extrapolation))) refuse("extrapolation", extrapolation);
    if (threads < 0) throw InvalidInput("threads must be >= 0, got " + std::to_string(threads));
}

TransferredValues transfer_point(const Correspondence& correspondence, const Triangles& donor_faces,
                                 const CornerValues& values, TransferMode mode, Monitor* monitor) {
    check_faces(donor_faces, values.rows(), "donor_faces");
    check_correspondence(correspondence, donor_faces.rows());
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("points", 0.0);
    Piece whole(watched, 1.0);
    const Eigen::Index count = correspondence.face.rows();
    TransferredValues moved;
    moved.values = CornerValues::Constant(count, values.cols(), std::numeric_limits<double>::quiet_NaN());
    moved.mask = Mask::Constant(count, false);
    for (Eigen::Index v = 0; v < count; ++v) {
        if (v % rows_a_check == 0) whole.reach(static_cast<double>(v) / static_cast<double>(count));
        const int f = correspondence.face[v];
        const int vertex = correspondence.vertex[v];
        if (f < 0 && vertex < 0) continue;
        if (f < 0 && vertex >= values.rows()) {
            throw InvalidInput("the correspondence's `vertex` is out of range in row " + std::to_string(v) + ": " +
                               std::to_string(vertex) + ", the values have " + std::to_string(values.rows()) + " rows");
        }
        moved.mask[v] = true;
        if (f < 0) {
            moved.values.row(v) = values.row(vertex);
        } else if (mode == TransferMode::nearest) {
            moved.values.row(v) = values.row(donor_faces(f, heaviest(correspondence.barycentric.row(v))));
        } else {
            moved.values.row(v).setZero();
            for (int c = 0; c < 3; ++c) {
                const double weight = correspondence.barycentric(v, c);
                // A corner without weight may be a NaN.
                if (weight != 0.0) moved.values.row(v) += weight * values.row(donor_faces(f, c));
            }
        }
    }
    watched.report("points", 1.0);
    return moved;
}

Eigen::VectorXi uv_islands(const Triangles& faces, const CornerValues& values, double tolerance, const Points& vertices,
                           Monitor* monitor) {
    CornerTransferOptions options;
    options.tolerance = tolerance;
    options.validate();
    const Eigen::Index limit = vertices.rows() > 0 ? vertices.rows() : std::numeric_limits<int>::max();
    check_faces(faces, limit, "faces");
    check_finite(vertices, "vertices");
    check_corner_values(values, faces.rows(), "corner values");
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("islands", 0.0);
    const Triangles welded = weld(vertices, faces, &watched);
    watched.report("islands", 0.3);
    SeamGraph graph = build_seam_graph(welded, values, tolerance, &watched);
    watched.report("islands", 1.0);
    return std::move(graph.island);
}

TransferredUV transfer_corner_uv(const Correspondence& correspondence, const ReceiverMesh& receiver,
                                 const DonorMesh& donor, const CornerUV& donor_corner_uv,
                                 const CornerTransferOptions& options, Monitor* monitor) {
    const CornerValues values = donor_corner_uv;
    CornerPlacement placement = place_corners(correspondence, receiver, donor, values, options, monitor);
    TransferredUV moved;
    moved.uv = read(placement, values, TransferMode::barycentric);
    moved.island = std::move(placement.island);
    moved.mask = std::move(placement.mask);
    return moved;
}

TransferredValues transfer_corner(const Correspondence& correspondence, const ReceiverMesh& receiver,
                                  const DonorMesh& donor, const CornerValues& donor_corner_values, TransferMode mode,
                                  const CornerTransferOptions& options, Monitor* monitor) {
    CornerTransferOptions inside = options;
    inside.extrapolation = 0.0;
    CornerPlacement placement = place_corners(correspondence, receiver, donor, donor_corner_values, inside, monitor);
    TransferredValues moved{read(placement, donor_corner_values, mode), std::move(placement.mask)};
    for (Eigen::Index i = 0; i < moved.values.rows(); ++i) {
        const Eigen::Index f = placement.triangle[i];
        if (f < 0) continue;
        // Rounding may not lead out of the range either: a mean of equal values is that value.
        const auto corners = donor_corner_values.middleRows(3 * f, 3);
        const Eigen::RowVectorXd low = corners.colwise().minCoeff();
        const Eigen::RowVectorXd high = corners.colwise().maxCoeff();
        moved.values.row(i) = moved.values.row(i).cwiseMax(low).cwiseMin(high);
    }
    return moved;
}

}  // namespace isograft
