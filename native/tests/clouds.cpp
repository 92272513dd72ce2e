// SPDX-License-Identifier: GPL-3.0-or-later
#include "clouds.h"

#include <cmath>
#include <numbers>

#include "isograft/errors.h"
#include "surface/mesh.h"

namespace isograft::clouds {

namespace {

constexpr double pi = std::numbers::pi;

double gaussian(Random& random) {
    const double u = std::max(random.uniform(), 1e-300);
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * pi * random.uniform());
}

}  // namespace

Analytic plane() {
    return {"plane", 1.0, [](Random& r) { return Eigen::Vector3d(r.uniform(), r.uniform(), 0.0); },
            [](const Eigen::Vector3d& x) { return x.z(); },
            [](const Eigen::Vector3d&) { return Eigen::Vector3d(0.0, 0.0, 1.0); }};
}

Analytic sphere() {
    return {"sphere", 4.0 * pi,
            [](Random& r) {
                const double z = 2.0 * r.uniform() - 1.0, a = 2.0 * pi * r.uniform(), q = std::sqrt(1.0 - z * z);
                return Eigen::Vector3d(q * std::cos(a), q * std::sin(a), z);
            },
            [](const Eigen::Vector3d& x) { return x.norm() - 1.0; },
            [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.normalized()); }};
}

Analytic cylinder() {
    return {"cylinder", 2.0 * pi * 0.3,
            [](Random& r) {
                const double a = 2.0 * pi * r.uniform();
                return Eigen::Vector3d(0.3 * std::cos(a), 0.3 * std::sin(a), r.uniform());
            },
            [](const Eigen::Vector3d& x) { return std::hypot(x.x(), x.y()) - 0.3; },
            [](const Eigen::Vector3d& x) { return Eigen::Vector3d(x.x(), x.y(), 0.0).normalized(); }};
}

Analytic torus() {
    const auto ring = [](const Eigen::Vector3d& x) {
        return Eigen::Vector3d(Eigen::Vector3d(x.x(), x.y(), 0.0).normalized());
    };
    return {"torus", 4.0 * pi * pi * 0.4,
            [](Random& r) {
                for (;;) {
                    const double a = 2.0 * pi * r.uniform(), b = 2.0 * pi * r.uniform(), out = 1.0 + 0.4 * std::cos(b);
                    if (r.uniform() * 1.4 > out) continue;
                    return Eigen::Vector3d(out * std::cos(a), out * std::sin(a), 0.4 * std::sin(b));
                }
            },
            [ring](const Eigen::Vector3d& x) { return (x - ring(x)).norm() - 0.4; },
            [ring](const Eigen::Vector3d& x) { return Eigen::Vector3d((x - ring(x)).normalized()); }};
}

std::vector<Analytic> all() { return {plane(), sphere(), cylinder(), torus()}; }

double spacing_of(const Analytic& surface, int count) { return std::sqrt(surface.area / count); }

Points sampled(const Analytic& surface, int count, double noise, std::uint64_t seed) {
    Random random(seed);
    Points points(count, 3);
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d x = surface.sample(random);
        points.row(i) = x + noise * spacing_of(surface, count) * gaussian(random) * surface.normal(x);
    }
    return points;
}

Points joined(const Points& a, const Points& b) {
    Points both(a.rows() + b.rows(), 3);
    both << a, b;
    return both;
}

std::string refusal(const Points& points, const Points& normals) {
    try {
        Surface::from_points(points, normals);
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "";
}

Topology topology(const TriangleMesh& mesh) {
    Topology t{0, 0, 0};
    std::vector<char> seen(mesh.twin.size(), 0);
    const auto after = [](int h) { return h / 3 * 3 + (h % 3 + 1) % 3; };
    for (int h = 0; h < static_cast<int>(mesh.twin.size()); ++h) {
        if (mesh.twin[h] >= 0) continue;
        ++t.open_edges;
        if (seen[h]) continue;
        ++t.loops;
        for (int g = h; !seen[g];) {
            seen[g] = 1;
            for (g = after(g); mesh.twin[g] >= 0;) g = after(mesh.twin[g]);
        }
    }
    t.euler = mesh.vertex_count() - (3 * mesh.face_count() + t.open_edges) / 2 + mesh.face_count();
    return t;
}

}  // namespace isograft::clouds
