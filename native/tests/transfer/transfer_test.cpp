// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/transfer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "isograft/errors.h"
#include "transfer/closest.h"
#include "transfer/seams.h"

namespace isograft {

namespace {

using Eigen::Vector3d;

// A tube of radius 1 and height `rows`, its UVs cut open along a line: u runs from 0 to 1 around it.
struct Tube {
    Points vertices;
    Triangles faces;
    CornerUV uv;
};

Tube tube(int rows, int columns) {
    Tube t{Points((rows + 1) * columns, 3), Triangles(2 * rows * columns, 3), CornerUV(6 * rows * columns, 2)};
    for (int v = 0; v < t.vertices.rows(); ++v) {
        const double angle = 2.0 * M_PI * (v % columns) / columns;
        t.vertices.row(v) << std::cos(angle), std::sin(angle), v / columns;
    }
    const int shape[2][3][2] = {{{0, 0}, {0, 1}, {1, 1}}, {{0, 0}, {1, 1}, {1, 0}}};
    for (int f = 0; f < t.faces.rows(); ++f) {
        const int row = f / 2 / columns, column = f / 2 % columns;
        for (int c = 0; c < 3; ++c) {
            const int i = row + shape[f % 2][c][0], j = column + shape[f % 2][c][1];
            t.faces(f, c) = i * columns + j % columns;
            t.uv.row(3 * f + c) << j / double(columns), i / double(rows);
        }
    }
    return t;
}

Correspondence identity(const Tube& t) {
    Correspondence map;
    map.face = Eigen::VectorXi::Constant(t.vertices.rows(), -1);
    map.barycentric = Points::Constant(t.vertices.rows(), 3, std::numeric_limits<double>::quiet_NaN());
    map.vertex = Eigen::VectorXi::LinSpaced(t.vertices.rows(), 0, static_cast<int>(t.vertices.rows()) - 1);
    for (int f = 0; f < t.faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) {
            map.face[t.faces(f, c)] = f;
            map.barycentric.row(t.faces(f, c)) = Eigen::Matrix3d::Identity().row(c);
        }
    }
    return map;
}

const Eigen::VectorXi no_polygons;

}  // namespace

TEST(ClosestWeights, AreNoFartherThanAnyPointOfTheTriangle) {
    Random random(5);
    const auto point = [&] { return Vector3d(random.uniform(), random.uniform(), random.uniform()); };
    for (int trial = 0; trial < 300; ++trial) {
        const Vector3d a = point(), b = trial % 3 == 0 ? Vector3d(0.5 * (a + point())) : point();
        const Vector3d c = trial % 5 == 0 ? Vector3d(a + 0.3 * (b - a)) : point();
        const Vector3d p = 3.0 * point() - Vector3d::Ones();
        const Vector3d w = closest_weights(p, a, b, c);
        ASSERT_GE(w.minCoeff(), 0.0);
        ASSERT_NEAR(w.sum(), 1.0, 1e-12);
        const double distance = (w[0] * a + w[1] * b + w[2] * c - p).norm();
        for (int i = 0; i <= 20; ++i) {
            for (int j = 0; i + j <= 20; ++j) {
                const Vector3d other = a + i / 20.0 * (b - a) + j / 20.0 * (c - a);
                ASSERT_LE(distance, (other - p).norm() + 1e-9);
            }
        }
    }
}

TEST(UvIslands, JoinAcrossNonManifoldEdgesOnlyWhereTheValuesAgree) {
    Triangles faces(4, 3);
    faces << 0, 1, 2, 1, 0, 3, 0, 1, 4, 1, 0, 5;
    CornerValues values(12, 1);
    // The third and the fourth triangle carry another value at vertex 1.
    values << 1, 2, 0, 2, 1, 0, 1, 7, 0, 7, 1, 0;
    const Eigen::VectorXi island = uv_islands(faces, values);
    EXPECT_EQ(island, Eigen::Vector4i(0, 0, 1, 1));
}

TEST(UvIslands, OfAMeshSplitAtItsSeamsJoinOnceVerticesAreWelded) {
    Points vertices(6, 3);
    vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
    Triangles faces(2, 3);
    faces << 0, 1, 2, 3, 4, 5;
    const CornerValues values = vertices(faces.reshaped<Eigen::RowMajor>(), Eigen::all);
    EXPECT_EQ(uv_islands(faces, values).maxCoeff(), 1);
    EXPECT_EQ(uv_islands(faces, values, 1e-6, vertices).maxCoeff(), 0);
}

TEST(UvIslands, TellHowFarTheyAreAndStopWhenCancelled) {
    const Tube t = tube(6, 10);
    std::vector<double> told;
    Monitor listening([&](const std::string&, double fraction) {
        told.push_back(fraction);
        return true;
    });
    EXPECT_EQ(uv_islands(t.faces, t.uv, 1e-6, t.vertices, &listening), uv_islands(t.faces, t.uv, 1e-6, t.vertices));
    ASSERT_GE(told.size(), 3U);
    EXPECT_EQ(told.front(), 0.0);
    EXPECT_EQ(told.back(), 1.0);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    Monitor refusing([](const std::string&, double fraction) { return fraction == 0.0; });
    EXPECT_THROW(uv_islands(t.faces, t.uv, 1e-6, t.vertices, &refusing), Cancelled);
}

