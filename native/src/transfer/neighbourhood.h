// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "transfer/donor_view.h"

namespace isograft {

/// Collects the triangles of a donor around a point that are connected to given ones. Reused by one worker; results do
/// not depend on what came before.
class Neighbourhood {
  public:
    explicit Neighbourhood(const DonorView& donor);

    /// \param seeds triangles; those out of reach are left out. \return triangles within `radius` of `centre` that are
    /// reached from a seed through such triangles, in the order found. Valid until the next call.
    const std::vector<int>& gather(const int* seeds, int count, const Eigen::Vector3d& centre, double radius);

  private:
    const DonorView& donor_;
    int run_ = 0;
    std::vector<int> stamp_;
    std::vector<int> found_;
};

}  // namespace isograft
