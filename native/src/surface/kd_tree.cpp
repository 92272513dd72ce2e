// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/kd_tree.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

namespace isograft {

namespace {

struct Dataset {
    std::vector<Eigen::Vector3d> points;

    [[nodiscard]] std::size_t kdtree_get_point_count() const { return points.size(); }
    [[nodiscard]] double kdtree_get_pt(std::size_t index, std::size_t axis) const {
        return points[index][static_cast<Eigen::Index>(axis)];
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
        return false;
    }
};

bool before(const KdTree::Found& a, const KdTree::Found& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.index < b.index;
}

// What nanoflann's own result sets do differs between its versions; these two need only what all of them call.
class NearestSet {
  public:
    NearestSet(std::vector<KdTree::Found>& found, std::size_t capacity) : found_(&found), capacity_(capacity) {}

    [[nodiscard]] bool full() const { return found_->size() == capacity_; }
    [[nodiscard]] std::size_t size() const { return found_->size(); }
    [[nodiscard]] double worstDist() const {  // NOLINT(readability-identifier-naming): nanoflann's name
        return full() ? found_->back().squared_distance : std::numeric_limits<double>::max();
    }
    bool addPoint(double distance, int index) {  // NOLINT(readability-identifier-naming)
        const KdTree::Found item{index, distance};
        const auto place = std::upper_bound(found_->begin(), found_->end(), item, before);
        if (full()) {
            if (place == found_->end()) return true;
            found_->pop_back();
        }
        found_->insert(place, item);
        return true;
    }
    void sort() {}

  private:
    std::vector<KdTree::Found>* found_;
    std::size_t capacity_;
};

class WithinSet {
  public:
    WithinSet(std::vector<KdTree::Found>& found, double squared_radius)
        : found_(&found), squared_radius_(squared_radius) {}

    [[nodiscard]] bool full() const { return true; }
    [[nodiscard]] std::size_t size() const { return found_->size(); }
    [[nodiscard]] double worstDist() const { return squared_radius_; }  // NOLINT(readability-identifier-naming)
    bool addPoint(double distance, int index) {                         // NOLINT(readability-identifier-naming)
        if (distance <= squared_radius_) found_->push_back({index, distance});
        return true;
    }
    void sort() {}

  private:
    std::vector<KdTree::Found>* found_;
    double squared_radius_;
};

}  // namespace

struct KdTree::Index {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Dataset>, Dataset, 3, int>;

    explicit Index(std::vector<Eigen::Vector3d> points)
        : data{std::move(points)}, tree(3, data, nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
        tree.buildIndex();
    }

    Dataset data;
    Tree tree;
};

KdTree::KdTree(std::vector<Eigen::Vector3d> points) : index_(std::make_unique<Index>(std::move(points))) {}
KdTree::~KdTree() = default;

const std::vector<Eigen::Vector3d>& KdTree::points() const { return index_->data.points; }

void KdTree::nearest(const Eigen::Vector3d& x, int count, std::vector<Found>& found) const {
    found.clear();
    NearestSet set(found, std::min(static_cast<std::size_t>(count), points().size()));
    if (count > 0 && !points().empty()) index_->tree.findNeighbors(set, x.data(), {});
}

void KdTree::within(const Eigen::Vector3d& x, double radius, std::vector<Found>& found) const {
    found.clear();
    WithinSet set(found, radius * radius);
    if (!points().empty()) index_->tree.findNeighbors(set, x.data(), {});
    std::sort(found.begin(), found.end(), before);
}

}  // namespace isograft