TEST(SeamGraph, StopsInEachOfItsPasses) {
    const Tube t = tube(6, 10);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(weld(t.vertices, t.faces, &monitor), Cancelled);
    EXPECT_THROW(build_seam_graph(t.faces, t.uv, 1e-6, &monitor), Cancelled);
    const SeamGraph graph = build_seam_graph(t.faces, t.uv, 1e-6);
    EXPECT_THROW(group_corners(graph, t.faces, [](int, int) { return true; }, &monitor), Cancelled);
}

TEST(TransferCornerUV, ReturnsTheDonorsOwnUvsUnderTheIdentity) {
    const Tube t = tube(6, 10);
    const TransferredUV moved =
        transfer_corner_uv(identity(t), {t.vertices, t.faces, no_polygons}, {t.vertices, t.faces}, t.uv);
    EXPECT_TRUE(moved.mask.all());
    EXPECT_LE((moved.uv - t.uv).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(moved.island.maxCoeff(), 0);
}

TEST(TransferCornerUV, NeverSpansTheCutOfATubeWhoseVerticesMissIt) {
    // The receiver's columns lie half a column beside the donor's, so that a row of its triangles straddles the cut.
    const Tube donor = tube(6, 10);
    Correspondence map = identity(donor);
    for (int v = 0; v < donor.vertices.rows(); ++v) {
        const int row = v / 10, column = v % 10;
        const int beside = row * 10 + (column + 1) % 10;
        for (int f = 0; f < donor.faces.rows(); ++f) {
            Eigen::RowVector3d weights = Eigen::RowVector3d::Zero();
            for (int c = 0; c < 3; ++c) weights[c] = donor.faces(f, c) == v || donor.faces(f, c) == beside ? 0.5 : 0.0;
            if (weights.sum() != 1.0) continue;
            map.face[v] = f;
            map.barycentric.row(v) = weights;
        }
    }
    for (const double extrapolation : {0.0, 1.0}) {
        CornerTransferOptions options;
        options.extrapolation = extrapolation;
        const TransferredUV moved = transfer_corner_uv(map, {donor.vertices, donor.faces, no_polygons},
                                                       {donor.vertices, donor.faces}, donor.uv, options);
        ASSERT_TRUE(moved.mask.all());
        for (int f = 0; f < donor.faces.rows(); ++f) {
            const auto u = moved.uv.col(0).segment(3 * f, 3);
            const double span = u.maxCoeff() - u.minCoeff();
            EXPECT_LE(span, 0.1 + 1e-9) << "triangle " << f;
            EXPECT_GE(span, extrapolation > 0.0 ? 0.1 - 1e-9 : 0.0) << "triangle " << f;
        }
    }
}

TEST(TransferCornerUV, StopsWhenCancelled) {
    const Tube t = tube(6, 10);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(
        transfer_corner_uv(identity(t), {t.vertices, t.faces, no_polygons}, {t.vertices, t.faces}, t.uv, {}, &monitor),
        Cancelled);
}

TEST(TransferCorner, StaysWithinTheDonorsValuesAndGivesAConstantBackExactly) {
    const Tube t = tube(6, 10);
    const CornerValues constant = CornerValues::Constant(t.uv.rows(), 1, 0.1);
    const TransferredValues moved = transfer_corner(identity(t), {t.vertices, t.faces, no_polygons},
                                                    {t.vertices, t.faces}, constant, TransferMode::barycentric);
    EXPECT_EQ(moved.values, constant);
}

TEST(TransferPoint, RefusesACorrespondenceOfAnotherDonor) {
    const Tube t = tube(2, 4);
    Correspondence map = identity(t);
    map.face[3] = static_cast<int>(t.faces.rows());
    EXPECT_THROW(transfer_point(map, t.faces, t.vertices, TransferMode::barycentric), InvalidInput);
}

TEST(TransferPoint, TellsHowFarItIsRowByRow) {
    const Tube t = tube(60, 100);
    Correspondence map = identity(t);
    Monitor whole;
    transfer_point(map, t.faces, t.vertices, TransferMode::barycentric, &whole);
    EXPECT_EQ(whole.fraction(), 1.0);
    // The last vertex is refused when the others are done.
    const Eigen::Index last = t.vertices.rows() - 1;
    map.face[last] = -1;
    map.vertex[last] = static_cast<int>(t.vertices.rows());
    Monitor most;
    EXPECT_THROW(transfer_point(map, t.faces, t.vertices, TransferMode::barycentric, &most), InvalidInput);
    EXPECT_GT(most.fraction(), 0.8);
    EXPECT_LT(most.fraction(), 1.0);
}

TEST(TransferPoint, StopsWhenCancelled) {
    const Tube t = tube(2, 4);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(transfer_point(identity(t), t.faces, t.vertices, TransferMode::nearest, &monitor), Cancelled);
}

}  // namespace isograft
