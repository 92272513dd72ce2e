// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "isograft/monitor.h"
#include "surface/edges.h"

namespace isograft {

namespace {

using Eigen::Vector3d;

// Mean cosine between the normal at the rim and the way to its middle: 0 for a hole in a plane, 1 for a stump.
constexpr double across = 0.8;
// How far the surface leads to the middle along the rim, of how far it leads there or away: 1 for a hole, -1 where a
// model folds inwards at eyes and lips. Holes of scans have 0.4 or more.
constexpr double onward = 0.3;
// Of the root of the component's area: about half the spacing of the samples.
constexpr double fine_enough = 0.01;
// Height of a triangle over its longest edge.
constexpr double flattest = 1e-3;

struct Rim {
    /// In the order of the triangles beside it, which a piece runs along the other way.
    std::vector<int> halfedge;
    double length = 0.0;
    Vector3d middle = Vector3d::Zero();
};

/// Points around the middle, and how far along the way round each is, in [0, 1).
struct Ring {
    std::vector<int> vertex;
    std::vector<double> at;
};

std::vector<Rim> find_rims(const TriangleMesh& mesh, Monitor& monitor) {
    std::vector<Rim> rims;
    std::vector<char> seen(mesh.twin.size(), 0);
    for (int start = 0; start < 3 * mesh.face_count(); ++start) {
        if (start % often == 0) monitor.check();
        if (mesh.twin[start] >= 0 || seen[start] != 0) continue;
        Rim rim;
        for (int h = start; seen[h] == 0;) {
            seen[h] = 1;
            rim.halfedge.push_back(h);
            const double length = std::abs(mesh.edge(h));
            rim.length += length;
            rim.middle += 0.5 * length * (mesh.position[mesh.from(h)] + mesh.position[mesh.to(h)]);
            h = following(h);
            while (mesh.twin[h] >= 0) h = following(mesh.twin[h]);
        }
        rim.middle /= rim.length;
        rims.push_back(std::move(rim));
    }
    return rims;
}

bool is_hole(const TriangleMesh& mesh, const Rim& rim) {
    double aside = 0.0, towards = 0.0, either = 0.0;
    for (const int h : rim.halfedge) {
        const Vector3d &a = mesh.position[mesh.from(h)], &b = mesh.position[mesh.to(h)];
        const Vector3d way = (rim.middle - 0.5 * (a + b)).normalized();
        const double leads = (b - a).cross(mesh.normal[h / 3]).dot(way);
        aside += std::abs(mesh.edge(h)) * std::abs(mesh.normal[h / 3].dot(way));
        towards += leads;
        either += std::abs(leads);
    }
    return aside < across * rim.length && towards > onward * either;
}

/// A mesh that grows by pieces.
class Closer {
  public:
    explicit Closer(const TriangleMesh& mesh) : mesh_(mesh), position_(mesh.position), face_(mesh.face) {}

    void close(const Rim& rim, double spacing) {
        const auto vertices = position_.size(), faces = face_.size();
        lay_rings(rim, std::max(spacing, rim.length / static_cast<double>(rim.halfedge.size())));
        smooth(rim, static_cast<int>(vertices), faces);
        for (std::size_t f = faces; f < face_.size(); ++f) {
            if (has_area(face_[f])) continue;
            position_.resize(vertices);
            face_.resize(faces);
            return;
        }
    }

    [[nodiscard]] TriangleMesh finish(Monitor& monitor) const {
        std::vector<int> input_face = mesh_.input_face;
        std::vector<char> input_order = mesh_.input_order;
        input_face.resize(face_.size(), -1);
        input_order.resize(face_.size(), 0);
        TriangleMesh result = build_mesh(position_, face_, input_face, input_order, Piece(monitor, 0.0));
        for (int& v : result.input_vertex) v = v < mesh_.vertex_count() ? mesh_.input_vertex[v] : -1;
        return result;
    }

    [[nodiscard]] bool changed() const { return face_.size() > mesh_.face.size(); }

  private:
    [[nodiscard]] bool has_area(const Corners& f) const {
        const Vector3d ab = position_[f[1]] - position_[f[0]], ac = position_[f[2]] - position_[f[0]];
        const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
        return ab.cross(ac).norm() > flattest * longest * longest;
    }

    void lay_rings(const Rim& rim, double spacing) {
        Ring ring;
        std::vector<Vector3d> outline;
        double along = 0.0, radius = 0.0;
        for (auto h = rim.halfedge.rbegin(); h != rim.halfedge.rend(); ++h) {
            ring.vertex.push_back(mesh_.to(*h));
            ring.at.push_back(along / rim.length);
            outline.push_back(mesh_.position[mesh_.to(*h)]);
            const double length = std::abs(mesh_.edge(*h));
            radius += (outline.back() - rim.middle).norm() * length / rim.length;
            along += length;
        }
        const std::vector<double> outline_at = ring.at;
        const int steps = std::max(1, static_cast<int>(std::lround(radius / spacing)));
        for (int s = 1; s < steps; ++s) {
            const double shrunk = 1.0 - static_cast<double>(s) / steps;
            const int count = std::max(3, static_cast<int>(std::lround(shrunk * rim.length / spacing)));
            Ring next;
            std::size_t k = 0;
            for (int i = 0; i < count; ++i) {
                const double at = static_cast<double>(i) / count;
                while (k + 1 < outline_at.size() && outline_at[k + 1] <= at) ++k;
                const double end = k + 1 < outline_at.size() ? outline_at[k + 1] : 1.0;
                const double t = (at - outline_at[k]) / (end - outline_at[k]);
                const Vector3d x = (1.0 - t) * outline[k] + t * outline[(k + 1) % outline.size()];
                next.vertex.push_back(static_cast<int>(position_.size()));
                next.at.push_back(at);
                position_.push_back(rim.middle + shrunk * (x - rim.middle));
            }
            join(ring, next);
            ring = std::move(next);
        }
        const auto count = ring.vertex.size();
        if (count == 3) {
            face_.push_back({ring.vertex[0], ring.vertex[1], ring.vertex[2]});
            return;
        }
        const int centre = static_cast<int>(position_.size());
        position_.push_back(rim.middle);
        for (std::size_t i = 0; i < count; ++i) {
            face_.push_back({ring.vertex[i], ring.vertex[(i + 1) % count], centre});
        }
    }

