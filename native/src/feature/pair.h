// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "feature/descriptor.h"
#include "hierarchy/samples.h"

namespace isograft {

/// Both surfaces in the pair's unit length, with everything that matching them asks for.
struct Pair {
    SampledMesh source, target;
    /// Per mesh vertex, smoothed mean curvature in one over the unit length.
    std::vector<double> source_curvature, target_curvature;
    /// The same with less smoothing, for refinement.
    std::vector<double> source_detail, target_detail;
    /// Per sample.
    std::vector<PolarDescriptor> source_descriptor, target_descriptor;
    /// Median distance of descriptors that have nothing to do with each other, at least 0.08: the unit of mismatch().
    double chance = 1.0;
};

/// Heat flow times of Pair's two curvatures, in squared unit lengths.
double curvature_time(const FeatureOptions& options);
constexpr double detail_time = 1.5e-4;

/// Pair::chance, from random samples. \param pair descriptors are filled in.
double chance_distance(const Pair& pair, const FeatureOptions& options, std::uint64_t seed);

/// How badly the source's sample fits a point of the target under a rotation: descriptor distance to the target's
/// nearest sample over that of chance, capped at 3; 2 where the target has no sample.
double mismatch(const Pair& pair, const FeatureOptions& options, int sample, const SurfacePoint& point,
                Complex rotation);

/// Curvature of a vertex field at a surface point.
double field_at(const TriangleMesh& mesh, const std::vector<double>& field, const SurfacePoint& point);

}  // namespace isograft
