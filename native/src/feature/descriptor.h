// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geodesic/surface_point.h"
#include "geodesic/window.h"
#include "isograft/monitor.h"
#include "isograft/options/feature.h"

namespace isograft {

constexpr int descriptor_rings = 6;
constexpr int descriptor_angles = 24;
constexpr int descriptor_cells = descriptor_rings * descriptor_angles;
/// The distance of two descriptors that share too little to be compared.
constexpr double not_comparable = 10.0;

/// Smoothed mean curvature around a surface point, in rings of distance and sectors of angle in the frame of the
/// point's triangle, with the share of each ring's area against a flat one.
///
/// Comparing two at every shift of the angle gives the direction with the point: an oriented match from one point.
/// Replaces the geodesic fingerprint of the paper (section 4.2), which has no angle.
struct PolarDescriptor {
    /// Squashed curvature, ring by ring, every ring twice in a row, so that a shifted ring is one run of memory.
    std::array<float, 2 * descriptor_cells> cell{};
    /// 1 where the cell can be seen from the centre, 0 behind a boundary; laid out like `cell`.
    std::array<float, 2 * descriptor_cells> seen{};
    /// Area of the seen part of a ring over that of a flat one; -1 where less than a third is seen.
    std::array<float, descriptor_rings> ring{};
    /// Share of the window that is seen.
    float visible = 1.0F;
    bool whole = true;
};

/// What a descriptor says, before it is stored in single precision.
struct DescriptorValues {
    /// Squashed curvature, ring by ring; 0 where a ray saw nothing.
    std::array<double, descriptor_cells> cell{};
    std::array<bool, descriptor_cells> seen{};
    /// As PolarDescriptor::ring.
    std::array<double, descriptor_rings> ring{};
};
PolarDescriptor packed(const DescriptorValues& values);

/// Distance of `a` and `b` turned by `shift` sectors, >= 0 (curvature cells only; mean squared, rings weighted by
/// area).
double descriptor_distance(const PolarDescriptor& a, const PolarDescriptor& b, int shift,
                           const FeatureOptions& options);

/// Distance of the ring areas, >= 0: mean squared difference of logarithms times the number of rings.
double ring_distance(const PolarDescriptor& a, const PolarDescriptor& b);

/// The shift at which `a` and `b` are nearest.
struct BestShift {
    double distance = not_comparable;
    int shift = 0;
};
BestShift best_shift(const PolarDescriptor& a, const PolarDescriptor& b, const FeatureOptions& options);

/// The rotation that a shift of sectors stands for, and the shift nearest to a rotation.
Complex rotation_of(int shift);
int shift_of(Complex rotation);

/// Descriptor from a geodesic window: every vertex in it adds to its cell. Accurate; for ranking matches.
/// \param curvature per vertex. \param unit the pair's unit length, in mesh units.
DescriptorValues window_values(const TriangleMesh& mesh, Window& window, const SurfacePoint& centre,
                               const std::vector<double>& curvature, double unit, const FeatureOptions& options);
/// The same, stored.
PolarDescriptor window_descriptor(const TriangleMesh& mesh, Window& window, const SurfacePoint& centre,
                                  const std::vector<double>& curvature, double unit, const FeatureOptions& options);

/// Descriptor from straight rays, `radius` long (mesh units), the first at `phase`: a twentieth of the cost, a little
/// less sharp, without ring areas. For scale and refinement.
/// \param gain multiplies the curvature: one over the scale that brings the mesh to the pair's unit length.
DescriptorValues ray_values(const TriangleMesh& mesh, const SurfacePoint& centre, const std::vector<double>& curvature,
                            double radius, double gain, double phase, const FeatureOptions& options);
/// The same, stored.
PolarDescriptor ray_descriptor(const TriangleMesh& mesh, const SurfacePoint& centre,
                               const std::vector<double>& curvature, double radius, double gain, double phase,
                               const FeatureOptions& options);

/// Window descriptors of many points, equal bit for bit for any number of threads. \throw Cancelled on request.
std::vector<PolarDescriptor> window_descriptors(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points,
                                                const std::vector<double>& curvature, double unit,
                                                const FeatureOptions& options, int threads, Monitor& monitor,
                                                double from, double to);

}  // namespace isograft
