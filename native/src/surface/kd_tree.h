// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace isograft {

/// Nearest points in space; the only place that knows of nanoflann.
class KdTree {
  public:
    struct Found {
        int index;
        double squared_distance;
    };

    /// O(n log n). Keeps a copy of the points.
    explicit KdTree(std::vector<Eigen::Vector3d> points);
    ~KdTree();
    KdTree(const KdTree&) = delete;
    KdTree& operator=(const KdTree&) = delete;

    [[nodiscard]] const std::vector<Eigen::Vector3d>& points() const;
    /// The `count` points nearest to `x` (all if there are fewer), by rising distance, ties by index.
    void nearest(const Eigen::Vector3d& x, int count, std::vector<Found>& found) const;
    /// All points within `radius` of `x`, in the same order.
    void within(const Eigen::Vector3d& x, double radius, std::vector<Found>& found) const;

  private:
    struct Index;
    std::unique_ptr<Index> index_;
};

}  // namespace isograft
