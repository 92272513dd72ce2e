// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/memory.h"

#include <string>

#include "base/parallel.h"
#include "isograft/errors.h"

namespace isograft {

std::int64_t estimated_memory(const MeshSize& source, const MeshSize& target, const MatchOptions& options) {
    // The gate's mesh and the working one, for a while also that with closed holes, which takes its place; sorting and
    // coarsening, which two surfaces may go through at once.
    constexpr std::int64_t per_vertex = 400, per_triangle = 440;
    // Descriptors, edges, trials; every probe holds a map of all samples, every thread a grower.
    constexpr std::int64_t per_sample = 55'000, per_sample_and_probe = 80, per_sample_and_thread = 4'000;
    constexpr std::int64_t program = 10'000'000;
    const std::int64_t samples = options.hierarchy.samples;
    const std::int64_t threads = worker_count(options.threads);
    return program + per_vertex * (source.vertices + target.vertices) +
           per_triangle * (source.triangles + target.triangles) +
           samples * (per_sample + per_sample_and_probe * options.seed.probes + per_sample_and_thread * threads);
}

void check_memory(const MeshSize& source, const MeshSize& target, const MatchOptions& options, std::int64_t limit) {
    if (limit <= 0) return;
    const std::int64_t estimate = estimated_memory(source, target, options);
    if (estimate <= limit) return;
    const auto megabytes = [](std::int64_t bytes) { return std::to_string((bytes + 999'999) / 1'000'000) + " MB"; };
    throw ResourceLimit("matching " + std::to_string(source.vertices) + " to " + std::to_string(target.vertices) +
                        " vertices takes about " + megabytes(estimate) + ", the limit is " + megabytes(limit) +
                        "; raise the limit, simplify the surfaces, or take fewer samples (preset fast)");
}

}  // namespace isograft
