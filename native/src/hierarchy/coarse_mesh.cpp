// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/coarse_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "base/filling.h"
#include "hierarchy/closest.h"
#include "surface/edges.h"

namespace isograft {

namespace {

// Weight of leaving the surface against the length of the edge.
constexpr double shape_weight = 3.0;
// New triangles are not turned by more than acos of this and not thinner than this quality (1 = equilateral).
constexpr double least_turn = 0.5;
constexpr double least_quality = 0.2;
// Steps between two looks at the monitor.
constexpr int steps_between = 4096;

class Collapser {
  public:
    Collapser(const TriangleMesh& mesh, double longest, Monitor& monitor)
        : position_(mesh.position), longest_(longest), count_(mesh.vertex_count()) {
        copy_watched(face_, mesh.face, monitor);
        fill_watched(alive_, mesh.face.size(), char{1}, monitor);
        fill_watched(normal_, mesh.face.size(), Eigen::Vector3d(Eigen::Vector3d::Zero()), monitor);
        fill_watched(size_, mesh.face.size(), monitor);
        fill_watched(next_, 3 * mesh.face.size(), -1, monitor);
        copy_watched(on_boundary_, mesh.on_boundary, monitor);
        for (auto* of_vertex : {&first_, &into_}) fill_watched(*of_vertex, mesh.position.size(), -1, monitor);
        for (auto* of_vertex : {&degree_, &version_, &mark_}) fill_watched(*of_vertex, mesh.position.size(), monitor);
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (f % steps_between == 0) monitor.check();
            measure(f);
            for (int k = 0; k < 3; ++k) link(face_[f][k], 3 * f + k);
        }
        std::vector<Item> items;
        // Twice as many as there are edges: what collapses add goes in without a move.
        items.reserve(3 * mesh.face.size());
        for (int f = 0; f < mesh.face_count(); ++f) {
            if (f % steps_between == 0) monitor.check();
            for (int k = 0; k < 3; ++k) {
                const int u = face_[f][k];
                const int v = face_[f][(k + 1) % 3];
                const bool open = mesh.twin[3 * f + k] < 0;
                if (u < v || open) items.push_back(offer(u, v));
            }
        }
        monitor.check();
        queue_ = std::priority_queue<Item>(std::less<Item>(), std::move(items));
    }

    [[nodiscard]] int count() const { return count_; }

    /// Collapse the cheapest edge that may be. \return false if there is none.
    bool step() {
        while (!queue_.empty()) {
            const Item item = queue_.top();
            queue_.pop();
            if (into_[item.from] >= 0 || into_[item.to] >= 0) continue;
            if (item.stamp != version_[item.from] + version_[item.to]) continue;
            if (allowed(item.from, item.to)) {
                collapse(item.from, item.to);
                return true;
            }
            if (item.back >= 0.0) queue_.push({item.back, -1.0, item.to, item.from, item.stamp});
        }
        return false;
    }

    [[nodiscard]] int survivor(int v) const {
        while (into_[v] >= 0) v = into_[v];
        return v;
    }
    [[nodiscard]] bool lives(int face) const { return alive_[face] != 0; }
    [[nodiscard]] const Corners& face(int f) const { return face_[f]; }

  private:
    /// An edge to be collapsed, the cheaper way first; the other way waits for that one to be refused.
    struct Item {
        double cost;
        /// Cost of the other way; negative if that was refused.
        double back;
        int from, to;
        int stamp;
        bool operator<(const Item& other) const {
            if (cost != other.cost) return cost > other.cost;
            return from != other.from ? from > other.from : to > other.to;
        }
    };

    [[nodiscard]] Eigen::Vector3d normal(const Corners& f) const {
        return (position_[f[1]] - position_[f[0]]).cross(position_[f[2]] - position_[f[0]]);
    }
    void measure(int f) {
        normal_[f] = normal(face_[f]);
        size_[f] = normal_[f].norm();
    }

    // The triangles of a vertex are a list of their corners there.
    void link(int v, int corner) {
        next_[corner] = first_[v];
        first_[v] = corner;
        ++degree_[v];
    }
    void unlink(int v, int corner) {
        int* at = &first_[v];
        while (*at != corner) at = &next_[*at];
        *at = next_[corner];
        --degree_[v];
    }
    [[nodiscard]] bool has(int f, int v) const { return face_[f][0] == v || face_[f][1] == v || face_[f][2] == v; }

