// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/coarse_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "hierarchy/closest.h"

namespace isograft {

namespace {

// Weight of leaving the surface against the length of the edge.
constexpr double shape_weight = 3.0;
// New triangles are not turned by more than acos of this and not thinner than this quality (1 = equilateral).
constexpr double least_turn = 0.5;
constexpr double least_quality = 0.2;
// Steps between two looks at the monitor.
constexpr std::size_t often = 4096;

class Collapser {
  public:
    Collapser(const TriangleMesh& mesh, double longest, Monitor& monitor)
        : position_(mesh.position),
          face_(mesh.face),
          alive_(mesh.face.size(), 1),
          around_(mesh.vertex_count()),
          on_boundary_(mesh.on_boundary),
          version_(mesh.vertex_count(), 0),
          into_(mesh.vertex_count(), -1),
          longest_(longest),
          count_(mesh.vertex_count()) {
        for (std::size_t f = 0; f < face_.size(); ++f) {
            for (const int v : face_[f]) around_[v].push_back(static_cast<int>(f));
        }
        for (std::size_t f = 0; f < face_.size(); ++f) {
            if (f % often == 0) monitor.check();
            for (int k = 0; k < 3; ++k) {
                const int u = face_[f][k];
                const int v = face_[f][(k + 1) % 3];
                const bool open = mesh.twin[3 * f + k] < 0;
                if (u < v || open) offer_both(u, v);
            }
        }
    }

    [[nodiscard]] int count() const { return count_; }

    /// Collapse the cheapest edge that may be. \return false if there is none.
    bool step() {
        while (!queue_.empty()) {
            const Item item = queue_.top();
            queue_.pop();
            if (into_[item.from] >= 0 || into_[item.to] >= 0) continue;
            if (item.stamp != version_[item.from] + version_[item.to]) continue;
            if (!allowed(item.from, item.to)) continue;
            collapse(item.from, item.to);
            return true;
        }
        return false;
    }

    [[nodiscard]] int survivor(int v) const {
        while (into_[v] >= 0) v = into_[v];
        return v;
    }
    [[nodiscard]] bool lives(int face) const { return alive_[face] != 0; }
    [[nodiscard]] const std::array<int, 3>& face(int f) const { return face_[f]; }

  private:
    struct Item {
        double cost;
        int from, to;
        int stamp;
        bool operator<(const Item& other) const {
            if (cost != other.cost) return cost > other.cost;
            return from != other.from ? from > other.from : to > other.to;
        }
    };

    [[nodiscard]] Eigen::Vector3d normal(const std::array<int, 3>& f) const {
        return (position_[f[1]] - position_[f[0]]).cross(position_[f[2]] - position_[f[0]]);
    }

    void neighbours(int v, std::vector<int>& result) const {
        result.clear();
        for (const int f : around_[v]) {
            for (const int w : face_[f]) {
                if (w != v) result.push_back(w);
            }
        }
        std::sort(result.begin(), result.end());
        result.erase(std::unique(result.begin(), result.end()), result.end());
    }

    void offer(int from, int to) {
        const Eigen::Vector3d step = position_[to] - position_[from];
        double height = 0.0;
        for (const int f : around_[from]) {
            const Eigen::Vector3d n = normal(face_[f]);
            height = std::max(height, std::abs(n.dot(step)) / std::max(n.norm(), 1e-300));
        }
        const double cost = step.squaredNorm() + shape_weight * shape_weight * height * height;
        queue_.push({cost, from, to, version_[from] + version_[to]});
    }
    void offer_both(int u, int v) {
        offer(u, v);
        offer(v, u);
    }

    [[nodiscard]] bool allowed(int from, int to) {
        int shared_faces = 0;
        for (const int f : around_[from]) {
            const auto& c = face_[f];
            if (c[0] == to || c[1] == to || c[2] == to) ++shared_faces;
        }
        const bool boundary_edge = shared_faces == 1;
        if (on_boundary_[from] && !(boundary_edge && on_boundary_[to])) return false;
        neighbours(from, near_from_);
        neighbours(to, near_to_);
        common_.clear();
        std::set_intersection(near_from_.begin(), near_from_.end(), near_to_.begin(), near_to_.end(),
                              std::back_inserter(common_));
        // Anything else in common would be pinched together (the link condition).
        if (static_cast<int>(common_.size()) != shared_faces) return false;
        if (boundary_edge && boundary_leaves(from, to)) return false;
        for (const int f : around_[from]) {
            std::array<int, 3> c = face_[f];
            if (c[0] == to || c[1] == to || c[2] == to) continue;
            const Eigen::Vector3d before = normal(c);
            std::replace(c.begin(), c.end(), from, to);
            const Eigen::Vector3d after = normal(c);
            if (after.dot(before) < least_turn * after.norm() * before.norm()) return false;
            double squares = 0.0;
            for (int k = 0; k < 3; ++k) {
                const double l = (position_[c[k]] - position_[c[(k + 1) % 3]]).squaredNorm();
                if (l > longest_ * longest_) return false;
                squares += l;
            }
            constexpr double equilateral = 3.4641016151377544;  // 2 sqrt(3)
            if (equilateral * after.norm() < least_quality * squares) return false;
        }
        // Fewer than three triangles do not close around a vertex.
        return around_[to].size() + around_[from].size() > 6U;
    }

    // A boundary may lose a vertex only where it runs nearly straight through it.
    [[nodiscard]] bool boundary_leaves(int from, int to) const {
        for (const int v : near_from_) {
            if (v == to || !on_boundary_[v]) continue;
            int faces = 0;
            for (const int f : around_[from]) {
                const auto& c = face_[f];
                faces += static_cast<int>(c[0] == v || c[1] == v || c[2] == v);
            }
            if (faces != 1) continue;
            const Eigen::Vector3d chord = (position_[v] - position_[to]).normalized();
            const Eigen::Vector3d d = position_[from] - position_[to];
            if ((d - d.dot(chord) * chord).norm() > 0.3 * longest_) return true;
        }
        return false;
    }

