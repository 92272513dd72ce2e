// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/raster.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/LU>

namespace isograft {

namespace {

// A band is a task: some milliseconds of work, so that cancelling is quick.
constexpr std::int64_t texels_a_band = 1 << 16;
// A centre this far outside a triangle, as a weight, still counts: no gaps between neighbours.
constexpr double outside = 1e-9;

int clamped(double x, int limit) { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(limit))); }

}  // namespace

TexelTriangle::TexelTriangle(const CornerUV& uv, int triangle, int width, int height) : width_(width) {
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) {
        // In texels whose centres have whole coordinates.
        corners.col(c) << uv(3 * triangle + c, 0) * width - 0.5, uv(3 * triangle + c, 1) * height - 0.5, 1.0;
    }
    first_row_ = clamped(std::floor(corners.row(1).minCoeff()), height);
    end_row_ = clamped(std::floor(corners.row(1).maxCoeff()) + 2.0, height);
    const Eigen::Vector3d longest = corners.rowwise().maxCoeff() - corners.rowwise().minCoeff();
    const double area = corners.determinant();
    flat_ = !(std::abs(area) > 1e-12 * std::max(1.0, longest.squaredNorm()));
    if (!flat_) weights_ = corners.inverse();
}

Span TexelTriangle::span(int row) const {
    Span span;
    if (flat_) return span;
    span.step = weights_.col(0);
    span.at = weights_.col(1) * row + weights_.col(2);
    double from = 0.0, to = width_ - 1.0;
    for (int c = 0; c < 3; ++c) {
        const double slope = span.step[c], start = span.at[c] + outside;
        if (slope > 0.0) {
            from = std::max(from, -start / slope);
        } else if (slope < 0.0) {
            to = std::min(to, -start / slope);
        } else if (start < 0.0) {
            return span;
        }
    }
    if (from > to) return span;
    span.from = static_cast<int>(std::ceil(from));
    span.to = static_cast<int>(std::floor(to)) + 1;
    return span;
}

Bands make_bands(const CornerUV& uv, const std::vector<char>& used, int width, int height) {
    Bands bands;
    bands.rows = static_cast<int>(std::clamp<std::int64_t>(texels_a_band / width, 1, 64));
    const int count = (height + bands.rows - 1) / bands.rows;
    bands.first.assign(count + 1, 0);
    const auto each = [&](const auto& visit) {
        for (int f = 0; f < static_cast<int>(used.size()); ++f) {
            if (used[f] == 0) continue;
            const TexelTriangle triangle(uv, f, width, height);
            if (triangle.first_row() >= triangle.end_row()) continue;
            for (int b = triangle.first_row() / bands.rows; b <= (triangle.end_row() - 1) / bands.rows; ++b)
                visit(f, b);
        }
    };
    each([&](int /*triangle*/, int band) { ++bands.first[band + 1]; });
    for (int b = 0; b < count; ++b) bands.first[b + 1] += bands.first[b];
    bands.triangle.resize(bands.first[count]);
    std::vector<Eigen::Index> next(bands.first.begin(), bands.first.end() - 1);
    each([&](int triangle, int band) { bands.triangle[next[band]++] = triangle; });
    return bands;
}

}  // namespace isograft
