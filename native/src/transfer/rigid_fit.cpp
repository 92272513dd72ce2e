// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/rigid_fit.h"

#include <algorithm>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/piece.h"
#include "base/rotation.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/membrane.h"
#include "transfer/pace.h"
#include "transfer/thin_plate.h"

namespace isograft {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// Positions that move less than this share of the shape's size in a round have settled.
constexpr double settled = 1e-6;

// One fit of rotations to the edges around every vertex, and the right-hand side that they ask for.
class RigidEnergy {
  public:
    RigidEnergy(const Points& rest, const Triangles& faces) : rest_(rest), matrix_(positive_laplacian(rest, faces)) {}

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
            if (v % rows_a_check == 0) monitor.check();
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

void CompletionOptions::validate() const {
    if (iterations < 1) throw InvalidInput("iterations must be at least 1, got " + std::to_string(iterations));
}

TransferredValues fit_rigid(const Points& rest, const Triangles& faces, const Points& placed, const Unknowns& unknowns,
                            const CompletionOptions& options, Eigen::Index large, Monitor& monitor, double most_bending,
                            double most_stretching) {
    TransferredValues result{placed, unknowns.mask()};
    if (unknowns.count() == 0) return result;

    const RigidEnergy energy(rest, faces);
    // A start that is smooth: displacements, so that a shape moved as a whole is met at once.
    const CornerValues moved = thin_plate(rest, faces, laplacian(rest, faces), unknowns, placed - rest, large,
                                          Piece(monitor, 0.4), most_bending);
    monitor.report("complete", 0.4);
    CornerValues solved(unknowns.count(), 3);
    const auto put = [&] {
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) result.values.row(unknowns.vertex[i]) = solved.row(i);
    };
    for (Eigen::Index i = 0; i < unknowns.count(); ++i) solved.row(i) = rest.row(unknowns.vertex[i]) + moved.row(i);
    put();

    const Membrane membrane(rest, faces, energy.matrix(), unknowns, large, Piece(monitor, 0.1), most_stretching);
    const Eigen::MatrixXd pull = energy.matrix() * unknowns.zeroed(result.values);
    const double size = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
    CornerValues right(unknowns.count(), 3);
    for (int round = 0; round < options.iterations; ++round) {
        monitor.report("complete", 0.5 + 0.5 * round / options.iterations);
        const std::vector<Matrix3d> rotation = energy.rotations(result.values, unknowns, monitor);
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) {
            const int v = unknowns.vertex[i];
            right.row(i) = energy.wanted(v, rotation).transpose() - pull.row(v);
        }
        const CornerValues before = solved;
        solved = membrane.solve(right, before, monitor);
        put();
        if ((solved - before).rowwise().norm().maxCoeff() <= settled * size) break;
    }
    return result;
}

TransferredValues complete_rigid(const Points& rest, const Triangles& faces, const Points& placed, const Mask& known,
                                 double scale, const CompletionOptions& options, Monitor* monitor) {
    options.validate();
    check_values_known(rest, faces, placed, known);
    if (!(scale > 0.0)) throw InvalidInput("scale must be positive, got " + std::to_string(scale));
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("complete", 0.0);
    TransferredValues result =
        fit_rigid(scale * rest, faces, placed, Unknowns(faces, known), options, large_hole, watched);
    watched.report("complete", 1.0);
    return result;
}

}  // namespace isograft
