// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// How the surface of the donor is turned and sized to lie on that of the receiver, at every receiver vertex.
struct LocalFrames {
    /// #V by 9: rotation of donor vectors to receiver vectors, by rows; 0 where there is none.
    Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> rotation;
    /// #V: receiver units per donor unit in the few edges around the vertex; 0 where there is none.
    Eigen::VectorXd scale;
    /// Median of that over all edges; 0 if there is none.
    double median_scale = 0.0;
    /// #V: matched, and with a neighbour that is.
    Mask mask;
    /// Whether the two were found in one pose, and rotations so fitted over a wide surrounding.
    bool one_pose = false;
};

/// Options of local_frames().
struct FrameOptions {
    /// Neighbours of neighbours that a frame is fitted to: 0 = the vertex's own edges only. More is calmer on a noisy
    /// map and blurs the turning at joints by as many edges. Without a value two shapes in one pose, such as the faces
    /// of two persons, have rotations fitted over about a third of the root of the receiver's area, so that what one
    /// shape has of its own turns nothing; others over 2.
    std::optional<int> smoothing;
    /// Worker threads; 0 takes all cores. The result does not depend on it.
    int threads = 0;

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

/// Rotations between the surfaces: the best rigid fit (Kabsch 1976) of the edges and normals of the images around a
/// vertex to those of the receiver itself.
///
/// Exact under rigid motion and scale. Triangles that the map tore apart do not count (see place_corners()). Normals
/// are those of the receiver's triangles and of their images, so that the donor's winding does not matter. O(#F log
/// #F).
/// \param monitor may be null. \throw InvalidInput on sizes or indices that do not fit; Cancelled.
LocalFrames local_frames(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                         const FrameOptions& options = {}, Monitor* monitor = nullptr);

}  // namespace isograft
