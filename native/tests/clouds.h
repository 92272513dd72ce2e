// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/random.h"
#include "isograft/surface.h"

namespace isograft::clouds {

/// A surface known in closed form, to take points from and to measure against.
struct Analytic {
    std::string name;
    double area;
    /// Evenly distributed by area.
    std::function<Eigen::Vector3d(Random&)> sample;
    /// Signed distance, positive outside, and unit outward normal, near the surface.
    std::function<double(const Eigen::Vector3d&)> height;
    std::function<Eigen::Vector3d(const Eigen::Vector3d&)> normal;
};

/// The unit square in z = 0; the sphere of radius 1; an open tube of radius 0.3 and height 1; a torus of radii 1 and
/// 0.4.
Analytic plane();
Analytic sphere();
Analytic cylinder();
Analytic torus();
std::vector<Analytic> all();

/// `count` points, moved along the normal by a normal distribution of `noise` spacings, the spacing being
/// sqrt(area / count).
Points sampled(const Analytic& surface, int count, double noise, std::uint64_t seed);
double spacing_of(const Analytic& surface, int count);

/// Both, one after the other.
Points joined(const Points& a, const Points& b);

/// What the gate says when it refuses the cloud; empty if it does not.
std::string refusal(const Points& points, const Points& normals = Points(0, 3));

/// Edges with a triangle on one side only, closed curves of them, and V - E + F.
struct Topology {
    int open_edges, loops, euler;
};
Topology topology(const TriangleMesh& mesh);

}  // namespace isograft::clouds
