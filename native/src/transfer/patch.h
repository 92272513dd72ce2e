// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "transfer/donor_view.h"

namespace isograft {

/// Reads all corners of one receiver polygon in one seam-free patch of the donor. Reused from polygon to polygon by one
/// worker; the result does not depend on what came before.
class PatchReader {
  public:
    PatchReader(const DonorView& donor, double extrapolation);

    /// \param centre mean of the images over the polygon's area.
    /// \param places one per image. \param root triangle under an image whose patch is read; -1: that under the centre.
    /// \return false if the images are not connected near each other.
    bool read(const std::vector<Image>& images, const Eigen::Vector3d& centre, std::vector<Place>& places,
              int root = -1);

    /// Of the polygon read last: true if some of its images do not lie in the patch.
    [[nodiscard]] bool parted() const { return parted_; }
    /// True if triangle `face`, that of an image, lies in the patch.
    [[nodiscard]] bool reaches(int face) const { return !parted_ || visible(nodes_[slot_[face]]); }
    /// A triangle of the patch: the one it was read around, or that of the first image.
    [[nodiscard]] int root() const { return root_; }
    /// Distance of a point from the patch, if parted().
    [[nodiscard]] double distance(const Eigen::Vector3d& p) const { return nearest(p).distance; }

  private:
    // A triangle near the images. Lengths of paths from the root, infinite where none leads.
    struct Node {
        int face;
        double distance;
        double any_path;
        double seam_free_path;
    };

    // A triangle's place against one point.
    struct Reading {
        int node = -1;
        Eigen::Vector3d weights;
        double distance;
        // The triangle's border edge to go straight out from, -1 if none, and how far the point lies off along it.
        int hinge = -1;
        double slide;
    };

    void gather(const std::vector<Image>& images, const Eigen::Vector3d& centre, double radius);
    void spread(int from, const Eigen::Vector3d& centre, double radius);
    [[nodiscard]] bool seen(int face) const { return stamp_[face] == run_; }
    [[nodiscard]] bool visible(const Node& node) const;
    [[nodiscard]] int choose_root(const std::vector<Image>& images, double radius) const;
    void measure_paths(int root, const Eigen::Vector3d& centre, bool cross_seams);
    [[nodiscard]] Reading nearest(const Eigen::Vector3d& p) const;
    [[nodiscard]] Place place(const Image& image, const Reading& reading) const;
    void find_hinge(Reading& reading, const Eigen::Vector3d& offset) const;
    [[nodiscard]] bool is_border(int half_edge) const;
    [[nodiscard]] Place extend(const Reading& reading, const Eigen::Vector3d& p) const;
    // Height over longest edge.
    [[nodiscard]] double thickness(int face) const;
    // A half-edge of the first thick triangle behind a thin one with that hinge, towards it; -1 if there is none.
    [[nodiscard]] int behind(int face, int hinge) const;

    const DonorView& donor_;
    double extrapolation_;
    int run_ = 0;
    bool seams_near_ = false;
    int parts_ = 0;
    int root_ = -1;
    bool parted_ = false;
    std::vector<int> stamp_;
    std::vector<int> slot_;
    std::vector<Node> nodes_;
    std::vector<Eigen::Vector3d> entry_;
    std::vector<std::pair<double, int>> heap_;
};

}  // namespace isograft
