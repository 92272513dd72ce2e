// SPDX-License-Identifier: GPL-3.0-or-later
#include "twins.h"

#include <numeric>

#include "gate.h"

namespace isograft {

namespace {

MatchOptions few_samples() {
    MatchOptions options;
    options.hierarchy.samples = 300;
    options.hierarchy.min_samples = 200;
    options.scale.mode = ScaleMode::fixed;
    options.threads = 2;
    return options;
}

PreparedPair prepare(const shapes::Shape& source, const shapes::Shape& other, const Eigen::Matrix3d& turn,
                     const Eigen::Vector3d& shift, const MatchOptions& options) {
    MatchReport report;
    Monitor monitor;
    const shapes::Shape target = shapes::renumbered(shapes::moved(other, turn, shift), 5).shape;
    return prepare_pair(gate(source), gate(target), options, report, monitor, 0.0, 1.0);
}

}  // namespace

Twins::Twins(const shapes::Shape& source, const shapes::Shape& other)
    : turn_(shapes::some_rotation()),
      shift_(4.0, -3.0, 2.0),
      options_(few_samples()),
      prepared_(prepare(source, other, turn_, shift_, options_)) {}

const Twins& Twins::of_a_blob() {
    static const Twins twins(shapes::blob(4));
    return twins;
}

PatchSettings Twins::settings() const {
    return {options_.feature, options_.seed, options_.growth, options_.blend, options_.threads, {}};
}

Eigen::Vector3d Twins::truth(const Eigen::Vector3d& x) const { return turn_ * x + shift_ / prepared_.unit; }

OrientedMatch Twins::true_match(int sample) const {
    const SampledMesh& source = pair().source;
    const TriangleMesh& target = pair().target.mesh;
    OrientedMatch match;
    match.sample = sample;
    match.point = shapes::point_nearest(target, truth(source.samples.position[sample]));
    const Eigen::Vector3d axis = turn_ * source.mesh.axis_x[source.samples.point[sample].face];
    match.rotation = unit(flatten(target, match.point.face, axis));
    return match;
}

PartialMap Twins::true_map(const std::vector<int>& samples) const {
    PartialMap map(pair().source.samples.count());
    for (const int s : samples) {
        const OrientedMatch match = true_match(s);
        map.put(pair().target.mesh, s, match.point, match.rotation);
    }
    if (!samples.empty()) map.seed = samples.front();
    measure_seed_distance(pair().source.samples, map);
    return map;
}

std::vector<int> Twins::all_samples() const {
    std::vector<int> samples(pair().source.samples.count());
    std::iota(samples.begin(), samples.end(), 0);
    return samples;
}

double Twins::error(int sample, const Eigen::Vector3d& image) const {
    return (image - truth(pair().source.samples.position[sample])).norm() / spacing();
}

}  // namespace isograft
