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

// A fine mesh of this many vertices for one of the coarse one leaves the heat flow to the latter.
constexpr int many = 3;
// Steps between two looks at the monitor.
constexpr int often = 1 << 18;

// Curvature integrated over every vertex's cell, and the cell's area; nothing on the boundary.
Eigen::MatrixXd integrated_curvature(const TriangleMesh& mesh, Monitor& monitor) {
    const int n = mesh.vertex_count();
    std::vector<Eigen::Vector3d> pull(n, Eigen::Vector3d::Zero());  // 2 H n
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        if (h % often == 0) monitor.check();
        const int i = mesh.from(h);
        const int j = mesh.to(h);
        const Eigen::Vector3d d = half_cotangent(mesh, h) * (mesh.position[i] - mesh.position[j]);
        pull[i] += d;
        pull[j] -= d;
    }
    Eigen::MatrixXd result(n, 2);
    for (int v = 0; v < n; ++v) {
        const bool inside = mesh.on_boundary[v] == 0;
        result(v, 0) = inside ? 0.5 * pull[v].dot(mesh.vertex_normal[v]) : 0.0;
        result(v, 1) = inside ? mesh.vertex_area[v] : 0.0;
    }
    return result;
}

// Every fine vertex's share goes to the corners of the coarse triangle it lies in.
Eigen::MatrixXd gathered(const Eigen::MatrixXd& fine, const CoarseMesh& coarse) {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(coarse.mesh.vertex_count(), fine.cols());
    for (Eigen::Index v = 0; v < fine.rows(); ++v) {
        const SurfacePoint& place = coarse.place[static_cast<std::size_t>(v)];
        if (place.face < 0) continue;
        for (int k = 0; k < 3; ++k) result.row(coarse.mesh.face[place.face][k]) += place.weight[k] * fine.row(v);
    }
    return result;
}

/// Heat flow over a mesh: one symbolic factorisation for all times.
class HeatFlow {
  public:
    HeatFlow(const TriangleMesh& mesh, Monitor& monitor) : mesh_(mesh), monitor_(monitor), laplacian_(stiffness(mesh)) {
        monitor_.check();
        solver_.analyzePattern(laplacian_);
    }

    std::vector<double> spread(const Eigen::MatrixXd& sources, double time) {
        const int n = mesh_.vertex_count();
        // Three implicit steps are near enough to the heat kernel and stable for any step length.
        constexpr int steps = 3;
        SparseMatrix system = (time / steps) * laplacian_;
        for (int v = 0; v < n; ++v) system.coeffRef(v, v) += mesh_.vertex_area[v] + 1e-300;
        monitor_.check();
        solver_.factorize(system);
        monitor_.check();
        Eigen::MatrixXd smooth = solver_.solve(sources);
        for (int i = 1; i < steps; ++i) {
            for (int v = 0; v < n; ++v) smooth.row(v) *= mesh_.vertex_area[v];
            monitor_.check();
            smooth = solver_.solve(smooth);
        }
        std::vector<double> result(n, 0.0);
        for (int v = 0; v < n; ++v) {
            const double h = smooth(v, 0) / std::max(smooth(v, 1), 1e-3);
            result[v] = std::isfinite(h) ? h : 0.0;
        }
        return result;
    }

  private:
    const TriangleMesh& mesh_;
    Monitor& monitor_;
    SparseMatrix laplacian_;
    Eigen::SimplicialLDLT<SparseMatrix> solver_;
};

}  // namespace

std::vector<double> mean_curvature(const TriangleMesh& mesh, double time, Monitor& monitor) {
    return HeatFlow(mesh, monitor).spread(integrated_curvature(mesh, monitor), time);
}

std::vector<double> mean_curvature(const TriangleMesh& mesh, double time) {
    Monitor silent;
    return mean_curvature(mesh, time, silent);
}

std::vector<std::vector<double>> coarse_curvatures(const TriangleMesh& fine, const CoarseMesh& coarse,
                                                   const std::vector<double>& times, Monitor& monitor) {
    std::vector<std::vector<double>> result;
    const Eigen::MatrixXd sources = integrated_curvature(fine, monitor);
    if (!coarse.fine_vertex.empty() && fine.vertex_count() >= many * coarse.mesh.vertex_count()) {
        HeatFlow flow(coarse.mesh, monitor);
        const Eigen::MatrixXd gathered_sources = gathered(sources, coarse);
        for (const double time : times) result.push_back(flow.spread(gathered_sources, time));
    } else {
        HeatFlow flow(fine, monitor);
        for (const double time : times) result.push_back(at_coarse(coarse, flow.spread(sources, time)));
    }
    return result;
}

}  // namespace isograft
