// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/piece.h"
#include "isograft/surface.h"
#include "isograft/transfer.h"
#include "transfer/laplacian.h"
#include "transfer/sparse.h"

namespace isograft {

/// Functions on the unknown vertices that vary freely beside what is known and ever more slowly away from it, as
/// solutions of elliptic equations do.
///
/// Vertices within a few edges of a known one are free, and so are all of a hole with few vertices. Beyond, nodes lie
/// half as far from each other as from what is known, and no farther than O(n^0.6) of them would in all large holes;
/// each has the quadratic polynomials of its tangent plane, and smooth weights of twice that radius blend them
/// (partition of unity, Melenk and Babuska 1996). Positions are relaxed for that under the Laplacian, so that they are
/// smooth in its eyes; linear functions of a plane are in the space.
/// Parameters of n unknowns: O(those beside what is known + n^0.6). O(n log n) time, O(n) memory.
class GradedSpace {
  public:
    /// A free vertex has one parameter, a node as many as there are quadratic polynomials in the plane.
    static constexpr int most = 6;
    using Parameters = std::array<double, most>;

    /// \param vertices #V by 3. \param areas #V, as vertex_areas(). \param laplacian #V by #V, as laplacian().
    /// \param hole_sizes Unknowns::hole_sizes(). \param few holes of at most so many vertices are free. \throw
    /// Cancelled
    GradedSpace(const Points& vertices, const Eigen::VectorXd& areas, const RowMatrix& laplacian,
                const Unknowns& unknowns, const std::vector<Eigen::Index>& hole_sizes, Eigen::Index few, Piece piece);

    /// Free vertices and nodes.
    [[nodiscard]] int group_count() const { return static_cast<int>(first_.size()) - 1; }
    /// Where a group's parameters begin; that of group_count() is the number of all.
    [[nodiscard]] int first(int group) const { return first_[group]; }

    /// \param i of the unknowns. Calls visit(group, parameters), of a free vertex with one parameter, groups ascending.
    template <class Visit>
    void each(Eigen::Index i, const Visit& visit) const {
        if (free_[i] >= 0) {
            visit(free_[i], Parameters{1.0});
            return;
        }
        for (std::size_t at = begin_[i]; at < begin_[i + 1]; ++at) {
            const auto [node, weight] = near_[at];
            visit(free_count_ + node, polynomials(node, i, weight));
        }
    }

    /// \param parameters #parameters by k. \return #unknowns by k.
    [[nodiscard]] CornerValues spread(const CornerValues& parameters) const;

    /// The transpose of spread().
    [[nodiscard]] CornerValues gather(const CornerValues& values) const;

  private:
    struct Node {
        Eigen::Vector3d centre;
        // Of length one over the distance of nodes.
        Eigen::Vector3d along;
        Eigen::Vector3d across;
    };

    [[nodiscard]] Parameters polynomials(int node, Eigen::Index i, double weight) const {
        const Node& at = nodes_[node];
        const Eigen::Vector3d offset = relaxed_.row(i).transpose() - at.centre;
        const double s = offset.dot(at.along), t = offset.dot(at.across);
        return {weight, weight * s, weight * t, weight * s * s, weight * s * t, weight * t * t};
    }

    void relax(const Points& vertices, const RowMatrix& laplacian, const Unknowns& unknowns, Monitor& monitor);
    void place_nodes(const RowMatrix& edges, const std::vector<double>& apart, std::vector<char>& is_free, Piece piece);

    // #unknowns by 3.
    Points relaxed_;
    // #unknowns: group of a free vertex, -1 of the others.
    std::vector<int> free_;
    int free_count_ = 0;
    std::vector<Node> nodes_;
    // The nodes that reach a vertex, with their share in it.
    std::vector<std::size_t> begin_;
    std::vector<std::pair<int, double>> near_;
    std::vector<int> first_;
};

}  // namespace isograft