    void collapse(int from, int to) {
        for (const int f : around_[from]) {
            auto& c = face_[f];
            if (c[0] == to || c[1] == to || c[2] == to) {
                alive_[f] = 0;
                for (const int v : c) {
                    if (v != from) std::erase(around_[v], f);
                }
            } else {
                std::replace(c.begin(), c.end(), from, to);
                around_[to].push_back(f);
            }
        }
        around_[from].clear();
        into_[from] = to;
        --count_;
        // Other edges nearby keep an old price, which is near enough: what is forbidden is tested when it is their
        // turn.
        ++version_[to];
        neighbours(to, near_to_);
        for (const int v : near_to_) offer_both(to, v);
    }

    const std::vector<Eigen::Vector3d>& position_;
    std::vector<std::array<int, 3>> face_;
    std::vector<char> alive_;
    std::vector<std::vector<int>> around_;
    std::vector<char> on_boundary_;
    std::vector<int> version_;
    std::vector<int> into_;
    std::vector<int> near_from_, near_to_, common_;
    std::priority_queue<Item> queue_;
    double longest_;
    int count_;
};

int goal_count(double area, double edge) {
    // Equilateral triangles: a vertex for every two.
    return static_cast<int>(area / (0.8660254037844386 * edge * edge)) + 4;
}

// Fill `place` and `members`: the walk to a fine vertex's place begins at the coarse vertex start_of(fine vertex).
template <class StartOf>
void locate(const TriangleMesh& fine, CoarseMesh& coarse, Monitor& monitor, StartOf&& start_of) {
    coarse.place.assign(fine.vertex_count(), {});
    coarse.members.resize(coarse.mesh.vertex_count());
    for (int v = 0; v < fine.vertex_count(); ++v) {
        if (v % often == 0) monitor.check();
        const int start = start_of(v);
        if (start < 0) continue;
        coarse.place[v] = closest_from(coarse.mesh, start, fine.position[v]);
        coarse.members[nearest_corner(coarse.mesh, coarse.place[v])].push_back(v);
    }
}

}  // namespace

CoarseMesh coarsen(const TriangleMesh& fine, double edge, Monitor& monitor) {
    CoarseMesh coarse;
    const int goal = goal_count(fine.area, edge);
    if (fine.vertex_count() <= goal * 4 / 3) {
        coarse.mesh = fine;
        return coarse;
    }
    Collapser collapser(fine, 2.2 * edge, monitor);
    for (int i = 0; collapser.count() > goal && collapser.step(); ++i) {
        if (i % 1024 == 0) monitor.check();
    }
    std::vector<std::array<int, 3>> faces;
    std::vector<int> input_face;
    std::vector<char> reversed;
    for (int f = 0; f < fine.face_count(); ++f) {
        if (!collapser.lives(f)) continue;
        faces.push_back(collapser.face(f));
        input_face.push_back(f);
        reversed.push_back(0);
    }
    coarse.mesh = build_mesh(fine.position, faces, input_face, reversed);
    coarse.fine_vertex = coarse.mesh.input_vertex;
    std::vector<int> coarse_vertex(fine.vertex_count(), -1);
    for (int v = 0; v < coarse.mesh.vertex_count(); ++v) coarse_vertex[coarse.fine_vertex[v]] = v;
    // Negative where the whole component is gone: it was smaller than a triangle.
    locate(fine, coarse, monitor, [&](int v) { return coarse_vertex[collapser.survivor(v)]; });
    return coarse;
}

CoarseMesh coarsen_further(const TriangleMesh& fine, const CoarseMesh& coarse, double edge, Monitor& monitor) {
    if (coarse.fine_vertex.empty()) return coarsen(fine, edge, monitor);
    CoarseMesh result = coarsen(coarse.mesh, edge, monitor);
    if (result.fine_vertex.empty()) return coarse;
    const std::vector<SurfacePoint> step = std::move(result.place);
    for (int& v : result.fine_vertex) v = coarse.fine_vertex[v];
    result.members.clear();
    locate(fine, result, monitor, [&](int v) {
        const SurfacePoint& place = coarse.place[v];
        if (place.face < 0) return -1;
        const SurfacePoint& next = step[nearest_corner(coarse.mesh, place)];
        return next.face < 0 ? -1 : nearest_corner(result.mesh, next);
    });
    return result;
}

SurfacePoint to_fine(const Detail& detail, const SurfacePoint& point) {
    const CoarseMesh& coarse = detail.coarse;
    const TriangleMesh& fine = detail.fine();
    if (coarse.fine_vertex.empty()) return point;
    const Eigen::Vector3d x = position(coarse.mesh, point) / detail.factor;
    int start = -1;
    double nearest = std::numeric_limits<double>::max();
    for (const int corner : coarse.mesh.face[point.face]) {
        for (const int v : coarse.members[corner]) {
            const double d = (fine.position[v] - x).squaredNorm();
            if (d < nearest) {
                nearest = d;
                start = v;
            }
        }
    }
    return closest_from(fine, start, x);
}

std::vector<double> at_coarse(const CoarseMesh& coarse, const std::vector<double>& fine_values) {
    if (coarse.fine_vertex.empty()) return fine_values;
    std::vector<double> values(coarse.fine_vertex.size());
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = fine_values[coarse.fine_vertex[v]];
    return values;
}

}  // namespace isograft
