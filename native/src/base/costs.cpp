// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/costs.h"

#include <algorithm>

#include "base/parallel.h"

namespace isograft {

Costs::Costs(const MatchOptions& options)
    : threads_(worker_count(options.threads)),
      most_cores_(options.blend.cores),
      // Of a mesh of the coarse edge length; one within a third of that is left alone.
      uncoarsened_(4.0 / 3.0 / (0.72 * 0.87 * options.hierarchy.coarse_edge * options.hierarchy.coarse_edge) *
                   options.hierarchy.samples),
      automatic_(options.scale.mode == ScaleMode::automatic) {
    const double n = threads_;
    const double pair = std::min(n, 2.0);
    // Seconds of pairs of 5,000 to 300,000 vertices on one thread.
    const double samples = options.hierarchy.samples / 1000.0;
    const double patch = options.blend.patch_size / 200.0;
    vote_ = 0.12 / pair + 0.36 / n * options.scale.votes / 80.0;
    setting_ = samples * (0.25 / pair + 0.6 / n);
    probes_of_setting_ = (0.05 * samples + 0.1 * options.scale.probes / 120.0) / n;
    growth_ = (0.05 * samples + 0.2 * options.seed.probes / 250.0 + 0.75 * patch * options.blend.patches / 120.0) / n;
    core_ = samples * (0.1 + 0.085 * options.blend.rounds);
    answer_ = samples * (0.32 + 0.27 * options.blend.careful_rounds);
    const double sliding = 0.15 * options.dense.refine_coarse_iterations +
                           0.1 * options.dense.refine_relief_iterations + 0.09 * options.dense.refine_iterations;
    refinement_ = options.dense.refine_weight > 0.0 ? samples * sliding / n : 0.0;
}

double Costs::gate(std::int64_t vertices, bool is_cloud) {
    return (is_cloud ? 100e-6 : 4e-6) * static_cast<double>(vertices);
}

double Costs::coarsening(std::int64_t vertices) const {
    return 12e-6 * std::max(0.0, static_cast<double>(vertices) - uncoarsened_);
}

double Costs::coarsening(const std::vector<std::int64_t>& vertices) const {
    double sum = 0.0, longest = 0.0;
    for (const std::int64_t n : vertices) {
        sum += coarsening(n);
        longest = std::max(longest, coarsening(n));
    }
    return side_by_side(sum, longest);
}

double Costs::preparation(const std::vector<std::int64_t>& vertices) const {
    return coarsening(vertices) + (automatic_ ? votes(1) : 0.0) + setting_;
}

double Costs::dense(std::int64_t source_vertices) const {
    return 5e-6 * static_cast<double>(source_vertices) / threads_;
}

double Costs::search(std::int64_t source_vertices) const {
    return growth_ + cores(most_cores_) + answers(1) + refinement_ + dense(source_vertices);
}

double Costs::side_by_side(double sum, double longest) const { return std::max(sum / threads_, longest); }

}  // namespace isograft
