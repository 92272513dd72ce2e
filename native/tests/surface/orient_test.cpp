// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/orient.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "shapes.h"

namespace isograft {
namespace {

using shapes::Shape;

TEST(Orientation, TurnsMixedWindingToTheLargerPart) {
    Shape shape = shapes::grid(6, 6, 1.0, 1.0);
    for (const Eigen::Index f : {3, 17, 40}) shape.faces.row(f).reverseInPlace();
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "3 triangles were turned over"));
    for (const auto& n : surface.mesh().normal) EXPECT_NEAR(n.z(), 1.0, 1e-15);
    for (int f = 0; f < surface.mesh().face_count(); ++f) {
        EXPECT_EQ(surface.mesh().input_order[f] != 0, f == 3 || f == 17 || f == 40);
    }
    expect_indexed_by_input(surface);
}

TEST(Orientation, LetsTheAreaDecideTheWindingOfAnOpenPartNotTheNumberOfTriangles) {
    Shape shape{Points(6, 3), Triangles(4, 3)};
    shape.vertices << 0, 0, 0, 10, 0, 0, 0, 10, 0, 10, 10, 0, 10.5, 5, 0, 10.5, 2, 0;
    // One large triangle against three small ones beside it.
    shape.faces << 0, 1, 2, 1, 2, 3, 1, 3, 4, 1, 4, 5;
    shape.vertices.row(3) << 9.0, 2.0, 0.0;
    const Surface surface = gate(shape);
    EXPECT_GT(surface.mesh().normal[0].z(), 0.0);
    for (const auto& n : surface.mesh().normal) EXPECT_GT(n.z() * surface.mesh().normal[0].z(), 0.0);
}

TEST(Orientation, TurnsClosedComponentsOutwardWhereverTheyLie) {
    const Shape inside_out = shapes::moved(shapes::reversed(shapes::sphere(2)), shapes::some_rotation(), {50, 60, -70});
    const Surface surface = gate(shapes::joined(shapes::sphere(2), inside_out));
    EXPECT_TRUE(warns(surface, "1 closed component was inside out"));
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    const TriangleMesh& mesh = surface.mesh();
    for (int f = 0; f < mesh.face_count(); ++f) {
        const bool second = mesh.input_face[f] >= 320;
        const Eigen::Vector3d centre = second ? Eigen::Vector3d(50, 60, -70) : Eigen::Vector3d::Zero();
        EXPECT_GT(mesh.normal[f].dot(mesh.position[mesh.face[f][0]] - centre), 0.9);
        EXPECT_EQ(mesh.input_order[f] != 0, second);
    }
    expect_indexed_by_input(surface);
}

TEST(Orientation, SeesBodiesThatShareAnEdgeAsClosed) {
    Shape two{Points(6, 3), Triangles(8, 3)};
    two.vertices << 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, -1, 0, 0, -1, -1, 0;
    two.faces << 0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2, 0, 4, 1, 0, 1, 5, 0, 5, 4, 1, 4, 5;
    const Surface surface = gate(two);
    EXPECT_TRUE(warns(surface, "1 edge of more than two triangles"));
    EXPECT_EQ(surface.mesh().component_count, 2);
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    EXPECT_NEAR(volume(surface.mesh()), 2.0 / 6.0, 1e-12);
}

TEST(Orientation, CutsAMoebiusBandOnceAndCallsItAmbiguous) {
    const int n = 40;
    Shape band{Points(2 * n, 3), Triangles(2 * n, 3)};
    for (int i = 0; i < n; ++i) {
        const double a = 2.0 * M_PI * i / n;
        for (const int side : {0, 1}) {
            const double w = (side - 0.5) * 0.6;
            const double r = 1.0 + w * std::cos(0.5 * a);
            band.vertices.row(2 * i + side) << r * std::cos(a), r * std::sin(a), w * std::sin(0.5 * a);
        }
        const bool last = i == n - 1;
        const int a0 = 2 * i, a1 = 2 * i + 1, b0 = last ? 1 : 2 * i + 2, b1 = last ? 0 : 2 * i + 3;
        band.faces.row(2 * i) << a0, b0, b1;
        band.faces.row(2 * i + 1) << a0, b1, a1;
    }
    const Surface surface = gate(band);
    EXPECT_TRUE(warns(surface, "1 edge was cut because the surface has only one side"));
    EXPECT_TRUE(surface.orientation_is_ambiguous());
    EXPECT_EQ(surface.mesh().component_count, 1);
    expect_manifold(surface.mesh());
}

