// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/own_frame.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "base/complex.h"
#include "base/filling.h"
#include "isograft/monitor.h"

namespace isograft {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double single_precision = 0x1.0p-23;
// Of a triangle's height that its corners may be rounded to.
constexpr double most_grain = 1e-2;

struct Frame {
    Vector3d centre = Vector3d::Zero();
    /// The axes, one a row.
    Matrix3d turn = Matrix3d::Identity();
    /// Of the mesh, from the centre.
    double radius = 0.0;
};

Frame frame_of(const TriangleMesh& mesh, Monitor& monitor) {
    Frame frame;
    double weight = 0.0;
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        frame.centre += mesh.vertex_area[v] * mesh.position[v];
        weight += mesh.vertex_area[v];
    }
    monitor.check();
    frame.centre /= weight;
    Matrix3d spread = Matrix3d::Zero();
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const Vector3d x = mesh.position[v] - frame.centre;
        spread += mesh.vertex_area[v] * x * x.transpose();
        frame.radius = std::max(frame.radius, x.norm());
    }
    monitor.check();
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(spread / weight);
    frame.turn = solver.eigenvectors().transpose();
    Vector3d skew = Vector3d::Zero();
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const Vector3d x = frame.turn * (mesh.position[v] - frame.centre);
        skew += mesh.vertex_area[v] * x.cwiseAbs2().cwiseProduct(x);
    }
    // Bodies are alike on both sides of one plane, and a sheet has hardly any sides: the sign of the axis that says
    // least of its own is told by the other two.
    const Vector3d width = solver.eigenvalues().cwiseMax(1e-8 * solver.eigenvalues()[2]).cwiseSqrt();
    int least = 0;
    skew.cwiseQuotient(width.cwiseProduct(width).cwiseProduct(width)).cwiseAbs().minCoeff(&least);
    for (int k = 0; k < 3; ++k) {
        if (skew[k] < 0.0) frame.turn.row(k) *= -1.0;
    }
    if (frame.turn.determinant() < 0.0) frame.turn.row(least) *= -1.0;
    return frame;
}

double power_of_two_below(double x) { return std::exp2(std::floor(std::log2(x))); }

// What each vertex is rounded to: a power of two, so that quotients by it are exact. Thin triangles bear less.
std::vector<double> grains(const TriangleMesh& mesh, double radius, Monitor& monitor) {
    std::vector<double> grain(mesh.vertex_count(), power_of_two_below(radius) * single_precision);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (f % often == 0) monitor.check();
        const double longest =
            std::max({std::abs(mesh.edge(3 * f)), std::abs(mesh.edge(3 * f + 1)), std::abs(mesh.edge(3 * f + 2))});
        const double height = cross(mesh.corner[f][1], mesh.corner[f][2]) / longest;
        for (const int v : mesh.face[f]) {
            if (grain[v] > most_grain * height) grain[v] = power_of_two_below(most_grain * height);
        }
    }
    return grain;
}

}  // namespace

TriangleMesh in_own_frame(const TriangleMesh& mesh, Monitor& monitor) {
    monitor.check();
    const Frame frame = frame_of(mesh, monitor);
    monitor.check();
    const std::vector<double> grain = grains(mesh, frame.radius, monitor);
    std::vector<Vector3d> place(mesh.vertex_count());
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        if (v % often == 0) monitor.check();
        place[v] = frame.turn * (mesh.position[v] - frame.centre);
        for (double& x : place[v]) x = grain[v] * std::round(x / grain[v]);
    }
    return in_order_of_place(mesh, place, monitor);
}

}  // namespace isograft
