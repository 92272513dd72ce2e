// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/pair.h"

#include <algorithm>

#include "base/random.h"

namespace isograft {

namespace {
// Bodies, faces and scans have 0.1 to 0.4. Where a surface shows less, as a plane does, descriptors differ by what
// hardly matters, and measured in that every map would look like chance.
constexpr double least_chance = 0.08;
}  // namespace

double curvature_time(const FeatureOptions& options) {
    // One umbrella step on a mesh of 5,000 vertices a unit area spreads about a fourth of a squared edge.
    constexpr double edge = 0.0141;
    return std::max(0.5, static_cast<double>(options.smoothing)) * edge * edge / 4.0;
}

double chance_distance(const Pair& pair, const FeatureOptions& options, std::uint64_t seed) {
    Random random(seed);
    std::vector<double> distances;
    for (int i = 0; i < 600; ++i) {
        const auto& a = pair.source_descriptor[random.below(pair.source.samples.count())];
        const auto& b = pair.target_descriptor[random.below(pair.target.samples.count())];
        const double d = descriptor_distance(a, b, random.below(descriptor_angles), options);
        if (d < 0.5 * not_comparable) distances.push_back(d);
    }
    std::sort(distances.begin(), distances.end());
    return distances.empty() ? 1.0 : std::max(least_chance, distances[distances.size() / 2]);
}

double mismatch(const Pair& pair, const FeatureOptions& options, int sample, const SurfacePoint& point,
                Complex rotation) {
    const Samples& samples = pair.target.samples;
    const int nearest = samples.nearest(pair.target.mesh, point);
    if (nearest < 0) return 2.0;
    const Complex turn = carry(pair.target.mesh, point.face, samples.point[nearest].face, rotation);
    const double d =
        descriptor_distance(pair.source_descriptor[sample], pair.target_descriptor[nearest], shift_of(turn), options);
    return std::min(3.0, d / pair.chance);
}

double field_at(const TriangleMesh& mesh, const std::vector<double>& field, const SurfacePoint& point) {
    double value = 0.0;
    for (int k = 0; k < 3; ++k) value += point.weight[k] * field[mesh.face[point.face][k]];
    return value;
}

}  // namespace isograft
