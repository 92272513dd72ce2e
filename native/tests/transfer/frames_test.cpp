// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/frames.h"

#include <cmath>
#include <optional>
#include <vector>

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

TEST(LocalFrames, AreWideBetweenTwoShapesThatHoldOnePose) {
    // Moved at random and smoothly, in all directions alike: each part leans, none of them is turned.
    const shapes::Shape donor = shapes::blob(4);
    shapes::Shape receiver = donor;
    for (int k = 1; k <= 8; ++k) {
        const Eigen::Vector3d wave(4.0 * std::sin(1.7 * k), 4.0 * std::cos(2.3 * k), 4.0 * std::sin(3.1 * k + 1.0));
        const Eigen::Vector3d along(std::cos(1.3 * k), std::sin(2.9 * k), std::cos(0.7 * k + 2.0));
        const Eigen::ArrayXd height = (donor.vertices * wave).array() + k;
        receiver.vertices += 0.02 * height.sin().matrix() * along.transpose();
    }
    const LocalFrames chosen = frames_of(receiver, donor), few = frames_of(receiver, donor, {2, 0});
    EXPECT_TRUE(chosen.one_pose);
    EXPECT_FALSE(few.one_pose);
    EXPECT_EQ(chosen.scale, few.scale);
    const auto off = [](const LocalFrames& frames) {
        const RowMatrix3d none = RowMatrix3d::Identity();
        return (frames.rotation.rowwise() - Eigen::Map<const Eigen::Matrix<double, 1, 9>>(none.data()))
            .rowwise()
            .norm()
            .mean();
    };
    EXPECT_LE(off(chosen), 0.5 * off(few));
}

TEST(LocalFrames, AreOfAFewEdgesWhereALimbTurns) {
    const shapes::Shape donor = shapes::cylinder(24, 40, 0.3, 4.0);
    shapes::Shape receiver = donor;
    const Eigen::Matrix3d bend = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d joint(0.0, 0.0, 2.0);
    for (Eigen::Index v = 0; v < donor.vertices.rows(); ++v) {
        const Eigen::Vector3d x = donor.vertices.row(v).transpose();
        if (x.z() > joint.z()) receiver.vertices.row(v) = (bend * (x - joint) + joint).transpose();
    }
    const LocalFrames chosen = frames_of(receiver, donor);
    EXPECT_FALSE(chosen.one_pose);
    EXPECT_EQ(chosen.rotation, frames_of(receiver, donor, {2, 0}).rotation);
}

TEST(LocalFrames, FollowASmallLimbThatTurnsOnABodyThatDoesNot) {
    // A ball with a finger of a fiftieth of its area, bent by a right angle in its middle.
    shapes::Shape donor = shapes::sphere(6);
    shapes::Shape receiver = donor;
    const Eigen::Matrix3d bend = Eigen::AngleAxisd(M_PI / 2.0, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Vector3d joint(0.0, 0.0, 1.4);
    std::vector<int> tip;
    for (int v = 0; v < donor.vertices.rows(); ++v) {
        const Eigen::Vector3d x = donor.vertices.row(v).transpose();
        const double flat = std::hypot(x.x(), x.y());
        if (x.z() < 0.0 || flat > 0.15) continue;
        const Eigen::Vector3d on_finger(x.x(), x.y(), x.z() + 0.8 * (1.0 - flat / 0.15));
        const bool beyond = on_finger.z() > joint.z();
        donor.vertices.row(v) = on_finger.transpose();
        receiver.vertices.row(v) = (beyond ? bend * (on_finger - joint) + joint : on_finger).transpose();
        if (on_finger.z() > 1.55 && on_finger.z() < 1.7) tip.push_back(v);
    }
    const LocalFrames frames = frames_of(receiver, donor);
    ASSERT_GT(tip.size(), 10u);
    for (const int v : tip) {
        const Eigen::Map<const RowMatrix3d> rotation(frames.rotation.row(v).data());
        EXPECT_LE((rotation - bend).norm(), 0.4) << "vertex " << v;  // of 2 if it did not turn
    }
}

TEST(LocalFrames, AreWideBitForBitForAnyNumberOfThreads) {
    const shapes::Shape donor = shapes::sphere(4);
    const shapes::Shape receiver = shapes::noisy(donor, 0.02, 1);
    const LocalFrames one = frames_of(receiver, donor, {std::nullopt, 1});
    EXPECT_TRUE(one.one_pose);
    EXPECT_EQ(one.rotation, frames_of(receiver, donor, {std::nullopt, 4}).rotation);
}

TEST(LocalFrames, RefusesOptionsAndStopsWhenCancelled) {
    const shapes::Shape donor = shapes::sphere(1);
    EXPECT_THROW(frames_of(donor, donor, {-1, 0}), InvalidInput);
    Monitor monitor;
    monitor.cancel();
    EXPECT_THROW(frames_of(donor, donor, {}, &monitor), Cancelled);
}

}  // namespace isograft
