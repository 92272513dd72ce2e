// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/paint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/margin.h"
#include "transfer/raster.h"

namespace isograft {

namespace {

// Of the whole: painting, then the margin.
constexpr double share_of_painting = 0.5;

void write(const PaintChannel& channel, std::size_t texel, int f, const Eigen::Vector3d& weights) {
    const Eigen::RowVectorXd value = weights.transpose() * channel.values.middleRows<3>(3 * f);
    const auto count = static_cast<std::size_t>(value.size());
    for (std::size_t k = 0; k < count; ++k) {
        const double number = value[static_cast<Eigen::Index>(k)];
        if (channel.reals != nullptr) {
            channel.reals[texel * count + k] = static_cast<float>(number);
        } else {
            channel.bytes[texel * count + k] = static_cast<std::uint8_t>(std::clamp(std::round(number), 0.0, 255.0));
        }
    }
}

}  // namespace

void paint(const CornerUV& uv, const Mask& wanted, const std::vector<PaintChannel>& channels,
           const BakeOptions& options, std::uint8_t* mask, Monitor* monitor) {
    options.validate();
    const Eigen::Index count = wanted.rows();
    check_corner_values(uv, count, "the layout");
    for (const PaintChannel& channel : channels) {
        check_corner_values(channel.values, count, "the values to paint");
        if ((channel.bytes == nullptr) == (channel.reals == nullptr)) {
            throw InvalidInput("a channel to paint must have one kind of result");
        }
    }
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();
    std::vector<char> used(count, 0);
    for (Eigen::Index f = 0; f < count; ++f) used[f] = wanted[f] ? 1 : 0;
    const Bands bands = make_bands(uv, used, options.width, options.height);
    const auto fill = [&](int band, int /*worker*/) {
        const int first_row = band * bands.rows;
        const int end_row = std::min(options.height, first_row + bands.rows);
        for (Eigen::Index i = bands.first[band]; i < bands.first[band + 1]; ++i) {
            const int f = bands.triangle[i];
            const TexelTriangle triangle(uv, f, options.width, options.height);
            for (int y = std::max(first_row, triangle.first_row()); y < std::min(end_row, triangle.end_row()); ++y) {
                const Span span = triangle.span(y);
                for (int x = span.from; x < span.to; ++x) {
                    const std::size_t texel = static_cast<std::size_t>(y) * options.width + x;
                    if (mask[texel] != static_cast<std::uint8_t>(Texel::nothing)) continue;
                    for (const PaintChannel& channel : channels) write(channel, texel, f, span.at + x * span.step);
                    mask[texel] = static_cast<std::uint8_t>(Texel::filled);
                }
            }
        }
    };
    parallel_for(bands.count(), options.threads, fill, watched, "fill", 0.0, share_of_painting);
    const auto copy = [&](std::size_t from, std::size_t to) {
        for (const PaintChannel& c : channels) copy_texel(c, static_cast<int>(c.values.cols()), from, to);
    };
    dilate_bands(bands, mask, options, copy, watched, share_of_painting, 1.0);
}

}  // namespace isograft