    void neighbours(int v, std::vector<int>& result) {
        result.clear();
        ++stamp_;
        mark_[v] = stamp_;
        for (int c = first_[v]; c >= 0; c = next_[c]) {
            for (const int w : face_[c / 3]) {
                if (mark_[w] == stamp_) continue;
                mark_[w] = stamp_;
                result.push_back(w);
            }
        }
    }

    [[nodiscard]] double cost(int from, int to) const {
        const Eigen::Vector3d step = position_[to] - position_[from];
        double height = 0.0;
        for (int c = first_[from]; c >= 0; c = next_[c]) {
            const int f = c / 3;
            height = std::max(height, std::abs(normal_[f].dot(step)) / std::max(size_[f], 1e-300));
        }
        return step.squaredNorm() + shape_weight * shape_weight * height * height;
    }
    [[nodiscard]] Item offer(int u, int v) const {
        const int stamp = version_[u] + version_[v];
        const Item there{cost(u, v), -1.0, u, v, stamp};
        const Item back{cost(v, u), -1.0, v, u, stamp};
        const bool first = back < there;
        Item cheaper = first ? there : back;
        cheaper.back = (first ? back : there).cost;
        return cheaper;
    }

    [[nodiscard]] bool allowed(int from, int to) {
        int shared_faces = 0;
        for (int c = first_[from]; c >= 0; c = next_[c]) shared_faces += has(c / 3, to) ? 1 : 0;
        const bool boundary_edge = shared_faces == 1;
        if (on_boundary_[from] && !(boundary_edge && on_boundary_[to])) return false;
        neighbours(to, near_to_);
        neighbours(from, near_from_);
        // Anything else in common would be pinched together (the link condition).
        const auto common =
            std::count_if(near_to_.begin(), near_to_.end(), [&](int v) { return v != from && mark_[v] == stamp_; });
        if (static_cast<int>(common) != shared_faces) return false;
        if (boundary_edge && boundary_leaves(from, to)) return false;
        for (int corner = first_[from]; corner >= 0; corner = next_[corner]) {
            const int f = corner / 3;
            if (has(f, to)) continue;
            Corners c = face_[f];
            c[corner % 3] = to;
            const Eigen::Vector3d after = normal(c);
            const double size = after.norm();
            if (after.dot(normal_[f]) < least_turn * size * size_[f]) return false;
            double squares = 0.0;
            for (int k = 0; k < 3; ++k) {
                const double l = (position_[c[k]] - position_[c[(k + 1) % 3]]).squaredNorm();
                if (l > longest_ * longest_) return false;
                squares += l;
            }
            constexpr double equilateral = 3.4641016151377544;  // 2 sqrt(3)
            if (equilateral * size < least_quality * squares) return false;
        }
        // Fewer than three triangles do not close around a vertex.
        return degree_[to] + degree_[from] > 6;
    }

    // A boundary may lose a vertex only where it runs nearly straight through it.
    [[nodiscard]] bool boundary_leaves(int from, int to) const {
        for (const int v : near_from_) {
            if (v == to || !on_boundary_[v]) continue;
            int faces = 0;
            for (int c = first_[from]; c >= 0; c = next_[c]) faces += has(c / 3, v) ? 1 : 0;
            if (faces != 1) continue;
            const Eigen::Vector3d chord = (position_[v] - position_[to]).normalized();
            const Eigen::Vector3d d = position_[from] - position_[to];
            if ((d - d.dot(chord) * chord).norm() > 0.3 * longest_) return true;
        }
        return false;
    }

    void collapse(int from, int to) {
        for (int corner = first_[from], next = -1; corner >= 0; corner = next) {
            next = next_[corner];
            const int f = corner / 3;
            if (has(f, to)) {
                alive_[f] = 0;
                for (int k = 0; k < 3; ++k) {
                    if (face_[f][k] != from) unlink(face_[f][k], 3 * f + k);
                }
            } else {
                face_[f][corner % 3] = to;
                link(to, corner);
                measure(f);
            }
        }
        first_[from] = -1;
        degree_[from] = 0;
        into_[from] = to;
        --count_;
        // Other edges nearby keep an old price, which is near enough: what is forbidden is tested when it is their
        // turn.
        ++version_[to];
        neighbours(to, near_to_);
        for (const int v : near_to_) queue_.push(offer(to, v));
    }

