// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "feature/pair.h"
#include "geodesic/window.h"

namespace isograft {

/// Whether a geodesic runs free, is bent by a boundary, or does not exist.
enum class Sight : char { straight, bent, none };

/// Geodesic distances from one place, and whether their paths are bent by a boundary.
struct DistanceField {
    std::vector<float> distance;
    std::vector<Sight> sight;
    /// Angles at which the paths depart, in the frame of the place's triangle; of T's vertices only.
    std::vector<float> departure;
};

/// Distance fields over a pair, each measured once: maps that come from different cores, rounds and claims lay their
/// anchors on much the same places.
///
/// May be shared by threads; who asks first makes no difference.
class DistanceFields {
  public:
    explicit DistanceFields(const Pair& pair)
        : pair_(pair), of_source_(pair.source.samples.count()), of_target_(pair.target.mesh.vertex_count()) {}

    /// From a sample of S to all its samples. \param window the caller's own, on S. O(#V log #V) at first.
    std::shared_ptr<const DistanceField> from_sample(int sample, Window& window);
    /// From beside a vertex of T, see point_near_vertex(), to all its vertices. \param window the caller's own, on T.
    /// O(#V log #V) at first.
    std::shared_ptr<const DistanceField> from_vertex(int vertex, Window& window);

    [[nodiscard]] const Pair& pair() const { return pair_; }

  private:
    using Slot = std::shared_ptr<const DistanceField>;

    template <class Measure>
    Slot once(Slot& slot, Measure&& measure);

    const Pair& pair_;
    std::mutex mutex_;
    std::vector<Slot> of_source_, of_target_;
};

}  // namespace isograft
