// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// Images by the sample of T nearest to them, to ask whether a place is taken.
class ImageCells {
  public:
    /// Empty. \param pair must outlive it.
    explicit ImageCells(const Pair& pair) : pair_(pair), cell_(pair.target.samples.count()) {}

    /// Enter the image of a mapped sample.
    void put(const PartialMap& map, int sample);

    /// Whether the image of a sample more than two spacings away on S lies nearer to `point` than `radius`, in the
    /// pair's unit length and at most a spacing: it looks in the cells around. Not where T has no sample.
    [[nodiscard]] bool taken(const PartialMap& map, int sample, const SurfacePoint& point, double radius) const;

  private:
    const Pair& pair_;
    std::vector<std::vector<int>> cell_;
};

}  // namespace isograft
