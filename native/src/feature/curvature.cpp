// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/curvature.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

namespace isograft {

namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Half the cotangent of the angle opposite to a half-edge, bounded so that a sliver does not spoil the whole row.
double half_cotangent(const TriangleMesh& mesh, int halfedge) {
    const int f = halfedge / 3;
    const auto& c = mesh.corner[f];
    const int k = halfedge % 3;
    const Complex a = c[k] - c[(k + 2) % 3];
    const Complex b = c[(k + 1) % 3] - c[(k + 2) % 3];
    const double area = std::abs(a.real() * b.imag() - a.imag() * b.real());
    const double inner = a.real() * b.real() + a.imag() * b.imag();
    constexpr double bound = 1e4;
    return 0.5 * std::clamp(inner / std::max(area, 1e-300), -bound, bound);
}

SparseMatrix stiffness(const TriangleMesh& mesh) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * static_cast<std::size_t>(mesh.face_count()));
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        const int i = mesh.from(h);
        const int j = mesh.to(h);
        const double w = half_cotangent(mesh, h);
        entries.emplace_back(i, i, w);
        entries.emplace_back(j, j, w);
        entries.emplace_back(i, j, -w);
        entries.emplace_back(j, i, -w);
    }
    SparseMatrix result(mesh.vertex_count(), mesh.vertex_count());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

}  // namespace

std::vector<double> mean_curvature(const TriangleMesh& mesh, double time) {
    const int n = mesh.vertex_count();
    const SparseMatrix laplacian = stiffness(mesh);
    Eigen::MatrixXd x(n, 3);
    for (int v = 0; v < n; ++v) x.row(v) = mesh.position[v].transpose();
    const Eigen::MatrixXd pull = laplacian * x;  // integrated 2 H n
    Eigen::MatrixXd sources(n, 2);
    for (int v = 0; v < n; ++v) {
        const bool inside = mesh.on_boundary[v] == 0;
        sources(v, 0) = inside ? 0.5 * pull.row(v).dot(mesh.vertex_normal[v].transpose()) : 0.0;
        sources(v, 1) = inside ? mesh.vertex_area[v] : 0.0;
    }
    // Three implicit steps are near enough to the heat kernel and stable for any step length.
    constexpr int steps = 3;
    SparseMatrix system = (time / steps) * laplacian;
    for (int v = 0; v < n; ++v) system.coeffRef(v, v) += mesh.vertex_area[v] + 1e-300;
    const Eigen::SimplicialLDLT<SparseMatrix> solver(system);
    Eigen::MatrixXd smooth = solver.solve(sources);
    for (int i = 1; i < steps; ++i) {
        for (int v = 0; v < n; ++v) smooth.row(v) *= mesh.vertex_area[v];
        smooth = solver.solve(smooth);
    }
    std::vector<double> result(n, 0.0);
    for (int v = 0; v < n; ++v) {
        const double h = smooth(v, 0) / std::max(smooth(v, 1), 1e-3);
        result[v] = std::isfinite(h) ? h : 0.0;
    }
    return result;
}

}  // namespace isograft
