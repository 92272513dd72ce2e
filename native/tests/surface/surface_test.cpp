// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/surface.h"

#include <complex>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/complex.h"
#include "base/parallel.h"
#include "gate.h"
#include "isograft/errors.h"
#include "shapes.h"
#include "surface/clean.h"
#include "surface/edges.h"
#include "surface/mesh.h"

namespace isograft {
namespace {

using shapes::Shape;

TEST(Surface, LeavesACleanMeshAsItIs) {
    const Shape shape = shapes::blob(2);
    const Surface surface = gate(shape);
    EXPECT_TRUE(surface.warnings().empty());
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    EXPECT_EQ(surface.vertices(), shape.vertices);
    EXPECT_EQ(surface.faces(), shape.faces);
    EXPECT_EQ(surface.mesh().vertex_count(), shape.vertices.rows());
    EXPECT_EQ(surface.mesh().face_count(), shape.faces.rows());
    EXPECT_EQ(surface.mesh().component_count, 1);
    expect_manifold(surface.mesh());
    expect_indexed_by_input(surface);
}

TEST(Surface, SharesItsContentsWithItsCopies) {
    const Surface surface = gate(shapes::blob(2));
    const std::vector<Surface> copies(2, surface);
    EXPECT_EQ(copies[1].vertices().data(), surface.vertices().data());
    EXPECT_EQ(copies[1].faces().data(), surface.faces().data());
    EXPECT_EQ(&copies[1].mesh(), &surface.mesh());
    EXPECT_EQ(&copies[1].mesh_with_paths(), &surface.mesh_with_paths());
}

TEST(Surface, SharesTheContentsOfACloudToo) {
    const Surface cloud = Surface::from_points(shapes::sphere(3).vertices);
    const std::vector<Surface> copies(2, cloud);
    EXPECT_EQ(copies[1].vertices().data(), cloud.vertices().data());
    EXPECT_EQ(copies[1].normals().data(), cloud.normals().data());
    EXPECT_EQ(&copies[1].cloud_vertex(), &cloud.cloud_vertex());
    EXPECT_EQ(cloud.faces().rows(), 0);
}

TEST(Surface, MeasuresPathsOnlyWhereTheyAreAskedFor) {
    const Surface surface = gate(shapes::blob(2));
    EXPECT_FALSE(surface.mesh().has_paths());
    const TriangleMesh& mesh = surface.mesh_with_paths();
    EXPECT_FALSE(surface.mesh().has_paths());
    ASSERT_TRUE(mesh.has_paths());
    EXPECT_EQ(mesh.position, surface.mesh().position);
    ASSERT_EQ(mesh.view.size(), mesh.twin.size());
    ASSERT_EQ(mesh.direction.size(), mesh.twin.size());
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        const HalfedgeView& view = mesh.view[h];
        EXPECT_NEAR(view.length, (mesh.position[mesh.to(h)] - mesh.position[mesh.from(h)]).norm(), 1e-14);
        EXPECT_NEAR(std::abs(view.length * mesh.direction[h] - mesh.edge(h)), 0.0, 1e-14);
        EXPECT_NEAR(0.5 * view.length * view.apex.imag(), 0.5 * cross(mesh.corner[h / 3][1], mesh.corner[h / 3][2]),
                    1e-14);
        EXPECT_EQ(view.beyond[0], mesh.twin[following(h)]);
        EXPECT_EQ(view.beyond[1], mesh.twin[following(following(h))]);
    }
    // A surface with another mesh has other paths.
    Monitor monitor;
    const Surface moved = surface.in_own_frame(monitor);
    EXPECT_EQ(moved.mesh_with_paths().position, moved.mesh().position);
    EXPECT_NE(moved.mesh_with_paths().position, mesh.position);
}

TEST(Surface, StopsMeasuringPathsAndCanMeasureThemLater) {
    TriangleMesh mesh = gate(shapes::blob(2)).mesh();
    Monitor stopped;
    stopped.cancel();
    EXPECT_THROW(measure_paths(mesh, stopped), Cancelled);
    EXPECT_FALSE(mesh.has_paths());
    Monitor monitor;
    measure_paths(mesh, monitor);
    EXPECT_TRUE(mesh.has_paths());
    const std::vector<Complex> directions = mesh.direction;
    measure_paths(mesh, stopped);
    EXPECT_EQ(mesh.direction, directions);
}

TEST(Surface, MeasuresPathsOnceForAllThreads) {
    const Surface surface = gate(shapes::blob(4));
    std::vector<const TriangleMesh*> seen(64);
    Monitor monitor;
    parallel_for(64, 8, [&](int i, int /*worker*/) { seen[i] = &surface.mesh_with_paths(); }, monitor);
    for (const TriangleMesh* mesh : seen) EXPECT_EQ(mesh, &surface.mesh_with_paths());
    EXPECT_TRUE(seen.front()->has_paths());
}

TEST(Surface, RefusesNothing) {
    const Shape shape = shapes::grid(1, 1, 1.0, 1.0);
    EXPECT_NE(refusal({Points(0, 3), shape.faces}).find("`vertices` is empty"), std::string::npos);
    EXPECT_NE(refusal({shape.vertices, Triangles(0, 3)}).find("`faces` is empty"), std::string::npos);
}

TEST(Surface, RefusesCoordinatesThatAreNotFiniteAndNamesTheFirstRowAndTheCount) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
        Shape shape = shapes::sphere(1);
        shape.vertices(17, 2) = shape.vertices(9, 0) = shape.vertices(9, 1) = bad;
        const std::string text = refusal(shape);
        EXPECT_NE(text.find("2 rows"), std::string::npos) << text;
        EXPECT_NE(text.find("row 9"), std::string::npos) << text;
    }
}

