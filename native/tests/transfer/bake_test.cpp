// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/bake.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "isograft/locate.h"
#include "shapes.h"
#include "transfer/tangents.h"
#include "transfer_maps.h"

namespace isograft {

namespace {

const Eigen::VectorXi no_polygons;
const Mask all_triangles;

// A grid whose UVs are its own x and y, and an image that holds u and v.
struct Scene {
    Scene() : shape(shapes::grid(6, 5, 1.0 / 6, 1.0 / 5)), uv(3 * shape.faces.rows(), 2), texture(2 * 16 * 16) {
        for (int f = 0; f < shape.faces.rows(); ++f) {
            for (int c = 0; c < 3; ++c) uv.row(3 * f + c) = shape.vertices.row(shape.faces(f, c)).head<2>();
        }
        for (int i = 0; i < 16 * 16; ++i) {
            texture[2 * i] = static_cast<float>(i % 16 + 0.5) / 16;
            texture[2 * i + 1] = static_cast<float>(i / 16 + 0.5) / 16;
        }
    }

    std::vector<float> run(const BakeOptions& options, std::vector<std::uint8_t>& mask, Monitor* monitor = nullptr) {
        std::vector<float> result(2 * options.width * options.height, 0.0F);
        mask.assign(options.width * options.height, 7);
        BakeChannel channel;
        channel.components = 2;
        channel.images = {Pixels{nullptr, texture.data(), 16, 16}};
        channel.uv = uv;
        channel.extension = Extension::extend;
        channel.reals = result.data();
        const Correspondence map = maps::identity(shape);
        bake(map, {shape.vertices, shape.faces, no_polygons}, uv, all_triangles, {shape.vertices, shape.faces},
             Eigen::VectorXi::Zero(shape.faces.rows()), {channel}, options, mask.data(), monitor);
        return result;
    }

    shapes::Shape shape;
    CornerUV uv;
    std::vector<float> texture;
};

}  // namespace

TEST(Bake, ReadsEveryTexelAtItsOwnPlaceUnderTheIdentity) {
    Scene scene;
    std::vector<std::uint8_t> mask;
    const std::vector<float> result = scene.run({40, 24, 0, 1}, mask);
    for (int i = 0; i < 40 * 24; ++i) {
        ASSERT_EQ(mask[i], 1);
        EXPECT_NEAR(result[2 * i], std::clamp((i % 40 + 0.5) / 40, 0.5 / 16, 15.5 / 16), 1e-6);
        EXPECT_NEAR(result[2 * i + 1], std::clamp((i / 40 + 0.5) / 24, 0.5 / 16, 15.5 / 16), 1e-6);
    }
}

TEST(Bake, IsEqualBitForBitForAnyNumberOfThreads) {
    Scene scene;
    scene.uv *= 0.7;
    std::vector<std::uint8_t> one_mask, four_mask;
    const std::vector<float> one = scene.run({300, 700, 9, 1}, one_mask);
    EXPECT_EQ(one, scene.run({300, 700, 9, 4}, four_mask));
    EXPECT_EQ(one_mask, four_mask);
}

TEST(Bake, RefusesOptionsAndStopsWhenCancelled) {
    Scene scene;
    std::vector<std::uint8_t> mask;
    EXPECT_THROW(scene.run({0, 8, 0, 1}, mask), InvalidInput);
    EXPECT_THROW(scene.run({8, 8, -1, 1}, mask), InvalidInput);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(scene.run({8, 8, 0, 1}, mask, &monitor), Cancelled);
}

TEST(Locate, FindsThePointOfTheSameWeightsUnderARenumbering) {
    const shapes::Shape s = shapes::blob(2);
    const shapes::Renumbered other = shapes::renumbered(s, 4);
    SurfacePoints points{Eigen::VectorXi::LinSpaced(s.faces.rows(), 0, static_cast<int>(s.faces.rows()) - 1),
                         Points(s.faces.rows(), 3)};
    points.weights.rowwise() = Eigen::RowVector3d(0.5, 0.3, 0.2);
    const SurfacePoints found = locate(maps::to_renumbered(s, other), {s.vertices, s.faces, no_polygons},
                                       {other.shape.vertices, other.shape.faces}, points);
    for (int f = 0; f < s.faces.rows(); ++f) {
        EXPECT_EQ(found.face[f], other.face[f]);
        Eigen::RowVector3d there = Eigen::RowVector3d::Zero(), here = there;
        for (int c = 0; c < 3; ++c) {
            there += found.weights(f, c) * other.shape.vertices.row(other.shape.faces(found.face[f], c));
            here += points.weights(f, c) * s.vertices.row(s.faces(f, c));
        }
        EXPECT_LE((there - here).norm(), 1e-9);
    }
}

TEST(Bake, TellsTheTrianglesInWhichEveryPointIsFound) {
    Scene scene;
    const auto count = scene.shape.faces.rows();
    Correspondence map = maps::identity(scene.shape);
    for (const int v : {0, 9, 20}) map.face[v] = map.vertex[v] = -1;
    const SurfacePoints centres{Eigen::VectorXi::LinSpaced(count, 0, static_cast<int>(count) - 1),
                                Points::Constant(count, 3, 1.0 / 3.0)};
    const SurfacePoints found = locate(map, {scene.shape.vertices, scene.shape.faces, no_polygons},
                                       {scene.shape.vertices, scene.shape.faces}, centres);
    Mask wanted(count);
    for (Eigen::Index f = 0; f < count; ++f) wanted[f] = f % 5 != 0;
    for (const Mask& chosen : {all_triangles, wanted}) {
        std::vector<float> result(2 * 16 * 16);
        std::vector<std::uint8_t> mask(16 * 16);
        BakeChannel channel;
        channel.components = 2;
        channel.images = {Pixels{nullptr, scene.texture.data(), 16, 16}};
        channel.uv = scene.uv;
        channel.reals = result.data();
        const Mask baked = bake(map, {scene.shape.vertices, scene.shape.faces, no_polygons}, scene.uv, chosen,
                                {scene.shape.vertices, scene.shape.faces}, Eigen::VectorXi::Zero(count), {channel},
                                {16, 16, 0, 1}, mask.data());
        ASSERT_EQ(baked.rows(), count);
        EXPECT_LT(baked.count(), count);
        for (int f = 0; f < count; ++f) {
            EXPECT_EQ(baked[f], found.face[f] >= 0 && (chosen.rows() == 0 || chosen[f]));
        }
    }
}

TEST(TangentFrames, PointAlongGrowingUAndKnowMirroredUvs) {
    Scene scene;
    const TangentFrames plain = tangent_frames(scene.shape.vertices, scene.shape.faces, scene.uv);
    EXPECT_LE((plain.tangent.rowwise() - Eigen::RowVector3d::UnitX()).cwiseAbs().maxCoeff(), 1e-9);
    scene.uv.col(0) *= -1.0;
    const TangentFrames mirrored = tangent_frames(scene.shape.vertices, scene.shape.faces, scene.uv);
    EXPECT_LE((mirrored.tangent.rowwise() + Eigen::RowVector3d::UnitX()).cwiseAbs().maxCoeff(), 1e-9);
    for (int f = 0; f < scene.shape.faces.rows(); ++f) {
        EXPECT_EQ(plain.handedness[f], 1);
        EXPECT_EQ(mirrored.handedness[f], -1);
    }
}

}  // namespace isograft
