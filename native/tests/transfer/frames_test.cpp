// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/frames.h"

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "shapes.h"
#include "transfer_maps.h"

namespace isograft {

namespace {

using maps::identity;
using RowMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

const Eigen::VectorXi no_polygons;

LocalFrames frames_of(const shapes::Shape& receiver, const shapes::Shape& donor, const FrameOptions& options = {},
                      Monitor* monitor = nullptr) {
    return local_frames(identity(donor), {receiver.vertices, receiver.faces, no_polygons},
                        {donor.vertices, donor.faces}, options, monitor);
}

}  // namespace

TEST(LocalFrames, AreTheRotationAndTheScaleOfARigidMotion) {
    const shapes::Shape donor = shapes::blob(3);
    const Eigen::Matrix3d turn = shapes::some_rotation();
    const LocalFrames frames = frames_of(shapes::moved(donor, turn, {1.0, 2.0, 3.0}, 2.5), donor);
    ASSERT_TRUE(frames.mask.all());
    EXPECT_NEAR(frames.median_scale, 2.5, 1e-9);
    for (Eigen::Index v = 0; v < donor.vertices.rows(); ++v) {
        const Eigen::Map<const RowMatrix3d> rotation(frames.rotation.row(v).data());
        EXPECT_LE((rotation - turn).norm(), 1e-9) << "vertex " << v;
        EXPECT_NEAR(frames.scale[v], 2.5, 1e-9) << "vertex " << v;
    }
}

TEST(LocalFrames, DoNotMirrorASheetThatOnlyItsNormalTellsApart) {
    // A flat sheet turned over: edges alone would fit a reflection as well.
    const shapes::Shape donor = shapes::grid(6, 5, 1.0, 1.0);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    FrameOptions options;
    options.smoothing = 0;
    const LocalFrames frames = frames_of(shapes::moved(donor, turn, {0.0, 0.0, 0.0}), donor, options);
    for (Eigen::Index v = 0; v < donor.vertices.rows(); ++v) {
        EXPECT_LE((Eigen::Map<const RowMatrix3d>(frames.rotation.row(v).data()) - turn).norm(), 1e-9);
    }
}

TEST(LocalFrames, AreEqualBitForBitForAnyNumberOfThreads) {
    const shapes::Shape donor = shapes::sphere(4);
    const shapes::Shape receiver = shapes::noisy(donor, 0.05, 1);
    EXPECT_EQ(frames_of(receiver, donor, {2, 1}).rotation, frames_of(receiver, donor, {2, 4}).rotation);
}

TEST(LocalFrames, RefusesOptionsAndStopsWhenCancelled) {
    const shapes::Shape donor = shapes::sphere(1);
    EXPECT_THROW(frames_of(donor, donor, {-1, 0}), InvalidInput);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(frames_of(donor, donor, {}, &monitor), Cancelled);
}

}  // namespace isograft
