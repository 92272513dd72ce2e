// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>

namespace isograft {

namespace {

constexpr double full = 2.0 * std::numbers::pi;
constexpr double tolerance = 1e-6;
// Edges of the longest gap that is closed.
constexpr int longest_gap = 12;

// Triangles as they are accepted, with the angles they take at each site.
class Fans {
  public:
    explicit Fans(const SurfaceSites& sites) : sites_(&sites), at_(sites.position.size()) {}

    /// Whether the triangle's angles are free at all corners, its edges too, and it faces as they do.
    [[nodiscard]] bool allowed(const Corners& t, double least_facing) const {
        const Eigen::Vector3d& a = sites_->position[t[0]];
        const Eigen::Vector3d normal =
            (sites_->position[t[1]] - a).cross(sites_->position[t[2]] - a).stableNormalized();
        for (int k = 0; k < 3; ++k) {
            if (normal.dot(sites_->normal[t[k]]) < least_facing) return false;
            const Wedge w = wedge(t, k);
            if (!(w.span > tolerance && w.span < std::numbers::pi)) return false;
            for (const Wedge& other : at_[t[k]]) {
                if (other.next == w.next || other.previous == w.previous) return false;
                if (turn(other.start, w.start) < other.span - tolerance) return false;
                if (turn(w.start, other.start) < w.span - tolerance) return false;
            }
        }
        return true;
    }

    void add(const Corners& t) {
        for (int k = 0; k < 3; ++k) at_[t[k]].push_back(wedge(t, k));
        faces_.push_back(t);
    }

    [[nodiscard]] const std::vector<Corners>& faces() const { return faces_; }

    /// Keep only the largest fan of every site.
    void drop_small_fans() {
        for (bool dropped = true; dropped;) {
            std::vector<Corners> gone;
            for (std::size_t v = 0; v < at_.size(); ++v) collect_small_fans(static_cast<int>(v), gone);
            std::sort(gone.begin(), gone.end());
            std::vector<Corners> kept;
            for (const Corners& t : faces_) {
                if (!std::binary_search(gone.begin(), gone.end(), t)) kept.push_back(t);
            }
            dropped = kept.size() < faces_.size();
            faces_.clear();
            for (auto& list : at_) list.clear();
            for (const Corners& t : kept) add(t);
        }
    }

    /// The site after `to` along the boundary that runs from `from` to `to` with the surface on its left; of a
    /// site with one fan.
    [[nodiscard]] std::optional<int> boundary_after(int to) const {
        // The boundary leaves along the one edge that no other triangle runs in towards the site.
        for (const Wedge& w : at_[to]) {
            const bool shared = std::any_of(at_[to].begin(), at_[to].end(),
                                            [&](const Wedge& other) { return other.previous == w.next; });
            if (!shared) return w.next;
        }
        return std::nullopt;
    }

  private:
    // What a triangle takes at one corner: the angle from the edge to `next`, counter-clockwise to that to `previous`.
    struct Wedge {
        double start, span;
        int next, previous;
        Corners face;
    };

    static double turn(double from, double to) {
        const double d = std::fmod(to - from, full);
        return d < 0.0 ? d + full : d;
    }

    [[nodiscard]] double angle(int at, int to) const {
        const Eigen::Vector3d& n = sites_->normal[at];
        const Eigen::Vector3d axis = n.unitOrthogonal();
        const Eigen::Vector3d d = sites_->position[to] - sites_->position[at];
        return std::atan2(d.dot(n.cross(axis)), d.dot(axis));
    }

    [[nodiscard]] Wedge wedge(const Corners& t, int k) const {
        const int next = t[(k + 1) % 3], previous = t[(k + 2) % 3];
        const double start = angle(t[k], next);
        return {start, turn(start, angle(t[k], previous)), next, previous, t};
    }