TEST(Surface, RefusesIndicesOutOfRangeAndNamesTheFirstTriangleAndTheCount) {
    for (const int bad : {-1, 42, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
        Shape shape = shapes::sphere(1);
        ASSERT_EQ(shape.vertices.rows(), 42);
        shape.faces(30, 0) = shape.faces(11, 2) = shape.faces(12, 1) = bad;
        const std::string text = refusal(shape);
        EXPECT_NE(text.find("3 triangles"), std::string::npos) << text;
        EXPECT_NE(text.find("triangle 11"), std::string::npos) << text;
        EXPECT_NE(text.find("0 to 41"), std::string::npos) << text;
    }
}

TEST(Surface, RefusesAMeshWithoutAnyArea) {
    Shape line = shapes::grid(3, 3, 1.0, 1.0);
    line.vertices.col(1).setZero();
    EXPECT_NE(refusal(line).find("none of the 18 triangles"), std::string::npos) << refusal(line);
    Shape point = line;
    point.vertices.setConstant(4.0);
    EXPECT_NE(refusal(point).find("has an area"), std::string::npos);
}

TEST(Surface, RefusesExtentsWhoseAreasDoubleCannotHold) {
    for (const double scale : {1e-160, 1e160, 1e-310}) {
        const Shape shape = shapes::moved(shapes::sphere(1), Eigen::Matrix3d::Identity(), {0, 0, 0}, scale);
        EXPECT_NE(refusal(shape).find("extent"), std::string::npos) << scale << refusal(shape);
    }
    Shape huge = shapes::sphere(1);
    huge.vertices(0, 0) = 1e308;
    huge.vertices(1, 0) = -1e308;
    EXPECT_NE(refusal(huge).find("extent"), std::string::npos);
}

TEST(Surface, RefusesMoreThanItsIndicesHold) {
    EXPECT_NO_THROW(check_size(Eigen::Index{1} << 30, 715827882));
    EXPECT_THROW(check_size((Eigen::Index{1} << 30) + 1, 1), ResourceLimit);
    EXPECT_THROW(check_size(3, Eigen::Index{1} << 30), ResourceLimit);
}

TEST(Surface, RepairsAlikeAtAnyScaleAndFarFromTheOrigin) {
    Shape shape = shapes::reversed(shapes::soup(shapes::blob(2)));
    shape.faces.row(5) << 3, 3, 9;
    const auto expected = gate(shape).warnings();
    for (const double scale : {1e-20, 1e-6, 1e20}) {
        const Surface surface = gate(shapes::moved(shape, Eigen::Matrix3d::Identity(), {0, 0, 0}, scale));
        EXPECT_EQ(surface.warnings(), expected) << scale;
        EXPECT_EQ(surface.mesh().face_count(), gate(shape).mesh().face_count());
    }
    const Surface far = gate(shapes::moved(shape, Eigen::Matrix3d::Identity(), {2e6, -1e6, 3e6}));
    EXPECT_EQ(far.warnings(), expected);
}

TEST(Surface, LeavesOutTrianglesThatRepeatACornerAndCountsThem) {
    Shape shape = shapes::sphere(2);
    const Eigen::Index n = shape.faces.rows();
    shape.faces.conservativeResize(n + 3, 3);
    shape.faces.row(n) << 4, 4, 9;
    shape.faces.row(n + 1) << 7, 8, 7;
    shape.faces.row(n + 2) << 1, 1, 1;
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "3 triangles were left out because a corner is repeated"));
    EXPECT_EQ(surface.mesh().face_count(), n);
    EXPECT_EQ(surface.mesh().input_face.back(), n - 1);
    EXPECT_EQ(surface.warnings().size(), 1U);
}

