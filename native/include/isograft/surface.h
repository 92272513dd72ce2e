// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace isograft {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;

struct TriangleMesh;
class Monitor;

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
    /// triangle has an area. \throw ResourceLimit above 2^30 vertices or 2^31 / 3 triangles; Cancelled if `monitor`
    /// asks for it.
    /// \param monitor may be null. \param share of its progress that this is.
    static Surface from_mesh(Points vertices, Triangles faces, Monitor* monitor = nullptr, double share = 1.0);

    /// Check a point cloud and find the surface that its points lie on.
    ///
    /// Outliers are left out, repeated points joined, normals estimated where none are given and turned to one side,
    /// outward where the cloud closes about an inside; even triangles are laid over the smoothed points, with holes
    /// where the cloud has holes. What was done is told in warnings(), with counts. Results are indexed by the caller's
    /// own points. O(n log n).
    /// \param vertices #V by 3, any unit. \param normals #V by 3 of any length, or without rows to have them estimated.
    /// \param monitor may be null. \param share of its progress that this is.
    /// \throw InvalidInput for fewer than 50 different points, a coordinate or normal that is not finite, normals
    /// without length or in another number, or points that show no surface. \throw ResourceLimit above 2^30 points;
    /// Cancelled if `monitor` asks for it.
    static Surface from_points(Points vertices, const Points& normals = Points(0, 3), Monitor* monitor = nullptr,
                               double share = 1.0);

    /// #V by 3, as given.
    [[nodiscard]] const Points& vertices() const { return *vertices_; }
    /// #F by 3, as given; without rows for a point cloud.
    [[nodiscard]] const Triangles& faces() const { return *faces_; }
    /// What the gate repaired or left out, a sentence each with counts.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
    /// True if some component is open and bulges to neither side, so that its outer side could not be told.
    [[nodiscard]] bool orientation_is_ambiguous() const { return ambiguous_; }
    /// True if every component of some size bounds a volume: nothing seems to be missing.
    [[nodiscard]] bool is_closed() const { return closed_; }
    /// A point cloud: results have no triangles of the caller's.
    [[nodiscard]] bool is_cloud() const { return is_cloud_; }
    /// Of a point cloud, #V by 3: unit normals of the smoothed surface, outward; NaN for points left out. Else no rows.
    [[nodiscard]] const Points& normals() const { return *normals_; }
    /// Of a point cloud, per point its nearest vertex of mesh() on its own sheet, -1 if it was left out (internal).
    [[nodiscard]] const std::vector<int>& cloud_vertex() const { return *cloud_vertex_; }
    /// Vertices and triangles of the mesh the stages work on, outward: the repaired one, or the one laid over a cloud.
    [[nodiscard]] std::pair<Points, Triangles> working_mesh() const;
    /// The repaired mesh the stages work on; over a point cloud, one made for it (internal).
    [[nodiscard]] const TriangleMesh& mesh() const { return *mesh_; }
    /// A copy of mesh() with what traces and windows need, made at the first call and kept (internal). From any thread.
    [[nodiscard]] const TriangleMesh& mesh_with_paths() const;
    /// The same surface with its open components turned over (internal: both sides are tried, consensus decides).
    [[nodiscard]] Surface with_open_parts_reversed(Monitor* monitor = nullptr) const;
    /// The same surface with the mesh the stages work on moved to where nobody's moving and turning of the input shows
    /// (internal; see surface/own_frame.h). A cloud stays where it is.
    [[nodiscard]] Surface in_own_frame(Monitor& monitor) const;
    /// The same surface with the small holes of the mesh the stages work on closed (internal; see surface/holes.h). A
    /// cloud's stay.
    [[nodiscard]] Surface with_holes_closed(double longest, Monitor& monitor) const;
    /// The same surface with the mesh the stages work on smoothed (internal; see SurfaceOptions). A cloud's is already.
    [[nodiscard]] Surface denoised(double support, Monitor& monitor) const;

  private:
    struct Paths;

    [[nodiscard]] Surface reversed_cloud() const;
    void set_mesh(TriangleMesh mesh);

    std::shared_ptr<const Points> vertices_ = std::make_shared<Points>(0, 3);
    std::shared_ptr<const Triangles> faces_ = std::make_shared<Triangles>(0, 3);
    std::vector<std::string> warnings_;
    bool ambiguous_ = false;
    bool closed_ = true;
    bool is_cloud_ = false;
    std::shared_ptr<const Points> normals_ = std::make_shared<Points>(0, 3);
    std::shared_ptr<const std::vector<int>> cloud_vertex_ = std::make_shared<std::vector<int>>();
    std::shared_ptr<const TriangleMesh> mesh_;
    std::shared_ptr<Paths> paths_;
};

}  // namespace isograft
