// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "isograft/match.h"

namespace isograft {

/// What the parts of a match are expected to cost in seconds, for dividing the progress: only ratios matter.
///
/// From measured pairs with the default options; what is done in parallel counts by the number of threads. O(1).
class Costs {
  public:
    explicit Costs(const MatchOptions& options);

    /// The gate's checks of one surface.
    static double gate(std::int64_t vertices, bool is_cloud);
    /// One surface to its working mesh.
    [[nodiscard]] double coarsening(std::int64_t vertices) const;
    /// Of surfaces side by side.
    [[nodiscard]] double coarsening(const std::vector<std::int64_t>& vertices) const;
    /// Votes on the scale of `sides` combinations of sides.
    [[nodiscard]] double votes(int sides) const { return sides * vote_; }
    /// What is done for one setting that votes leave, and the probes that decide between several.
    [[nodiscard]] double setting() const { return setting_; }
    [[nodiscard]] double probes_of_setting() const { return probes_of_setting_; }
    /// All of these, where votes leave one setting and both sides are clear.
    [[nodiscard]] double preparation(const std::vector<std::int64_t>& vertices) const;
    /// Seeds, probes and patches.
    [[nodiscard]] double growth() const { return growth_; }
    /// Completing so many cores, and carrying so many answers into the rest, some contested.
    [[nodiscard]] double cores(int count) const { return rounds_of(count) * core_; }
    [[nodiscard]] double answers(int count) const { return rounds_of(count) * answer_; }
    /// Of one answer.
    [[nodiscard]] double refinement() const { return refinement_; }
    [[nodiscard]] double dense(std::int64_t source_vertices) const;
    /// Everything after the preparation, with as many cores as there may be and one answer.
    [[nodiscard]] double search(std::int64_t source_vertices) const;

    /// Seconds of tasks that run side by side, one thread each.
    [[nodiscard]] double side_by_side(double sum, double longest) const;

  private:
    [[nodiscard]] int rounds_of(int tasks) const { return (tasks + threads_ - 1) / threads_; }

    int threads_, most_cores_;
    /// Without coarsening infinite.
    double uncoarsened_;
    bool automatic_;
    double vote_, setting_, probes_of_setting_, growth_, core_, answer_, refinement_;
};

/// The end of a part that begins at `from`, where its `cost` and that of what comes `later` share what is left until
/// `to`.
inline double end_of_part(double from, double to, double cost, double later) {
    const double both = cost + later;
    return both > 0.0 ? from + (to - from) * cost / both : from;
}

}  // namespace isograft
