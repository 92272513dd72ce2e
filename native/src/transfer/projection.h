// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "transfer/donor_view.h"
#include "transfer/neighbourhood.h"
#include "transfer/receiver_images.h"

namespace isograft {

/// #V(receiver) by 3: normals of the images of the triangles around every vertex, by area; 0 without any.
Points image_normals(const ReceiverImages& receiver);

/// Finds the donor's surface point for points of the flat images of receiver triangles. Reused by one worker; the
/// result depends on the triangle, the weights and the place the walk starts from only.
class Projection {
  public:
    /// \param normals as of image_normals().
    Projection(const DonorView& donor, const ReceiverImages& receiver, const Points& normals);

    /// The triangle that the next calls are about; its extent must be finite.
    void enter(int triangle);
    /// Start the next walk at the corner of the triangle that is nearest by weight.
    void restart() { last_ = -1; }
    /// The donor's point under that with `weights` (>= 0, sum 1) in the triangle. Walks on from the point before.
    Place find(const Eigen::Vector3d& weights);

  private:
    [[nodiscard]] bool walk(const Eigen::Vector3d& p, const Eigen::Vector3d& direction, int from, Place& place) const;
    [[nodiscard]] Place nearest(const Eigen::Vector3d& p);

    const DonorView& donor_;
    const ReceiverImages& receiver_;
    const Points& normals_;
    Neighbourhood around_;
    int triangle_ = -1;
    int last_ = -1;
    const Image* corner_[3] = {nullptr, nullptr, nullptr};
    Eigen::Vector3d normal_[3];
    double farthest_ = 0.0;
    std::vector<int> near_;
    bool gathered_ = false;
};

}  // namespace isograft
