// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include <Eigen/Core>

#include "isograft/transfer.h"

namespace isograft {

/// Which triangles of a UV layout reach into which band of an image's rows.
struct Bands {
    int rows = 1;
    /// Triangles of band b: triangle[first[b]] to triangle[first[b + 1] - 1], ascending.
    std::vector<int> triangle;
    std::vector<Eigen::Index> first;

    [[nodiscard]] int count() const { return static_cast<int>(first.size()) - 1; }
};

/// \param uv 3 #F by 2, finite. \param used #F. O(#F + entries).
Bands make_bands(const CornerUV& uv, const std::vector<char>& used, int width, int height);

/// The texels of one row whose centres lie in a triangle: `from` to `to` - 1, and the weights of its corners there.
struct Span {
    int from = 0;
    int to = 0;
    /// Weights of texel x: at + x * step.
    Eigen::Vector3d at;
    Eigen::Vector3d step;
};

/// A triangle of a UV layout over an image.
class TexelTriangle {
  public:
    TexelTriangle(const CornerUV& uv, int triangle, int width, int height);

    /// First and one past the last row that its bounding box touches, within the image.
    [[nodiscard]] int first_row() const { return first_row_; }
    [[nodiscard]] int end_row() const { return end_row_; }
    /// Empty where the triangle has no area.
    [[nodiscard]] Span span(int row) const;

  private:
    int width_;
    int first_row_;
    int end_row_;
    // Weights as an affine function of x and y, in texels.
    Eigen::Matrix3d weights_;
    bool flat_ = true;
};

}  // namespace isograft
