// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "growth/partial_map.h"
#include "growth/relax.h"

namespace isograft {

/// How far and how one map is grown.
struct GrowthRun {
    int max_samples = 1 << 30;
    /// The stretch limit is multiplied by these in turn: the surest samples first.
    std::vector<double> schedule{1.0};
    /// Samples at which the first least squares runs; then at every doubling.
    int first_relax = 14;
    int final_iterations = 2;
    /// For the least squares of large maps.
    int threads = 1;
    /// Factor on GrowthOptions::stretch_limit.
    double slack = 1.0;
    /// Optional: how badly sample `s` fits at `point` under `turn`, about 1 for chance. Enters the order with
    /// `mismatch_weight`.
    std::function<double(int s, const SurfacePoint& point, Complex turn)> mismatch;
    double mismatch_weight = 0.0;
    /// Optional: true refuses the sample there.
    std::function<bool(int s, const SurfacePoint& point, Complex turn)> refuse;
};

/// Grows partial maps from oriented matches (paper sections 4.3 and 4.4). Holds working memory: one a thread.
///
/// A new sample is predicted from every mapped neighbour: the source's edge, turned by the neighbour's angle, is
/// traced on T; points and angles are averaged. It is accepted while the stretch against those neighbours stays below
/// the limit and its image does not collide with that of a sample elsewhere. The surest prediction goes first.
class Grower {
  public:
    /// All lengths in the pair's unit. The references must outlive the grower.
    Grower(const Samples& source, const SampledMesh& target, const GrowthOptions& options);

    /// Grow `map`, which holds at least one sample, in place.
    void grow(PartialMap& map, const GrowthRun& run);

  private:
    struct Carried {
        int version = -1;
        bool ok = false;
        SurfacePoint end;
        Eigen::Vector3d position;
        Complex direction;
    };
    struct Prediction {
        SurfacePoint point;
        Complex rotation;
        double stretch = 0.0;
        /// Length of the mean of the unit rotations predicted: 1 where they agree.
        double concord = 1.0;
        int neighbours = 0;
    };
    struct Queued {
        double key;
        int sample;
        int stamp;
    };
    struct Later {
        bool operator()(const Queued& a, const Queued& b) const {
            return a.key != b.key ? a.key > b.key : a.sample > b.sample;
        }
    };

    void begin(const PartialMap& map);
    const Carried& carried(const PartialMap& map, int edge, int from);
    bool predict(const PartialMap& map, int sample, Prediction& prediction);
    void evaluate(const PartialMap& map, const GrowthRun& run, double limit, int sample);
    void evaluate_around(const PartialMap& map, const GrowthRun& run, double limit, int sample);
    void evaluate_all(const PartialMap& map, const GrowthRun& run, double limit);
    [[nodiscard]] bool collides(const PartialMap& map, int sample, const SurfacePoint& point, int cell) const;
    void occupy(const PartialMap& map);
    void optimise(PartialMap& map, int iterations, double trim, int threads);

    const Samples& source_;
    const TriangleMesh& target_;
    const Samples& target_samples_;
    GrowthOptions options_;

    std::vector<Carried> carried_;
    int version_ = 0;
    std::vector<Prediction> predicted_;
    std::vector<int> stamp_;
    std::vector<int> trimmed_;
    std::vector<std::vector<int>> cell_;
    std::vector<Queued> queue_;
    std::vector<const Carried*> from_;
    std::vector<const SampleEdge*> from_edge_;
    std::vector<Complex> from_source_;
};

}  // namespace isograft
