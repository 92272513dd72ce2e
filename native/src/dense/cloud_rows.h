// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geodesic/surface_point.h"
#include "isograft/correspondence.h"
#include "isograft/monitor.h"
#include "surface/kd_tree.h"

namespace isograft {

/// Per input point of a cloud its place on the cloud's mesh; face -1 for points left out.
std::vector<SurfacePoint> cloud_places(const Surface& cloud, Monitor& monitor);

/// Says images on a cloud's mesh in terms of the cloud's own points.
class CloudRows {
  public:
    /// \param cloud must outlive this object.
    explicit CloudRows(const Surface& cloud);

    /// Write the image `point` into a row: the place itself, the nearest points that look the same way, their weights.
    void write(Correspondence& c, Eigen::Index row, const SurfacePoint& point) const;

  private:
    const Surface* cloud_;
    std::vector<int> input_;
    KdTree tree_;
};

}  // namespace isograft
