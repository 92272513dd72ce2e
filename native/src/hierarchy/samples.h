// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geodesic/surface_point.h"
#include "geodesic/window.h"
#include "isograft/monitor.h"
#include "isograft/options/hierarchy.h"

namespace isograft {

/// A geodesic between two samples.
struct SampleEdge {
    int u = -1;
    int v = -1;
    double length = 0.0;
    /// Unit direction at u towards v, and at v towards u, each in its sample's frame.
    Complex at_u, at_v;
    /// The lowest level whose reach holds the length.
    int level = 0;
    /// Samples along a long edge: it holds inside a map only if these are mapped too.
    std::vector<int> witnesses;

    [[nodiscard]] int other(int sample) const { return sample == u ? v : u; }
};

/// A sample seen from a vertex.
struct NearSample {
    int sample = -1;
    float distance = 0.0F;
    /// Angle at the sample towards the vertex.
    float angle = 0.0F;
};

/// Evenly spaced surface points with nested levels and the edges between them. Frames are those of the samples'
/// triangles.
struct Samples {
    double spacing = 0.0;
    std::vector<SurfacePoint> point;
    std::vector<Eigen::Vector3d> position;
    /// Per sample the highest level it belongs to.
    std::vector<int> level;
    /// Per sample the area of the vertices nearest to it.
    std::vector<double> area;
    std::vector<SampleEdge> edges;
    /// Per sample the indices of its edges, of all levels and of level 0.
    std::vector<std::vector<int>> edges_of, base_edges_of;
    /// Per mesh vertex its nearest sample, -1 where none is in reach.
    std::vector<int> owner;
    /// Per mesh vertex the samples within 1.6 spacings (and at least the nearest), by rising sample index.
    std::vector<std::vector<NearSample>> near_vertex;

    [[nodiscard]] int count() const { return static_cast<int>(point.size()); }
    /// The sample nearest to a surface point, in space, among those around its triangle; -1 if none is near.
    [[nodiscard]] int nearest(const TriangleMesh& mesh, const SurfacePoint& p) const;
    [[nodiscard]] std::int64_t bytes() const;
};

/// One surface with its samples, in lengths of the pair's unit.
struct SampledMesh {
    TriangleMesh mesh;
    Samples samples;
};

/// What a straight edge has to be.
struct StraightEdgeOptions {
    /// Of the shot, see ShootOptions.
    double tolerance = 0.002;
    /// Relative difference of length from the window's path up to which it is the same path.
    double same_path = 0.08;
};

/// The straight geodesic near a window's path between two samples, of level 0; nothing where it is another one. Long
/// polar maps are off by a few per cent where curvature is strong, and bend at saddles.
std::optional<SampleEdge> straight_edge(const TriangleMesh& mesh, const Samples& samples, int u, int v,
                                        const Polar& polar, const StraightEdgeOptions& options);

/// The spacing at which `samples` points fill an area of `area`.
double sample_spacing(double area, int samples);

/// Spread samples over a mesh, join them, and number their levels (paper section 4.1).
///
/// Samples are picked by Poisson disks of geodesic radius `spacing` in seeded random order, whatever the
/// triangulation; level j + 1 is picked from level j with twice the radius. Edges are walked straight on the surface,
/// so none joins two sheets that merely pass close to each other.
/// \param spacing r0 in mesh units. O(#V) windows of a few spacings.
/// This is spread_samples() and join_samples(), one after the other. \throw Cancelled if `monitor` asks for it.
/// \param fixed points that are samples whatever their distance from each other: samples 0, 1, ... in this order.
Samples make_samples(const TriangleMesh& mesh, double spacing, const HierarchyOptions& options, std::uint64_t seed,
                     int threads, Monitor& monitor, double from, double to,
                     const std::vector<SurfacePoint>& fixed = {});

/// Points and levels only; one thread, since every pick depends on those before.
Samples spread_samples(const TriangleMesh& mesh, double spacing, const HierarchyOptions& options, std::uint64_t seed,
                       Monitor& monitor, const std::vector<SurfacePoint>& fixed = {});

/// Edges, and all that follows from them.
void join_samples(const TriangleMesh& mesh, Samples& samples, const HierarchyOptions& options, int threads,
                  Monitor& monitor, double from, double to);

}  // namespace isograft