TEST(Surface, LeavesOutTrianglesDrawnTwiceInEitherWindingAndCountsThem) {
    Shape shape = shapes::sphere(2);
    const Eigen::Index n = shape.faces.rows();
    shape.faces.conservativeResize(n + 2, 3);
    shape.faces.row(n) << shape.faces(10, 1), shape.faces(10, 2), shape.faces(10, 0);
    shape.faces.row(n + 1) << shape.faces(20, 0), shape.faces(20, 2), shape.faces(20, 1);
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "2 triangles were left out because they repeat others"));
    EXPECT_EQ(surface.mesh().face_count(), n);
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    EXPECT_NEAR(volume(surface.mesh()), volume(gate(shapes::sphere(2)).mesh()), 1e-12);
}

TEST(Surface, LeavesOutATriangleDrawnTwiceInASoup) {
    const Shape body = shapes::sphere(2);
    Shape twice = body;
    twice.faces.conservativeResize(body.faces.rows() + 1, 3);
    twice.faces.bottomRows(1) = body.faces.row(33);
    const Surface surface = gate(shapes::soup(twice));
    EXPECT_TRUE(warns(surface, "1 triangle was left out because it repeats another"));
    EXPECT_EQ(surface.mesh().vertex_count(), body.vertices.rows());
    EXPECT_EQ(surface.mesh().component_count, 1);
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    EXPECT_EQ(working_vertices(surface).back(), working_vertices(surface)[3 * 33 + 2]);
}

TEST(Surface, KeepsTheWallsOfTwoBodiesThatTouch) {
    // Two cubes of 12 triangles with one wall in common, each with vertices of its own.
    Shape cube{Points(8, 3), Triangles(12, 3)};
    cube.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1;
    cube.faces << 0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 2, 3, 7, 2, 7, 6, 1, 2, 6, 1, 6, 5, 3, 0, 7, 0,
        4, 7;
    const Shape mirrored = shapes::reversed({cube.vertices * Eigen::Vector3d(-1.0, 1.0, 1.0).asDiagonal(), cube.faces});
    const Surface surface = gate(shapes::joined(cube, mirrored));
    EXPECT_TRUE(surface.warnings().empty()) << surface.warnings().front();
    EXPECT_EQ(surface.mesh().face_count(), 24);
    EXPECT_EQ(surface.mesh().component_count, 2);
    EXPECT_FALSE(surface.orientation_is_ambiguous());
}

TEST(Surface, LeavesOutTrianglesWithoutAreaButKeepsSlivers) {
    Shape shape = shapes::grid(4, 4, 1.0, 1.0);
    shape.vertices.conservativeResize(27, 3);
    shape.vertices.row(25) << 0.5, 0.0, 0.0;
    shape.vertices.row(26) << 0.5, -1e-8, 0.0;
    shape.faces.conservativeResize(34, 3);
    shape.faces.row(32) << 0, 25, 1;
    shape.faces.row(33) << 0, 26, 1;
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "1 triangle was left out because it has no area"));
    EXPECT_EQ(surface.mesh().face_count(), 33);
    EXPECT_EQ(surface.mesh().input_face.back(), 33);
}

TEST(Surface, ClosesTheGapThatANeedleWithAnEdgeOfNoLengthLeaves) {
    // Vertex 12 of a grid doubled: the triangles on one side use the copy, two needles lie between.
    Shape shape = shapes::grid(4, 4, 1.0, 1.0);
    shape.vertices.conservativeResize(26, 3);
    shape.vertices.row(25) = shape.vertices.row(12);
    int turned = 0;
    for (Eigen::Index f = 0; f < shape.faces.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            if (shape.faces(f, k) != 12 || f >= 16) continue;
            shape.faces(f, k) = 25;
            ++turned;
        }
    }
    ASSERT_EQ(turned, 3);
    shape.faces.conservativeResize(34, 3);
    shape.faces.row(32) << 11, 25, 12;
    shape.faces.row(33) << 12, 25, 13;
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "2 triangles were left out because they have no area"));
    EXPECT_TRUE(warns(surface, "1 vertex was welded"));
    EXPECT_EQ(surface.mesh().vertex_count(), 25);
    EXPECT_EQ(surface.mesh().on_boundary[working_vertices(surface)[12]], 0);
    EXPECT_EQ(working_vertices(surface)[12], working_vertices(surface)[25]);
}

