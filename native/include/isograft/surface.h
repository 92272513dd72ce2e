// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace isograft {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct TriangleMesh;

/// A checked surface: the one gate between a caller's arrays and the stages.
///
/// Behind it nothing is checked again. Cheap to copy (the contents are shared and never change).
class Surface {
  public:
    /// Check a triangle mesh, repair what can be repaired, and find its orientation.
    ///
    /// Zero-area and repeated triangles are left out, edges of more than two triangles and vertices of several fans
    /// are split, winding is made consistent within every component, closed components are turned outward by their
    /// signed volume. What was done is told in warnings(), with counts. Results are always indexed by the
    /// caller's own vertices and triangles.
    /// \param vertices #V by 3, any unit. \param faces #F by 3, indices into `vertices`.
    /// \throw InvalidInput if either is empty, a coordinate is not finite, an index is out of range, or no
    /// triangle has an area. \throw ResourceLimit above 2^30 vertices or 2^31 / 3 triangles.
    static Surface from_mesh(Points vertices, Triangles faces);

    /// #V by 3, as given.
    [[nodiscard]] const Points& vertices() const { return vertices_; }
    /// #F by 3, as given.
    [[nodiscard]] const Triangles& faces() const { return faces_; }
    /// What the gate repaired or left out, a sentence each with counts.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// True if some component is open and bulges to neither side, so that its outer side could not be told.
    [[nodiscard]] bool orientation_is_ambiguous() const { return ambiguous_; }
    /// True if every component of some size bounds a volume: nothing seems to be missing.
    [[nodiscard]] bool is_closed() const { return closed_; }
    /// The repaired mesh the stages work on (internal).
    [[nodiscard]] const TriangleMesh& mesh() const { return *mesh_; }
    /// The same surface with its open components turned over (internal: both sides are tried, consensus decides).
    [[nodiscard]] Surface with_open_parts_reversed() const;

  private:
    Points vertices_;
    Triangles faces_;
    std::vector<std::string> warnings_;
    bool ambiguous_ = false;
    bool closed_ = true;
    std::shared_ptr<const TriangleMesh> mesh_;
};

}  // namespace isograft