TEST(Orientation, IsAmbiguousOnlyIfAnOpenPartIsMoreThanATwentieth) {
    const Shape body = shapes::sphere(3);
    const auto with_patch = [&](double size) {
        return gate(shapes::joined(
            body, shapes::moved(shapes::grid(2, 2, size / 2, size / 2), Eigen::Matrix3d::Identity(), {5, 0, 0})));
    };
    const double area = gate(body).mesh().area;
    EXPECT_FALSE(with_patch(std::sqrt(0.045 * area)).orientation_is_ambiguous());
    EXPECT_TRUE(with_patch(std::sqrt(0.06 * area)).orientation_is_ambiguous());
}

TEST(Orientation, ReversesOpenPartsOnlyAndTwiceIsNothing) {
    const Shape sheet = shapes::moved(shapes::grid(8, 8, 0.3, 0.3), Eigen::Matrix3d::Identity(), {5, 0, 0});
    const Surface surface = gate(shapes::joined(shapes::sphere(2), sheet));
    const Surface turned = surface.with_open_parts_reversed();
    const Surface back = turned.with_open_parts_reversed();
    ASSERT_EQ(turned.mesh().face_count(), surface.mesh().face_count());
    for (int f = 0; f < surface.mesh().face_count(); ++f) {
        const bool open = surface.mesh().input_face[f] >= 320;
        EXPECT_EQ(turned.mesh().input_face[f], surface.mesh().input_face[f]);
        EXPECT_NEAR(turned.mesh().normal[f].dot(surface.mesh().normal[f]), open ? -1.0 : 1.0, 1e-12);
        EXPECT_EQ(turned.mesh().input_order[f] != 0, open);
        EXPECT_EQ(back.mesh().face[f], surface.mesh().face[f]);
    }
    EXPECT_EQ(turned.vertices(), surface.vertices());
    EXPECT_EQ(turned.faces(), surface.faces());
    EXPECT_TRUE(turned.orientation_is_ambiguous());
    expect_indexed_by_input(turned);
    EXPECT_EQ(back.mesh().input_vertex, surface.mesh().input_vertex);
}

TEST(Orientation, ReversingKeepsCutEdgesCut) {
    // A sheet with a fin on an inner edge: both sides of the cut stay joined around its ends.
    Shape finned = shapes::grid(4, 4, 1.0, 1.0);
    finned.vertices.conservativeResize(26, 3);
    finned.vertices.row(25) << 2.0, 2.5, 1.0;
    finned.faces.conservativeResize(33, 3);
    finned.faces.row(32) << 12, 17, 25;
    const Surface surface = gate(finned);
    EXPECT_TRUE(warns(surface, "1 edge of more than two triangles"));
    const Surface turned = surface.with_open_parts_reversed();
    const auto open_edges = [](const TriangleMesh& mesh) { return std::count(mesh.twin.begin(), mesh.twin.end(), -1); };
    EXPECT_EQ(open_edges(turned.mesh()), open_edges(surface.mesh()));
    EXPECT_EQ(turned.mesh().vertex_count(), surface.mesh().vertex_count());
    expect_manifold(turned.mesh());
}

TEST(Orientation, IsTheSameAfterRenumbering) {
    Shape shape = shapes::joined(shapes::reversed(shapes::blob(2)), shapes::grid(5, 5, 0.2, 0.2));
    for (const Eigen::Index f : {330, 340}) shape.faces.row(f).reverseInPlace();
    const auto other = shapes::renumbered(shape, 5);
    const Surface a = gate(shape), b = gate(other.shape);
    EXPECT_EQ(a.warnings(), b.warnings());
    EXPECT_EQ(a.mesh().face_count(), b.mesh().face_count());
    EXPECT_EQ(a.orientation_is_ambiguous(), b.orientation_is_ambiguous());
    std::vector<int> where(other.shape.faces.rows());
    for (int f = 0; f < b.mesh().face_count(); ++f) where[b.mesh().input_face[f]] = f;
    for (int f = 0; f < a.mesh().face_count(); ++f) {
        const int g = where[other.face[a.mesh().input_face[f]]];
        EXPECT_NEAR(a.mesh().normal[f].dot(b.mesh().normal[g]), 1.0, 1e-12);
    }
}

}  // namespace
}  // namespace isograft