TEST(Surface, CountsVerticesWithoutTrianglesAndGivesThemNoPlace) {
    Shape shape = shapes::sphere(1);
    shape.vertices.conservativeResize(44, 3);
    shape.vertices.bottomRows(2).setConstant(100.0);
    const Surface surface = gate(shape);
    EXPECT_TRUE(warns(surface, "2 vertices belong to no triangle"));
    EXPECT_EQ(surface.mesh().vertex_count(), 42);
    EXPECT_EQ(surface.vertices().rows(), 44);
    EXPECT_EQ(working_vertices(surface)[42], -1);
    EXPECT_EQ(working_vertices(surface)[43], -1);
    expect_indexed_by_input(surface);
}

TEST(Surface, WeldsASoupIntoTheMeshItWasCutFrom) {
    const Shape body = shapes::blob(2);
    const Surface surface = gate(shapes::soup(body));
    EXPECT_EQ(surface.mesh().vertex_count(), body.vertices.rows());
    EXPECT_EQ(surface.mesh().component_count, 1);
    EXPECT_FALSE(surface.orientation_is_ambiguous());
    EXPECT_TRUE(warns(surface, std::to_string(3 * body.faces.rows() - body.vertices.rows()) + " vertices were welded"));
    for (const char boundary : surface.mesh().on_boundary) EXPECT_EQ(boundary, 0);
    expect_manifold(surface.mesh());
    expect_indexed_by_input(surface);
}

TEST(Surface, WeldsASeam) {
    // A tube whose last strip ends in vertices of its own, as texture seams are often exported.
    Shape tube = shapes::cylinder(12, 6, 1.0, 2.0);
    const Eigen::Index n = tube.vertices.rows();
    tube.vertices.conservativeResize(n + 7, 3);
    for (int j = 0; j <= 6; ++j) tube.vertices.row(n + j) = tube.vertices.row(12 * j);
    for (Eigen::Index f = 0; f < tube.faces.rows(); ++f) {
        if (f % 24 < 22) continue;
        for (int k = 0; k < 3; ++k) {
            if (tube.faces(f, k) % 12 == 0) tube.faces(f, k) = static_cast<int>(n) + tube.faces(f, k) / 12;
        }
    }
    const Surface surface = gate(tube);
    EXPECT_TRUE(warns(surface, "7 vertices were welded"));
    EXPECT_EQ(surface.mesh().vertex_count(), n);
    expect_indexed_by_input(surface);
}

TEST(Surface, DoesNotWeldSheetsThatTouchInAPoint) {
    const Shape sheet = shapes::grid(3, 3, 1.0, 1.0);
    const Shape other = shapes::moved(sheet, Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).matrix(), {0, 0, 0});
    Shape both = shapes::joined(sheet, other);
    both.vertices.row(16) = both.vertices.row(0);
    const Surface surface = gate(both);
    EXPECT_TRUE(surface.warnings().empty());
    EXPECT_EQ(surface.mesh().component_count, 2);
    EXPECT_EQ(surface.mesh().vertex_count(), 32);
}

TEST(Surface, CutsEdgesOfMoreThanTwoTrianglesOpen) {
    // Three pages on one spine.
    Shape pages{Points(5, 3), Triangles(3, 3)};
    pages.vertices << 0, 0, 0, 0, 0, 1, 1, 0, 0, -1, 1, 0, -1, -1, 0;
    pages.faces << 0, 1, 2, 0, 1, 3, 0, 1, 4;
    const Surface surface = gate(pages);
    EXPECT_TRUE(warns(surface, "1 edge of more than two triangles was cut open"));
    EXPECT_TRUE(warns(surface, "2 vertices were split"));
    EXPECT_EQ(surface.mesh().component_count, 3);
    EXPECT_EQ(surface.mesh().vertex_count(), 9);
    expect_manifold(surface.mesh());
    expect_indexed_by_input(surface);
}

TEST(Surface, SplitsVerticesOfSeveralFans) {
    Shape bow{Points(5, 3), Triangles(2, 3)};
    bow.vertices << 0, 0, 0, 1, 0, 0, 1, 1, 0, -1, 0, 0, -1, -1, 0;
    bow.faces << 0, 1, 2, 0, 3, 4;
    const Surface surface = gate(bow);
    EXPECT_TRUE(warns(surface, "1 vertex was split where the surface touches itself"));
    EXPECT_EQ(surface.mesh().vertex_count(), 6);
    EXPECT_EQ(surface.mesh().component_count, 2);
    expect_manifold(surface.mesh());
}

}  // namespace
}  // namespace isograft
