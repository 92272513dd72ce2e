// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <map>
#include <mutex>
#include <vector>

#include "base/piece.h"
#include "growth/patches.h"

namespace isograft {

/// A seed of a second pass by its indices: what it grows into depends on nothing else.
struct TrialSeed {
    int source = -1;
    int target = -1;
    /// Sectors between the two samples' frames.
    int shift = 0;
};

/// What grew from such a seed, without the samples it does not hold.
struct Trial {
    struct Held {
        int sample;
        SurfacePoint image;
        Eigen::Vector3d position;
        Complex rotation;
    };
    std::vector<Held> held;
    double quality = 0.0;
    /// Mean mismatch of what is held.
    double misfit = 0.0;
};

/// Trials by their seeds, each grown once: the cores of a pair and the rounds of a core ask for the same again and
/// again.
///
/// May be shared by threads; who asks first makes no difference.
class Trials {
  public:
    /// \param size samples a trial may map. The references must outlive it.
    Trials(const Pair& pair, const PatchSettings& settings, int size) : pair_(pair), settings_(settings), size_(size) {}

    /// \param grower the caller's own. \return stays where it is as long as this lives.
    const Trial& of(const TrialSeed& seed, Grower& grower);
    /// Grow what of() will be asked for, side by side. \param progress is filled.
    void prepare(const std::vector<TrialSeed>& seeds, int threads, Piece progress);

  private:
    const Pair& pair_;
    const PatchSettings& settings_;
    int size_;
    std::mutex mutex_;
    std::map<std::array<int, 3>, Trial> made_;
};

/// The map of a trial.
PartialMap to_map(const Trial& trial, const TrialSeed& seed, const Pair& pair);

}  // namespace isograft
