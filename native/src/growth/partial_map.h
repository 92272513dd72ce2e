// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "geodesic/surface_point.h"
#include "hierarchy/samples.h"
#include "isograft/options/growth.h"

namespace isograft {

/// A map f of a region U of S: which samples of S it holds, where they go on T, and how their frames turn.
struct PartialMap {
    std::vector<char> mapped;
    std::vector<SurfacePoint> image;
    /// Image in space, beside `image` because everybody asks for it.
    std::vector<Eigen::Vector3d> position;
    /// Unit number that takes a direction in the source sample's frame to one in the image triangle's frame.
    std::vector<Complex> rotation;
    /// Way from the seed over level-0 edges inside U; large where there is none.
    std::vector<float> seed_distance;
    int count = 0;
    int seed = -1;
    /// Root mean square relative stretch over the edges inside U, after the last least squares.
    double stress = 0.0;

    explicit PartialMap(int samples = 0);
    void put(const TriangleMesh& target, int sample, const SurfacePoint& point, Complex turn);
    void drop(int sample);
};

/// How many samples two maps share, and how many of these they put in one place.
struct Overlap {
    int shared = 0;
    int agreed = 0;
};
/// \param radius images nearer than this are in one place.
Overlap overlap_of(const PartialMap& a, const PartialMap& b, double radius);

/// Per sample of S the sample of T nearest to its image, see Samples::nearest(); -1 where it is unmapped or none is
/// near.
std::vector<int> homes_of(const PartialMap& map, const SampledMesh& target);

/// Recompute `seed_distance` from `map.seed` over the mapped samples.
void measure_seed_distance(const Samples& source, PartialMap& map);

/// An edge holds inside U if its ends and everything along it are mapped (paper: geodesics only inside U and f(U)).
bool is_active(const SampleEdge& edge, const PartialMap& map);

}  // namespace isograft
