// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "feature/pair.h"
#include "growth/partial_map.h"
#include "growth/relax.h"

namespace isograft {

/// How far around a sample relief is compared, and how thoroughly.
struct ReliefScale {
    /// Width of the Gaussian weight, in unit lengths; the piece reaches twice as far.
    double width = 0.08;
    /// Steps of the registration.
    int steps = 3;
    /// Most points of a piece besides its samples.
    int points = 64;
};

/// What the relief of small pieces says: a piece of S that hardly bends lies on T where its bumps and hollows fit.
///
/// Each sample's surroundings are moved rigidly, first as the map says and then by iterated closest points to tangent
/// planes (Chen and Medioni 1992); the sample is drawn to where that puts it. A piece without relief along a
/// direction, as along a cylinder, draws nowhere along it. Lengths cannot see what this sees: a part that slides.
class Relief {
  public:
    /// \param pair must outlive it. O(#V).
    explicit Relief(const Pair& pair);

    /// A model of the registration's energy around a sample's image, in squared unit lengths; nothing where too little
    /// of the surroundings is mapped or near the target.
    [[nodiscard]] std::optional<SampleTerm> term(const PartialMap& map, int sample, const ReliefScale& scale) const;

    /// Least squares of stretch and relief together, see relax(). \param monitor is asked whether to go on.
    void relax(PartialMap& map, const GrowthOptions& options, const ReliefScale& scale, int iterations, int threads,
               Monitor& monitor) const;

  private:
    struct Surroundings {
        std::vector<int> samples;
        std::vector<Eigen::Vector3d> point, normal;
        /// Vertex of T that a point may be near to.
        std::vector<int> near;
        std::vector<double> weight;
    };
    [[nodiscard]] Surroundings surroundings(const PartialMap& map, int sample, const ReliefScale& scale) const;
    [[nodiscard]] int descend(int vertex, const Eigen::Vector3d& x) const;

    const Pair& pair_;
    std::vector<Eigen::Vector3d> sample_normal_;
    /// Per sample the mesh vertices nearest to it.
    std::vector<std::vector<int>> owned_;
};

}  // namespace isograft