    // A strip of triangles between two rings, with every edge of both.
    void join(const Ring& outer, const Ring& inner) {
        const auto m = outer.vertex.size(), n = inner.vertex.size();
        const auto end = [](const Ring& ring, std::size_t i) { return i + 1 < ring.at.size() ? ring.at[i + 1] : 1.0; };
        std::size_t i = 0, j = 0;
        while (i < m || j < n) {
            if (j == n || (i < m && end(outer, i) <= end(inner, j))) {
                face_.push_back({outer.vertex[i], outer.vertex[(i + 1) % m], inner.vertex[j % n]});
                ++i;
            } else {
                face_.push_back({outer.vertex[i % m], inner.vertex[(j + 1) % n], inner.vertex[j]});
                ++j;
            }
        }
    }

    // Rows of the Laplacian: those of the new vertices, and of the rim, so that the piece meets the surface smoothly.
    void smooth(const Rim& rim, int first, std::size_t first_face) {
        const int unknowns = static_cast<int>(position_.size()) - first;
        if (unknowns == 0) return;
        std::vector<int> centre;
        for (const int h : rim.halfedge) centre.push_back(mesh_.from(h));
        std::vector<int> sorted = centre;
        std::sort(sorted.begin(), sorted.end());
        std::vector<std::vector<int>> around(centre.size() + unknowns);
        const auto row_of = [&](int v) {
            if (v >= first) return static_cast<int>(centre.size()) + v - first;
            const auto found = std::lower_bound(sorted.begin(), sorted.end(), v);
            return found != sorted.end() && *found == v ? static_cast<int>(found - sorted.begin()) : -1;
        };
        const auto note = [&](int from, int to) {
            const int row = row_of(from);
            if (row >= 0 && std::find(around[row].begin(), around[row].end(), to) == around[row].end()) {
                around[row].push_back(to);
            }
        };
        const auto note_face = [&](const Corners& f) {
            for (int k = 0; k < 3; ++k) {
                note(f[k], f[(k + 1) % 3]);
                note(f[k], f[(k + 2) % 3]);
            }
        };
        for (std::size_t f = first_face; f < face_.size(); ++f) note_face(face_[f]);
        for (const int v : sorted) {
            for (int i = mesh_.vertex_face_begin[v]; i < mesh_.vertex_face_begin[v + 1]; ++i) {
                note_face(mesh_.face[mesh_.vertex_face[i]]);
            }
        }
        std::vector<Eigen::Triplet<double>> entries;
        Eigen::MatrixX3d known = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(around.size()), 3);
        for (int row = 0; row < static_cast<int>(around.size()); ++row) {
            const int v =
                row < static_cast<int>(sorted.size()) ? sorted[row] : first + row - static_cast<int>(sorted.size());
            double sum = 0.0;
            for (const int w : around[row]) sum += 1.0 / (position_[w] - position_[v]).norm();
            const auto put = [&](int w, double weight) {
                if (w >= first) {
                    entries.emplace_back(row, w - first, weight);
                } else {
                    known.row(row) += weight * position_[w].transpose();
                }
            };
            put(v, -1.0);
            for (const int w : around[row]) put(w, 1.0 / (position_[w] - position_[v]).norm() / sum);
        }
        Eigen::SparseMatrix<double> laplacian(static_cast<Eigen::Index>(around.size()), unknowns);
        laplacian.setFromTriplets(entries.begin(), entries.end());
        const Eigen::SparseMatrix<double> transposed = laplacian.transpose();
        const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(transposed * laplacian);
        if (solver.info() != Eigen::Success) return;
        const Eigen::MatrixX3d x = solver.solve(-(transposed * known));
        for (int i = 0; i < unknowns; ++i) position_[first + i] = x.row(i);
    }

    const TriangleMesh& mesh_;
    std::vector<Vector3d> position_;
    std::vector<Corners> face_;
};

}  // namespace

std::optional<TriangleMesh> with_holes_closed(const TriangleMesh& mesh, double longest, Monitor& monitor) {
    std::vector<double> root_area(mesh.component_count, 0.0);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (f % often == 0) monitor.check();
        root_area[mesh.component[f]] += 0.5 * mesh.corner[f][1].real() * mesh.corner[f][2].imag();
    }
    for (double& a : root_area) a = std::sqrt(a);
    // Most meshes have no hole: those are not copied.
    std::optional<Closer> closer;
    for (const Rim& rim : find_rims(mesh, monitor)) {
        monitor.check();
        const double unit = root_area[mesh.component[rim.halfedge.front() / 3]];
        if (rim.halfedge.size() < 3 || rim.length > longest * unit || !is_hole(mesh, rim)) continue;
        if (!closer) closer.emplace(mesh);
        closer->close(rim, fine_enough * unit);
    }
    if (!closer || !closer->changed()) return {};
    return closer->finish(monitor);
}

}  // namespace isograft
