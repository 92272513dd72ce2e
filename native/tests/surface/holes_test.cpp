// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/holes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "gate.h"
#include "geodesic/window.h"
#include "isograft/errors.h"
#include "isograft/monitor.h"
#include "isograft/options/surface.h"
#include "shapes.h"

namespace isograft {
namespace {

TriangleMesh closed(const shapes::Shape& shape, double longest = 0.5) {
    Monitor monitor;
    const Surface surface = gate(shape);
    TriangleMesh mesh = with_holes_closed(surface.mesh(), longest, monitor).value_or(surface.mesh());
    measure_paths(mesh, monitor);
    return mesh;
}

int boundary_edges(const TriangleMesh& mesh) {
    return static_cast<int>(std::count(mesh.twin.begin(), mesh.twin.end(), -1));
}

shapes::Shape sphere_without(double below) {
    return shapes::cut(shapes::sphere(5), [&](const Eigen::Vector3d& x) { return x.z() < below; });
}

shapes::Shape plane_with_a_hole() {
    return shapes::cut(shapes::grid(60, 60, 0.05, 0.05),
                       [](const Eigen::Vector3d& x) { return (x - Eigen::Vector3d(1.5, 1.5, 0.0)).norm() > 0.21; });
}

TEST(Holes, AreClosedAsTheSurfaceRunsOn) {
    // A rim of 0.44 roots of the area: it zigzags.
    const TriangleMesh before = gate(sphere_without(0.983)).mesh(), after = closed(sphere_without(0.983));
    ASSERT_GT(boundary_edges(before), 20);
    EXPECT_EQ(boundary_edges(after), 0);
    expect_manifold(after);
    EXPECT_EQ(after.component_count, 1);
    int added = 0;
    for (int v = 0; v < after.vertex_count(); ++v) {
        if (after.input_vertex[v] >= 0) continue;
        ++added;
        EXPECT_NEAR(after.position[v].norm(), 1.0, 0.004);
    }
    EXPECT_GT(added, 20);
    EXPECT_NEAR(after.area, 4.0 * M_PI, 0.004 * 4.0 * M_PI);
    for (int f = before.face_count(); f < after.face_count(); ++f) {
        EXPECT_EQ(after.input_face[f], -1);
        EXPECT_GT(after.normal[f].dot(after.position[after.face[f][0]]), 0.97);
    }
}

TEST(Holes, KeepWhatIsAroundThem) {
    const TriangleMesh before = gate(sphere_without(0.983)).mesh(), after = closed(sphere_without(0.983));
    ASSERT_GT(after.face_count(), before.face_count());
    for (int f = 0; f < before.face_count(); ++f) {
        ASSERT_EQ(after.input_face[f], before.input_face[f]);
        for (int k = 0; k < 3; ++k) {
            EXPECT_EQ(after.input_corner(f, k), before.input_corner(f, k));
            EXPECT_EQ(after.input_vertex[after.face[f][k]], before.input_vertex[before.face[f][k]]);
            EXPECT_EQ(after.position[after.face[f][k]], before.position[before.face[f][k]]);
        }
    }
}

TEST(Holes, InAPlaneAreClosedInItAndDistancesCrossThem) {
    const TriangleMesh before = gate(plane_with_a_hole()).mesh_with_paths(), after = closed(plane_with_a_hole());
    EXPECT_EQ(boundary_edges(after), 240);
    for (const auto& x : after.position) EXPECT_NEAR(x.z(), 0.0, 1e-9);
    const auto at = [](const TriangleMesh& mesh, double x, double y) {
        int nearest = 0;
        for (int v = 1; v < mesh.vertex_count(); ++v) {
            const Eigen::Vector3d p(x, y, 0.0);
            if ((mesh.position[v] - p).norm() < (mesh.position[nearest] - p).norm()) nearest = v;
        }
        return nearest;
    };
    const auto distance = [&](const TriangleMesh& mesh) {
        Window window(mesh);
        const int from = at(mesh, 1.2, 1.5), to = at(mesh, 1.8, 1.5);
        window.run(point_near_vertex(mesh, from), 2.0);
        return window.distance(to) / (mesh.position[from] - mesh.position[to]).norm();
    };
    EXPECT_GT(distance(before), 1.1);
    EXPECT_NEAR(distance(after), 1.0, 0.002);
}

TEST(Holes, LongerThanAskedForStayOpen) {
    EXPECT_EQ(closed(sphere_without(0.983), 0.35).face, gate(sphere_without(0.983)).mesh().face);
    EXPECT_EQ(closed(sphere_without(0.5)).face, gate(sphere_without(0.5)).mesh().face);
}

TEST(Holes, AreNeitherStumpsNorFoldsNorTheRimOfASheet) {
    const shapes::Shape tube = shapes::cylinder(24, 60, 0.1, 4.0), sheet = shapes::grid(10, 10, 0.1, 0.1);
    // Rolled over itself outwards: at both rims it leads away from the axis.
    const shapes::Shape lip = shapes::cut(shapes::torus(60, 24, 0.3, 0.1), [](const Eigen::Vector3d& x) {
        return x.head<2>().norm() < 0.3 || x.z() < -0.05;
    });
    for (const shapes::Shape& shape : {tube, sheet, lip}) {
        ASSERT_GT(boundary_edges(gate(shape).mesh()), 20);
        EXPECT_EQ(closed(shape, 10.0).face, gate(shape).mesh().face);
    }
}

TEST(Holes, OfOneTriangleAreClosedByOne) {
    shapes::Shape shape = shapes::blob(3);
    const Eigen::Index last = shape.faces.rows() - 1;
    const Eigen::RowVector3i gone = shape.faces.row(last);
    shape.faces.conservativeResize(last, 3);
    const TriangleMesh after = closed(shape);
    ASSERT_EQ(after.face_count(), last + 1);
    EXPECT_EQ(boundary_edges(after), 0);
    EXPECT_EQ(after.vertex_count(), shape.vertices.rows());
    auto corners = after.face[last];
    for (int& v : corners) v = after.input_vertex[v];
    std::rotate(corners.begin(), std::find(corners.begin(), corners.end(), gone[0]), corners.end());
    EXPECT_EQ(corners, (std::array<int, 3>{gone[0], gone[1], gone[2]}));
}

TEST(Holes, WithoutAreaStayOpen) {
    // A vertex on an edge of one of its two triangles: what is missing between them has no area.
    shapes::Shape shape = shapes::grid(8, 8, 0.1, 0.1);
    const Eigen::Index vertex = shape.vertices.rows(), face = shape.faces.rows();
    const Eigen::RowVector3i old = shape.faces.row(60);
    shape.vertices.conservativeResize(vertex + 1, 3);
    shape.vertices.row(vertex) = 0.5 * (shape.vertices.row(old[0]) + shape.vertices.row(old[1]));
    shape.faces.conservativeResize(face + 1, 3);
    shape.faces.row(60) << old[0], static_cast<int>(vertex), old[2];
    shape.faces.row(face) << static_cast<int>(vertex), old[1], old[2];
    const TriangleMesh before = gate(shape).mesh();
    ASSERT_EQ(boundary_edges(before), 32 + 3);
    EXPECT_EQ(closed(shape).face, before.face);
}

TEST(Holes, StopWhenCancelled) {
    Monitor monitor;
    const Surface surface = gate(sphere_without(0.983));
    monitor.cancel();
    EXPECT_THROW(with_holes_closed(surface.mesh(), 0.5, monitor), Cancelled);
}

TEST(Holes, OptionIsRefusedOutOfRange) {
    SurfaceOptions options;
    for (const double wrong : {-0.1, 2.1, std::numeric_limits<double>::quiet_NaN()}) {
        options.close_holes = wrong;
        EXPECT_THROW(options.validate(), InvalidInput);
    }
    options.close_holes = 0.0;
    EXPECT_NO_THROW(options.validate());
}

}  // namespace
}  // namespace isograft
