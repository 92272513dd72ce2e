// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "isograft/transfer.h"
#include "transfer/seams.h"

namespace isograft {

/// The donor as the placement of corners reads it.
struct DonorView {
    DonorView(const DonorMesh& donor, const CornerValues& values, double tolerance);

    [[nodiscard]] Eigen::Vector3d corner(int f, int c) const { return vertices.row(faces(f, c)).transpose(); }
    [[nodiscard]] Eigen::Vector3d point(int f, const Eigen::Vector3d& weights) const {
        return weights[0] * corner(f, 0) + weights[1] * corner(f, 1) + weights[2] * corner(f, 2);
    }
    /// Weights of the point of triangle `f` that is nearest to `p`.
    [[nodiscard]] Eigen::Vector3d closest(int f, const Eigen::Vector3d& p) const;
    /// The attribute at `weights` of triangle `f`.
    [[nodiscard]] Eigen::RowVectorXd value(int f, const Eigen::Vector3d& weights) const;

    const Points& vertices;
    const Triangles& faces;
    const CornerValues& values;
    double tolerance;
    SeamGraph graph;
    /// #F by 3: unit normals, of one winding within every part joined by edges of two triangles; 0 without an area.
    Points normal;
    /// #F.
    Eigen::VectorXd longest_edge;
    /// Of all triangles.
    double area = 0.0;
    /// Points nearer than this are one.
    double same_point;
};

/// The image of a receiver's vertex on the donor.
struct Image {
    int face = -1;
    Eigen::Vector3d weights;
    Eigen::Vector3d point;
};

/// Where a corner is read.
struct Place {
    int face = -1;
    Eigen::Vector3d weights;
};

/// Reads all corners of one receiver polygon in one seam-free patch of the donor. Reused from polygon to polygon by one
/// worker; the result does not depend on what came before.
class PatchReader {
  public:
    PatchReader(const DonorView& donor, double extrapolation);

    /// \param centre mean of the images over the polygon's area.
    /// \param places one per image. \return false if the images are not connected near each other.
    bool read(const std::vector<Image>& images, const Eigen::Vector3d& centre, std::vector<Place>& places);

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
    [[nodiscard]] Eigen::Vector3d extend(const Reading& reading, const Eigen::Vector3d& p) const;

    const DonorView& donor_;
    double extrapolation_;
    int run_ = 0;
    bool seams_near_ = false;
    int parts_ = 0;
    std::vector<int> stamp_;
    std::vector<int> slot_;
    std::vector<Node> nodes_;
    std::vector<Eigen::Vector3d> entry_;
    std::vector<std::pair<double, int>> heap_;
};

}  // namespace isograft
