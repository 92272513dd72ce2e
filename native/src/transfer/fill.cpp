// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/fill.h"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/piece.h"
#include "base/rotation.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/cholesky.h"
#include "transfer/laplacian.h"
#include "transfer/seams.h"
#include "transfer/thin_plate.h"
#include "transfer/vertex_graph.h"

namespace isograft {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr int vertices_a_check = 1024;
// Positions that move less than this share of the shape's size in a round have settled.
constexpr double settled = 1e-6;

void check(const Points& vertices, const Triangles& faces, const CornerValues& values, const Mask& known) {
    check_faces(faces, vertices.rows(), "faces");
    check_finite(vertices, "vertices");
    const auto same = [&](Eigen::Index rows, const char* name) {
        if (rows == vertices.rows()) return;
        throw InvalidInput(std::string("`") + name + "` has " + std::to_string(rows) + " rows, expected " +
                           std::to_string(vertices.rows()) + ", one per vertex");
    };
    same(values.rows(), "values");
    same(known.rows(), "known");
    for (Eigen::Index v = 0; v < known.rows(); ++v) {
        if (!known[v] || values.row(v).array().isFinite().all()) continue;
        throw InvalidInput("`values` holds NaN or infinity in row " + std::to_string(v) + ", which is known");
    }
}

// One fit of rotations to the edges around every vertex, and the right-hand side that they ask for.
class RigidEnergy {
  public:
    RigidEnergy(const Points& rest, const Triangles& faces) : rest_(rest), matrix_(laplacian(rest, faces)) {}

    [[nodiscard]] const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

    // Of the unknown vertices and their neighbours; the others are not asked for.
    [[nodiscard]] std::vector<Matrix3d> rotations(const CornerValues& placed, const Unknowns& unknowns,
                                                  Monitor& monitor) const {
        std::vector<Matrix3d> rotation(rest_.rows(), Matrix3d::Identity());
        std::vector<char> is_asked(rest_.rows(), 0);
        for (const int v : unknowns.vertex) {
            is_asked[v] = 1;
            each(v, [&](int other, double) { is_asked[other] = 1; });
        }
        for (int v = 0; v < rest_.rows(); ++v) {
            if (v % vertices_a_check == 0) monitor.check();
            if (is_asked[v] == 0) continue;
            Matrix3d product = Matrix3d::Zero();
            each(v, [&](int other, double weight) {
                product += weight * (rest_.row(v) - rest_.row(other)).transpose() * (placed.row(v) - placed.row(other));
            });
            rotation[v] = rotation_of(product);
        }
        return rotation;
    }

    [[nodiscard]] Vector3d wanted(int v, const std::vector<Matrix3d>& rotation) const {
        Vector3d sum = Vector3d::Zero();
        each(v, [&](int other, double weight) {
            sum += 0.5 * weight * (rotation[v] + rotation[other]) * (rest_.row(v) - rest_.row(other)).transpose();
        });
        return sum;
    }

  private:
    template <class Visit>
    void each(int v, const Visit& visit) const {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix_, v); it; ++it) {
            if (it.row() != v) visit(static_cast<int>(it.row()), -it.value());
        }
    }

    const Points& rest_;
    Eigen::SparseMatrix<double> matrix_;
};

}  // namespace

TransferredValues fill_smooth(const Points& vertices, const Triangles& faces, const CornerValues& values,
                              const Mask& known, Monitor* monitor) {
    check(vertices, faces, values, known);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("fill", 0.0);
    const Unknowns unknowns(faces, known);
    TransferredValues filled{values, unknowns.mask()};
    if (unknowns.count() > 0) {
        const CornerValues solved =
            thin_plate(vertices, faces, laplacian(vertices, faces), unknowns, values, large_hole, Piece(watched, 1.0));
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) filled.values.row(unknowns.vertex[i]) = solved.row(i);
    }
    watched.report("fill", 1.0);
    return filled;
}

Eigen::VectorXi nearest_known(const Points& vertices, const Triangles& faces, const Mask& known, Monitor* monitor) {
    check(vertices, faces, CornerValues(vertices.rows(), 0), known);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("fill", 0.0);
    std::vector<int> sources;
    for (int v = 0; v < known.rows(); ++v) {
        if (known[v]) sources.push_back(v);
    }
    const VertexGraph graph(vertices, faces);
    watched.report("fill", 0.1);
    Eigen::VectorXi source = graph.nearest(sources, watched, 0.9);
    watched.report("fill", 1.0);
    return source;
}

Eigen::VectorXi corner_groups(const Triangles& faces, const CornerValues& values, double tolerance,
                              const Points& vertices, Monitor* monitor) {
    check_faces(faces, vertices.rows() > 0 ? vertices.rows() : std::numeric_limits<int>::max(), "faces");
    check_finite(vertices, "vertices");
    check_corner_values(values, faces.rows(), "corner values");
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("groups", 0.0);
    const Triangles welded = weld(vertices, faces, &watched);
    watched.report("groups", 0.3);
    const SeamGraph graph = build_seam_graph(welded, values, tolerance, &watched);
    watched.report("groups", 0.9);
    Eigen::VectorXi group = group_corners(graph, welded, [](int, int) { return true; }, &watched);
    watched.report("groups", 1.0);
    return group;
}

void CompletionOptions::validate() const {
    if (iterations < 1) throw InvalidInput("iterations must be at least 1, got " + std::to_string(iterations));
}

TransferredValues complete_rigid(const Points& rest, const Triangles& faces, const Points& placed, const Mask& known,
                                 double scale, const CompletionOptions& options, Monitor* monitor) {
    options.validate();
    check(rest, faces, placed, known);
    if (!(scale > 0.0)) throw InvalidInput("scale must be positive, got " + std::to_string(scale));
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("complete", 0.0);
    const Points sized = scale * rest;
    const Unknowns unknowns(faces, known);
    TransferredValues result{placed, unknowns.mask()};
    if (unknowns.count() == 0) return result;

    const RigidEnergy energy(sized, faces);
    // A start that is smooth: displacements, so that a shape moved as a whole is met at once.
    const CornerValues moved =
        thin_plate(sized, faces, energy.matrix(), unknowns, placed - sized, large_hole, Piece(watched, 0.4));
    watched.report("complete", 0.4);
    for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
        const int v = unknowns.vertex[i];
        result.values.row(v) = sized.row(v) + moved.row(i);
    }

    const Cholesky factor = factorised(RowMatrix(unknowns.block(energy.matrix())), Piece(watched, 0.1));
    const Eigen::MatrixXd pull = energy.matrix() * unknowns.zeroed(result.values);
    const double size = (sized.colwise().maxCoeff() - sized.colwise().minCoeff()).norm();
    CornerValues right(unknowns.count(), 3);
    for (int round = 0; round < options.iterations; ++round) {
        watched.report("complete", 0.5 + 0.5 * round / options.iterations);
        const std::vector<Matrix3d> rotation = energy.rotations(result.values, unknowns, watched);
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
            const int v = unknowns.vertex[i];
            right.row(i) = energy.wanted(v, rotation).transpose() - pull.row(v);
        }
        const CornerValues solved = factor.solve(right, watched);
        double farthest = 0.0;
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
            const int v = unknowns.vertex[i];
            farthest = std::max(farthest, (solved.row(i) - result.values.row(v)).norm());
            result.values.row(v) = solved.row(i);
        }
        if (farthest <= settled * size) break;
    }
    watched.report("complete", 1.0);
    return result;
}

}  // namespace isograft