    void collect_small_fans(int v, std::vector<Corners>& gone) const {
        const std::vector<Wedge>& wedges = at_[v];
        std::vector<int> fan(wedges.size(), -1), size;
        for (std::size_t seed = 0; seed < wedges.size(); ++seed) {
            if (fan[seed] >= 0) continue;
            std::vector<std::size_t> stack{seed};
            fan[seed] = static_cast<int>(size.size());
            size.push_back(0);
            while (!stack.empty()) {
                const std::size_t i = stack.back();
                stack.pop_back();
                ++size.back();
                for (std::size_t j = 0; j < wedges.size(); ++j) {
                    if (fan[j] >= 0) continue;
                    if (wedges[j].next != wedges[i].previous && wedges[j].previous != wedges[i].next) continue;
                    fan[j] = fan[seed];
                    stack.push_back(j);
                }
            }
        }
        if (size.size() < 2) return;
        const int largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
        for (std::size_t i = 0; i < wedges.size(); ++i) {
            if (fan[i] != largest) gone.push_back(wedges[i].face);
        }
    }

    const SurfaceSites* sites_;
    std::vector<std::vector<Wedge>> at_;
    std::vector<Corners> faces_;
};

std::vector<std::vector<int>> boundary_loops(const Fans& fans, int sites) {
    std::vector<int> after(sites, -1);
    for (int v = 0; v < sites; ++v) after[v] = fans.boundary_after(v).value_or(-1);
    std::vector<char> seen(sites, 0);
    std::vector<std::vector<int>> loops;
    for (int v = 0; v < sites; ++v) {
        if (after[v] < 0 || seen[v]) continue;
        std::vector<int> loop;
        for (int w = v; w >= 0 && !seen[w]; w = after[w]) {
            seen[w] = 1;
            loop.push_back(w);
        }
        loops.push_back(std::move(loop));
    }
    return loops;
}

double circumradius(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const double area = 0.5 * (b - a).cross(c - a).norm();
    return area > 0.0 ? (b - a).norm() * (c - b).norm() * (a - c).norm() / (4.0 * area) : HUGE_VAL;
}

// Cut the best ear off the gap again and again. The gap lies on the right of the loop, so its triangles run against it.
void close_gap(const SurfaceSites& sites, std::vector<int> loop, double largest, double least_facing, Fans& fans) {
    const std::vector<Eigen::Vector3d>& x = sites.position;
    while (loop.size() >= 3) {
        const int n = static_cast<int>(loop.size());
        int best = -1;
        double best_radius = HUGE_VAL;
        for (int i = 0; i < n; ++i) {
            const int a = loop[(i + n - 1) % n], b = loop[i], c = loop[(i + 1) % n];
            const double limit = largest * std::max({sites.spacing[a], sites.spacing[b], sites.spacing[c]});
            const double radius = circumradius(x[a], x[b], x[c]);
            // Flat ears have a large circle, but may close a narrow slit.
            const double size = std::min(radius, 0.7 * (x[a] - x[c]).norm());
            if (size > limit || size >= best_radius || !fans.allowed({c, b, a}, least_facing)) continue;
            best = i;
            best_radius = size;
        }
        if (best < 0) return;
        const int a = loop[(best + n - 1) % n], b = loop[best], c = loop[(best + 1) % n];
        fans.add({c, b, a});
        if (n == 3) return;
        loop.erase(loop.begin() + best);
    }
}

}  // namespace

std::vector<Corners> triangulate(const SurfaceSites& sites, std::vector<SeenTriangle> seen, double largest,
                                 Monitor& monitor) {
    std::stable_sort(seen.begin(), seen.end(), [](const SeenTriangle& a, const SeenTriangle& b) {
        return a.votes != b.votes ? a.votes > b.votes : a.radius < b.radius;
    });
    Fans fans(sites);
    int steps = 0;
    for (const SeenTriangle& t : seen) {
        if (++steps % 2048 == 0) monitor.check();
        if (fans.allowed(t.corner, 0.3)) fans.add(t.corner);
    }
    for (const double least_facing : {0.3, 0.0}) {
        fans.drop_small_fans();
        for (std::vector<int>& loop : boundary_loops(fans, static_cast<int>(sites.position.size()))) {
            monitor.check();
            if (static_cast<int>(loop.size()) <= longest_gap) {
                close_gap(sites, std::move(loop), largest, least_facing, fans);
            }
        }
    }
    fans.drop_small_fans();
    return fans.faces();
}

}  // namespace isograft
