// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/piece.h"
#include "feature/pair.h"
#include "hierarchy/coarse_mesh.h"
#include "isograft/match.h"

namespace isograft {

/// A surface with the coarse mesh that serves every setting in which it is the larger one; in its own unit.
struct Side {
    Surface surface;
    CoarseMesh coarse;
    /// Edge length of `coarse`; 0 if meshes are used as they are.
    double edge = 0.0;
};

/// \throw Cancelled if `progress` says so.
Side make_side(const Surface& surface, const HierarchyOptions& options, Piece progress);

/// One surface of a pair at one size and sample spacing: all that does not depend on the other surface.
struct Half {
    Detail detail;
    SampledMesh sampled;
    std::vector<double> curvature, fine_curvature;
    std::vector<PolarDescriptor> descriptor;
};

/// What a half is made from.
struct HalfRequest {
    const Side* side = nullptr;
    /// Pair's units per unit of the surface.
    double factor = 1.0;
    double spacing = 0.0;
    std::uint64_t seed = 0;
    /// Input vertices that are to be samples.
    std::vector<int> fixed;

    bool operator==(const HalfRequest&) const = default;
};

/// Makes the two halves of settings one after the other; a half that the last setting had too is not made again.
class Halves {
  public:
    using Both = std::array<std::shared_ptr<const Half>, 2>;

    /// \param report seconds and bytes of the stages `samples` and `features` are added.
    const Both& make(const std::array<HalfRequest, 2>& requests, const MatchOptions& options, MatchReport& report,
                     Monitor& monitor, double from, double to);

  private:
    std::array<HalfRequest, 2> request_;
    Both half_;
};

/// Add to a stage of the report.
void note(MatchReport& report, const std::string& stage, double seconds, std::int64_t bytes);

}  // namespace isograft