    const std::vector<Eigen::Vector3d>& position_;
    std::vector<Corners> face_;
    std::vector<char> alive_;
    /// Per triangle twice its vector area, and the length of that.
    std::vector<Eigen::Vector3d> normal_;
    std::vector<double> size_;
    std::vector<int> next_, first_, degree_;
    std::vector<char> on_boundary_;
    std::vector<int> version_;
    std::vector<int> into_;
    std::vector<int> mark_;
    int stamp_ = 0;
    std::vector<int> near_from_, near_to_;
    std::priority_queue<Item> queue_;
    double longest_;
    int count_;
};

// Progress: what building the queue takes, and with the collapses.
constexpr double collapsing_from = 0.2, locating_from = 0.9;

int goal_count(double area, double edge) {
    // Equilateral triangles: a vertex for every two.
    return static_cast<int>(area / (0.8660254037844386 * edge * edge)) + 4;
}

// Fill `place` and `members`: the walk to a fine vertex's place begins at the coarse vertex start_of(fine vertex).
template <class StartOf>
void locate(const TriangleMesh& fine, CoarseMesh& coarse, Piece progress, StartOf&& start_of) {
    coarse.place.assign(fine.vertex_count(), {});
    coarse.members.resize(coarse.mesh.vertex_count());
    for (int v = 0; v < fine.vertex_count(); ++v) {
        if (v % steps_between == 0) progress.reach(static_cast<double>(v) / fine.vertex_count());
        const int start = start_of(v);
        if (start < 0) continue;
        coarse.place[v] = closest_from(coarse.mesh, start, fine.position[v]);
        coarse.members[nearest_corner(coarse.mesh, coarse.place[v])].push_back(v);
    }
}

}  // namespace

CoarseMesh coarsen(const TriangleMesh& fine, double edge, Piece progress, double slack) {
    Monitor& monitor = progress.monitor();
    CoarseMesh coarse;
    const int goal = goal_count(fine.area, edge);
    if (fine.vertex_count() <= static_cast<int>(goal * slack)) {
        coarse.mesh = fine;
        measure_paths(coarse.mesh, monitor);
        return coarse;
    }
    Collapser collapser(fine, 2.2 * edge, monitor);
    progress.reach(collapsing_from);
    const int all = collapser.count();
    for (int i = 0; collapser.count() > goal && collapser.step(); ++i) {
        const double done = static_cast<double>(i) / (all - goal);
        if (i % 1024 == 0) progress.reach(collapsing_from + (locating_from - collapsing_from) * done);
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
    coarse.mesh = build_mesh(fine.position, faces, input_face, reversed, monitor);
    measure_paths(coarse.mesh, monitor);
    coarse.fine_vertex = coarse.mesh.input_vertex;
    std::vector<int> coarse_vertex(fine.vertex_count(), -1);
    for (int v = 0; v < coarse.mesh.vertex_count(); ++v) coarse_vertex[coarse.fine_vertex[v]] = v;
    // Negative where the whole component is gone: it was smaller than a triangle.
    progress.reach(locating_from);
    locate(fine, coarse, progress.until(1.0), [&](int v) { return coarse_vertex[collapser.survivor(v)]; });
    return coarse;
}

CoarseMesh coarsen_further(const TriangleMesh& fine, const CoarseMesh& coarse, double edge, Piece progress) {
    if (coarse.fine_vertex.empty()) return coarsen(fine, edge, progress);
    CoarseMesh result = coarsen(coarse.mesh, edge, progress.until(0.3));
    if (result.fine_vertex.empty()) return coarse;
    const std::vector<SurfacePoint> step = std::move(result.place);
    for (int& v : result.fine_vertex) v = coarse.fine_vertex[v];
    result.members.clear();
    locate(fine, result, progress.until(1.0), [&](int v) {
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
