// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geodesic/surface_point.h"
#include "isograft/surface.h"
#include "surface/mesh.h"

namespace isograft::shapes {

/// Arrays as a caller would pass them.
struct Shape {
    Points vertices;
    Triangles faces;
};

/// nx by ny cells of dx by dy in the plane z = 0, corner at the origin, normal +z. Every row is shifted along x by
/// `shear` dy more than the one below: 0 gives right angles, 1.5 obtuse triangles.
Shape grid(int nx, int ny, double dx, double dy, double shear = 0.0);

/// Icosahedron with every triangle cut into 4^levels, on the sphere of `radius` around the origin.
Shape sphere(int levels, double radius = 1.0);

/// Open tube around the z axis from z = 0 to `height`. A polyhedron of `around` flat strips: developable exactly.
Shape cylinder(int around, int along, double radius, double height);

/// Flat sector with the total angle `angle` (< 2 pi), radius 1, rolled up to a cone; vertex 0 is the apex at the
/// origin. Its `around` sectors stay flat, so apex angle and distances are exactly those of the sector.
Shape cone(int around, int along, double angle);

/// Torus around the z axis.
Shape torus(int around, int across, double radius, double tube);

/// A closed bumpy body without any symmetry, about 2 wide.
Shape blob(int levels);
/// The blob of four levels with other bumps on it: nearly isometric.
Shape bumped();

Shape moved(const Shape& shape, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift, double scale = 1.0);
/// A fixed rotation about a skew axis.
Eigen::Matrix3d some_rotation();

/// The same shape with vertices, triangles and the first corners of triangles in another order.
struct Renumbered {
    Shape shape;
    /// Per old vertex the new one; per old triangle the new one.
    std::vector<int> vertex, face;
    /// Per old triangle which of its old corners is the first of the new one.
    std::vector<int> first_corner;
};
Renumbered renumbered(const Shape& shape, std::uint64_t seed);

/// Every coordinate moved by up to `amplitude`, uniformly.
Shape noisy(const Shape& shape, double amplitude, std::uint64_t seed);

/// Both, one after the other; nothing shared.
Shape joined(const Shape& a, const Shape& b);
/// Every triangle with three vertices of its own, as STL has it.
Shape soup(const Shape& shape);
/// All triangles the other way round.
Shape reversed(const Shape& shape);
/// Only the triangles for which keep(centroid) holds; the vertices stay.
template <class Keep>
Shape cut(const Shape& shape, Keep&& keep) {
    Shape result{shape.vertices, Triangles(shape.faces.rows(), 3)};
    Eigen::Index kept = 0;
    for (Eigen::Index f = 0; f < shape.faces.rows(); ++f) {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) centre += shape.vertices.row(shape.faces(f, k)).transpose() / 3.0;
        if (keep(centre)) result.faces.row(kept++) = shape.faces.row(f);
    }
    result.faces.conservativeResize(kept, 3);
    return result;
}

/// The working mesh of a shape that the gate need not repair; fails the test if it did.
TriangleMesh mesh_of(const Shape& shape);

/// The surface point nearest to `x` in space, its weights inside the triangle.
SurfacePoint point_nearest(const TriangleMesh& mesh, const Eigen::Vector3d& x);

/// The surface point that `point` of the old shape's mesh is on the new one's.
SurfacePoint same_point(const Renumbered& renumbered, const SurfacePoint& point);

/// Mean of the values.
double mean(const std::vector<double>& values);

}  // namespace isograft::shapes
