// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "feature/pair.h"
#include "growth/partial_map.h"

namespace isograft {

/// Where the surroundings of a sample would fit best, within a few spacings of its image.
struct Drift {
    /// From the image there, in the frame of the image's triangle.
    Complex offset{0.0, 0.0};
    /// Mean mismatch() of the surroundings where they are, and where they fit best.
    double here = 0.0;
    double there = 0.0;

    /// Share of the mismatch that moving there would save.
    [[nodiscard]] double gain() const { return (here - there) / (here + 0.05); }
};

/// Finds samples that slid along a part which stretches: least squares keeps every edge there, and the mismatch of a
/// place says little unless it is compared with that of the places around.
///
/// A sample and its mapped neighbours are moved together over the target, by up to 5 spacings and turned by up to 30
/// degrees, and the mean mismatch is compared: block matching, on a surface. Costs about 50,000 descriptor distances a
/// hundred samples at first, then only those of new places; no geodesics. May be shared by threads.
class DriftFinder {
  public:
    /// Prepares the target: for every sample those around it, unfolded over the edges between them.
    DriftFinder(const Pair& pair, const FeatureOptions& options);

    /// Per sample of the source; nothing is off where it is not mapped.
    [[nodiscard]] std::vector<Drift> find(const PartialMap& map, int threads, Monitor& monitor) const;

  private:
    static constexpr int turns = 5;

    struct Near {
        int sample;
        /// In the frame of the sample in the middle.
        Complex offset;
        /// Takes a direction of the middle's frame along, into the frame of `sample`.
        Complex turn;
    };
    /// One move of the grid: the mismatch after it, at every turn, summed over `count` samples.
    struct Cell {
        float count = 0.0F;
        std::array<float, turns> sum{};
    };

    /// Mismatch with target samples at every shift; below 0 where nobody has asked yet.
    using Known = std::unordered_map<int, std::array<float, descriptor_angles>>;

    [[nodiscard]] std::vector<Near> unfold(int middle) const;
    [[nodiscard]] std::vector<Cell> moves(const PartialMap& map, int sample) const;

    const Pair& pair_;
    FeatureOptions options_;
    double spacing_;
    std::vector<std::vector<Near>> around_;
    // Maps move little from one call to the next. Per source sample; each lock guards every 64th.
    mutable std::vector<Known> known_;
    mutable std::array<std::mutex, 64> locks_;
};

}  // namespace isograft
