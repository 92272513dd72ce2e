// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/local_delaunay.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "base/complex.h"

namespace isograft {

namespace {

constexpr int most_neighbours = 48;
// A step along the surface: rise over length at either end, and the cosine between the normals.
constexpr double steepest = 0.55;
constexpr double least_alike = 0.4;

struct Seen {
    int site;
    Complex planar;
};

// The convex cell of points nearer to the origin than to any neighbour; edge i runs from corner i to corner i + 1 and
// lies halfway to edge_of[i], -1 for the frame.
struct Cell {
    std::vector<Complex> corner;
    std::vector<int> edge_of;

    explicit Cell(double half) : corner{{-half, -half}, {half, -half}, {half, half}, {-half, half}}, edge_of(4, -1) {}

    void cut(Complex towards, int site) {
        const double limit = 0.5 * std::norm(towards);
        const int n = static_cast<int>(corner.size());
        std::vector<Complex> kept;
        std::vector<int> kept_of;
        for (int i = 0; i < n; ++i) {
            const Complex a = corner[i], b = corner[(i + 1) % n];
            const double over_a = dot(a, towards) - limit, over_b = dot(b, towards) - limit;
            if (over_a <= 0.0) {
                kept.push_back(a);
                kept_of.push_back(edge_of[i]);
                if (over_b > 0.0) {
                    kept.push_back(a + over_a / (over_a - over_b) * (b - a));
                    kept_of.push_back(site);
                }
            } else if (over_b <= 0.0) {
                kept.push_back(a + over_a / (over_a - over_b) * (b - a));
                kept_of.push_back(edge_of[i]);
            }
        }
        corner = std::move(kept);
        edge_of = std::move(kept_of);
    }
};

class Surroundings {
  public:
    Surroundings(const SurfaceSites& sites, const KdTree& tree) : sites_(&sites), tree_(&tree) {}

    /// Neighbours of `centre` along the surface, laid flat about it with their distances kept; nearest first.
    const std::vector<Seen>& of(int centre, double radius) {
        const Eigen::Vector3d& x = sites_->position[centre];
        const Eigen::Vector3d& n = sites_->normal[centre];
        tree_->within(x, radius, found_);
        if (found_.size() > most_neighbours) found_.resize(most_neighbours);
        find_reachable(centre, radius);
        const Eigen::Vector3d axis_x = n.unitOrthogonal(), axis_y = n.cross(axis_x);
        seen_.clear();
        for (std::size_t i = 0; i < found_.size(); ++i) {
            if (!reached_[i] || found_[i].index == centre) continue;
            const Eigen::Vector3d d = sites_->position[found_[i].index] - x;
            const Complex flat(d.dot(axis_x), d.dot(axis_y));
            const double length = std::abs(flat);
            if (length < 0.3 * d.norm() || length <= 0.0) continue;
            seen_.push_back({found_[i].index, flat * (d.norm() / length)});
        }
        return seen_;
    }

    /// The place in space of a point of the plane about `centre`.
    [[nodiscard]] Eigen::Vector3d lift(int centre, Complex planar) const {
        const Eigen::Vector3d& n = sites_->normal[centre];
        const Eigen::Vector3d axis_x = n.unitOrthogonal();
        return sites_->position[centre] + planar.real() * axis_x + planar.imag() * n.cross(axis_x);
    }

  private:
    [[nodiscard]] bool step(int a, int b) const {
        const Eigen::Vector3d d = sites_->position[b] - sites_->position[a];
        const double rise = steepest * d.norm();
        return sites_->normal[a].dot(sites_->normal[b]) > least_alike && std::abs(d.dot(sites_->normal[a])) < rise &&
               std::abs(d.dot(sites_->normal[b])) < rise;
    }

    void find_reachable(int centre, double radius) {
        reached_.assign(found_.size(), 0);
        queue_.clear();
        for (std::size_t i = 0; i < found_.size(); ++i) {
            if (found_[i].index != centre) continue;
            reached_[i] = 1;
            queue_.push_back(i);
        }
        const Eigen::Vector3d& n = sites_->normal[centre];
        for (std::size_t q = 0; q < queue_.size(); ++q) {
            const int a = found_[queue_[q]].index;
            // Two spacings bridge what is sparse, and no more than that is one step.
            const double longest = std::min(2.2 * sites_->spacing[a], radius);
            for (std::size_t i = 0; i < found_.size(); ++i) {
                const int b = found_[i].index;
                if (reached_[i] || n.dot(sites_->normal[b]) < 0.2) continue;
                if ((sites_->position[a] - sites_->position[b]).squaredNorm() > longest * longest || !step(a, b))
                    continue;
                reached_[i] = 1;
                queue_.push_back(i);
            }
        }
    }

    const SurfaceSites* sites_;
    const KdTree* tree_;
    std::vector<KdTree::Found> found_;
    std::vector<char> reached_;
    std::vector<std::size_t> queue_;
    std::vector<Seen> seen_;
};

SeenTriangle seen_triangle(int a, int b, int c, double radius, const Eigen::Vector3d& centre) {
    SeenTriangle t{{a, b, c}, 1, radius, centre};
    std::rotate(t.corner.begin(), std::min_element(t.corner.begin(), t.corner.end()), t.corner.end());
    return t;
}

}  // namespace

std::vector<SeenTriangle> local_delaunay(const SurfaceSites& sites, const KdTree& tree, double reach, double largest,
                                         Monitor& monitor) {
    std::vector<SeenTriangle> all;
    Surroundings surroundings(sites, tree);
    const int count = static_cast<int>(sites.position.size());
    for (int i = 0; i < count; ++i) {
        if (i % 512 == 0) monitor.check();
        const double spacing = sites.spacing[i];
        Cell cell(2.0 * reach * spacing);
        for (const Seen& s : surroundings.of(i, reach * spacing)) cell.cut(s.planar, s.site);
        const int n = static_cast<int>(cell.corner.size());
        for (int k = 0; k < n; ++k) {
            const int b = cell.edge_of[(k + n - 1) % n], c = cell.edge_of[k];
            const double radius = std::abs(cell.corner[k]);
            if (b < 0 || c < 0 || b == c || radius > largest * spacing) continue;
            all.push_back(seen_triangle(i, b, c, radius, surroundings.lift(i, cell.corner[k])));
        }
    }
    std::sort(all.begin(), all.end(), [](const SeenTriangle& s, const SeenTriangle& t) {
        return s.corner != t.corner ? s.corner < t.corner : s.radius < t.radius;
    });
    std::vector<SeenTriangle> merged;
    for (const SeenTriangle& t : all) {
        if (merged.empty() || merged.back().corner != t.corner) {
            merged.push_back(t);
        } else {
            ++merged.back().votes;
            merged.back().radius = t.radius;
            merged.back().centre = t.centre;
        }
    }
    return merged;
}

}  // namespace isograft
