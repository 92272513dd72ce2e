// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/fingerprint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "geodesic/window.h"

namespace isograft {

namespace {

// Length inside a triangle of the line on which a linear function with the values `d` at the corners is r.
double contour_in(const std::array<Complex, 3>& corner, const std::array<double, 3>& d, double r) {
    Complex end[2];
    int found = 0;
    for (int k = 0; k < 3 && found < 2; ++k) {
        const int next = (k + 1) % 3;
        if ((d[k] < r) == (d[next] < r)) continue;
        const double share = (r - d[k]) / (d[next] - d[k]);
        end[found++] = corner[k] + share * (corner[next] - corner[k]);
    }
    return found == 2 ? std::abs(end[1] - end[0]) : 0.0;
}

class Tracer {
  public:
    Tracer(const TriangleMesh& mesh, const std::vector<double>& radii)
        : mesh_(mesh), radii_(radii), window_(mesh), seen_(mesh.face_count(), -1) {}

    Eigen::RowVectorXd around(const SurfacePoint& point, int stamp) {
        Eigen::RowVectorXd length = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(radii_.size()));
        window_.run(point, radii_.back() + 2.0 * mesh_.mean_edge);
        for (const int v : window_.reached()) {
            for (int i = mesh_.vertex_face_begin[v]; i < mesh_.vertex_face_begin[v + 1]; ++i) {
                const int f = mesh_.vertex_face[i];
                if (seen_[f] == stamp) continue;
                seen_[f] = stamp;
                add(f, length);
            }
        }
        for (Eigen::Index k = 0; k < length.size(); ++k) length[k] /= 2.0 * M_PI * radii_[k];
        return length;
    }

  private:
    void add(int f, Eigen::RowVectorXd& length) const {
        std::array<double, 3> d{};
        for (int k = 0; k < 3; ++k) {
            const int v = mesh_.face[f][k];
            if (!window_.has(v)) return;
            d[k] = window_.distance(v);
        }
        const auto [least, most] = std::minmax_element(d.begin(), d.end());
        const auto first = std::lower_bound(radii_.begin(), radii_.end(), *least);
        for (auto r = first; r != radii_.end() && *r <= *most; ++r) {
            length[r - radii_.begin()] += contour_in(mesh_.corner[f], d, *r);
        }
    }

    const TriangleMesh& mesh_;
    const std::vector<double>& radii_;
    Window window_;
    std::vector<int> seen_;
};

}  // namespace

std::vector<double> even_radii(double least, double most, int count) {
    std::vector<double> radii;
    for (int k = 0; k < count; ++k) radii.push_back(least + (most - least) * k / std::max(1, count - 1));
    return radii;
}

Eigen::MatrixXd fingerprints(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points,
                             const std::vector<double>& radii, int threads, Monitor& monitor, double from, double to) {
    Eigen::MatrixXd result(static_cast<Eigen::Index>(points.size()), static_cast<Eigen::Index>(radii.size()));
    std::vector<Tracer> tracers(worker_count(threads), Tracer(mesh, radii));
    parallel_for(
        static_cast<int>(points.size()), threads,
        [&](int i, int worker) { result.row(i) = tracers[worker].around(points[i], i); }, monitor, "features", from,
        to);
    return result;
}

double geodesic_diameter(const TriangleMesh& mesh, Monitor& monitor) {
    constexpr int sweeps = 4;
    const auto largest = std::find(mesh.component.begin(), mesh.component.end(), 0);
    int start = mesh.face[largest - mesh.component.begin()][0];
    Window window(mesh);
    double diameter = 0.0;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        monitor.check();
        window.run(point_near_vertex(mesh, start), std::numeric_limits<double>::infinity());
        for (const int v : window.reached()) {
            if (window.distance(v) > window.distance(start)) start = v;
        }
        diameter = std::max(diameter, window.distance(start));
    }
    return diameter;
}

}  // namespace isograft
