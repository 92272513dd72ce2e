// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <complex>
#include <vector>

#include <Eigen/Core>

#include "base/piece.h"
#include "isograft/surface.h"

namespace isograft {

/// A vector in a triangle's own plane: real part along its first edge, imaginary part towards its left side as seen
/// from outside. Products with unit numbers are rotations.
using Complex = std::complex<double>;

/// A triangle as one of its half-edges sees it, which runs from 0 along the real axis. In one place, since paths and
/// windows that go from triangle to triangle ask for little else.
struct HalfedgeView {
    /// The corner that the half-edge does not touch.
    Complex apex;
    /// Of the half-edge.
    double length = 0.0;
    /// Beyond the next half-edge and the one after it: their opposite ones, -1 on the boundary.
    std::array<int, 2> beyond{-1, -1};
};

/// An oriented manifold triangle mesh with everything that the stages need, and after measure_paths() all that walking
/// over it needs.
///
/// Half-edge 3 f + k runs from corner k to corner k + 1 of triangle f. Vertices with several fans are split, so
/// every vertex has one fan; edges of more than two triangles are open.
struct TriangleMesh {
    std::vector<Eigen::Vector3d> position;
    std::vector<std::array<int, 3>> face;
    /// Per half-edge the opposite one, -1 on the boundary.
    std::vector<int> twin;
    /// Per half-edge its unit direction in its triangle's frame; without elements before measure_paths(), since with
    /// the views it would be two fifths of a fine mesh on which nothing walks.
    std::vector<Complex> direction;
    /// Per half-edge; without elements before measure_paths().
    std::vector<HalfedgeView> view;
    /// Per triangle the corners in its frame; the first is 0.
    std::vector<std::array<Complex, 3>> corner;
    /// Per triangle the frame's axes and the outward normal.
    std::vector<Eigen::Vector3d> axis_x, axis_y, normal;
    /// Triangles around vertex v: vertex_face[vertex_face_begin[v] .. vertex_face_begin[v + 1]).
    std::vector<int> vertex_face_begin, vertex_face;
    /// Per vertex a third of its triangles' areas.
    std::vector<double> vertex_area;
    std::vector<Eigen::Vector3d> vertex_normal;
    std::vector<char> on_boundary;
    /// Per triangle the connected component it is in, numbered by falling area.
    std::vector<int> component;
    int component_count = 0;
    double area = 0.0;
    double mean_edge = 0.0;

    /// Per vertex, per triangle: the input's index; -1 for what closes a hole.
    std::vector<int> input_vertex, input_face;
    /// Per triangle how its corners stand to the input's, see input_corner(): the first, plus 3 if they run against it.
    std::vector<char> input_order;

    [[nodiscard]] bool has_paths() const { return !view.empty() || face.empty(); }
    [[nodiscard]] int vertex_count() const { return static_cast<int>(position.size()); }
    [[nodiscard]] int face_count() const { return static_cast<int>(face.size()); }
    /// The input's corner that is corner k of triangle f.
    [[nodiscard]] int input_corner(int f, int k) const {
        const int first = input_order[f] % 3;
        return (input_order[f] < 3 ? first + k : first + 3 - k) % 3;
    }
    [[nodiscard]] int from(int halfedge) const { return face[halfedge / 3][halfedge % 3]; }
    [[nodiscard]] int to(int halfedge) const { return face[halfedge / 3][(halfedge % 3 + 1) % 3]; }
    /// The half-edge as a vector in its triangle's frame.
    [[nodiscard]] Complex edge(int halfedge) const {
        const auto& c = corner[halfedge / 3];
        return c[(halfedge % 3 + 1) % 3] - c[halfedge % 3];
    }
};

/// Connect, split and measure a triangle soup whose triangles have an area and a common winding.
///
/// \param position #V. \param face indices into it. \param input_face, input_order per triangle, passed on.
/// Vertices no triangle uses are dropped; `input_vertex` refers to `position`. O(#F).
/// Without paths. \throw Cancelled if `progress` says so.
TriangleMesh build_mesh(const std::vector<Eigen::Vector3d>& position, const std::vector<std::array<int, 3>>& face,
                        const std::vector<int>& input_face, const std::vector<char>& input_order, Piece progress);

/// The same, of small meshes.
TriangleMesh build_mesh(const std::vector<Eigen::Vector3d>& position, const std::vector<std::array<int, 3>>& face,
                        const std::vector<int>& input_face, const std::vector<char>& input_order);

/// Let traces and windows walk over the mesh; nothing if they can already. O(#F).
/// \throw Cancelled if `monitor` asks for it: the mesh is then as it was.
void measure_paths(TriangleMesh& mesh, Monitor& monitor);

/// The same mesh with its vertices in other places, in which every triangle has an area. Without paths.
/// \param position per vertex. \throw Cancelled if `monitor` asks for it.
TriangleMesh with_positions(const TriangleMesh& mesh, std::vector<Eigen::Vector3d> position, Monitor& monitor);

/// with_positions(), in an order that hangs on these places alone, whatever the numbering was: vertices along the last
/// coordinate, triangles by their corners, each from its first vertex on. Vertices in one place stand in the
/// order of their lowest triangles.
/// \param position as above. O(#V log #V). \throw Cancelled if `monitor` asks for it.
TriangleMesh in_order_of_place(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& position,
                               Monitor& monitor);

/// An order of corners turned round: corners 1 and 2 of a triangle change places.
constexpr char reversed_order(char order) { return static_cast<char>((order + 3) % 6); }

/// The same mesh with all lengths multiplied by `factor`; with paths if it has them.
TriangleMesh scaled(const TriangleMesh& mesh, double factor);

}  // namespace isograft
