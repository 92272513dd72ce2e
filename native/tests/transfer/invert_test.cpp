// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/invert.h"

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer_maps.h"

namespace isograft {

namespace {

using maps::identity;

const Eigen::VectorXi no_polygons;

}  // namespace

TEST(Invert, GivesTheIdentityForTheIdentity) {
    const shapes::Shape s = shapes::torus(20, 12, 2.0, 0.7);
    const Correspondence inverse = invert(identity(s), {s.vertices, s.faces, no_polygons}, {s.vertices, s.faces});
    EXPECT_EQ(inverse.vertex, identity(s).vertex);
    EXPECT_EQ(inverse.points, s.vertices);
}

TEST(Invert, UndoesARenumbering) {
    const shapes::Shape s = shapes::blob(3);
    const shapes::Renumbered other = shapes::renumbered(s, 4);
    const Correspondence there = maps::to_renumbered(s, other);
    const Correspondence back =
        invert(there, {s.vertices, s.faces, no_polygons}, {other.shape.vertices, other.shape.faces});
    for (int v = 0; v < s.vertices.rows(); ++v) EXPECT_EQ(back.vertex[other.vertex[v]], v);
}

TEST(Invert, LeavesUnmatchedWhatTheSourceDoesNotCover) {
    const shapes::Shape whole = shapes::grid(12, 9, 0.5, 0.5);
    const shapes::Shape part = shapes::cut(whole, [](const Eigen::Vector3d& x) { return x[0] < 3.0; });
    Correspondence map = identity(whole);
    // The part's own vertices only: the others are in no triangle of it.
    const Correspondence inverse = invert(map, {part.vertices, part.faces, no_polygons}, {whole.vertices, whole.faces});
    for (int v = 0; v < whole.vertices.rows(); ++v) {
        EXPECT_EQ(inverse.face[v] >= 0, whole.vertices(v, 0) <= 3.0) << "vertex " << v;
    }
}

TEST(Invert, IsEqualBitForBitForAnyNumberOfThreads) {
    const shapes::Shape s = shapes::sphere(4);
    const shapes::Shape t = shapes::noisy(s, 0.02, 3);
    const Correspondence one = invert(identity(s), {s.vertices, s.faces, no_polygons}, {t.vertices, t.faces}, 1);
    const Correspondence four = invert(identity(s), {s.vertices, s.faces, no_polygons}, {t.vertices, t.faces}, 4);
    EXPECT_EQ(one.face, four.face);
    EXPECT_EQ(one.barycentric, four.barycentric);
}

TEST(Invert, StopsWhenCancelled) {
    const shapes::Shape s = shapes::sphere(2);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(invert(identity(s), {s.vertices, s.faces, no_polygons}, {s.vertices, s.faces}, 1, &monitor),
                 Cancelled);
}

TEST(Invert, RefusesAMapToAPointCloud) {
    const shapes::Shape s = shapes::sphere(1);
    Correspondence cloud = identity(s);
    cloud.face.setConstant(-1);
    EXPECT_THROW(invert(cloud, {s.vertices, s.faces, no_polygons}, {s.vertices, s.faces}), InvalidInput);
}

}  // namespace isograft
