// SPDX-License-Identifier: GPL-3.0-or-later
#include "feature/descriptor.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Core>

#include "base/parallel.h"
#include "geodesic/trace.h"
#include "isograft/errors.h"

namespace isograft {

void FeatureOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("feature." + what);
    };
    require(radius > 0.0 && radius <= 1.0, "radius must be in (0, 1]");
    require(smoothing >= 0 && smoothing <= 1000, "smoothing must be in [0, 1000]");
    require(squash > 0.0 && std::isfinite(squash), "squash must be positive");
    require(ring_weight >= 0.0 && std::isfinite(ring_weight), "ring_weight must not be negative");
    require(hidden_penalty >= 0.0 && std::isfinite(hidden_penalty), "hidden_penalty must not be negative");
    require(min_visible > 0.0 && min_visible <= 1.0, "min_visible must be in (0, 1]");
}

namespace {

using Ring = Eigen::Array<float, descriptor_angles, 1>;

// Each cell's share of a flat window's area.
constexpr float ring_share(int ring) {
    return (2.0F * static_cast<float>(ring) + 1.0F) / (descriptor_rings * descriptor_rings * descriptor_angles);
}

Eigen::Map<const Ring> ring_of(const std::array<float, 2 * descriptor_cells>& values, int ring, int shift) {
    return Eigen::Map<const Ring>(values.data() + ring * 2 * descriptor_angles + shift);
}

double ring_radius(int ring, double radius) { return (ring + 0.5) / descriptor_rings * radius; }

void measure_visibility(PolarDescriptor& descriptor) {
    float visible = 0.0F;
    for (int r = 0; r < descriptor_rings; ++r) visible += ring_share(r) * ring_of(descriptor.seen, r, 0).sum();
    descriptor.visible = visible;
    descriptor.whole = visible > 0.999F;
}

// How far one sees along every sector before a boundary.
std::array<double, descriptor_angles> visible_radii(const TriangleMesh& mesh, const SurfacePoint& centre,
                                                    double radius) {
    std::array<double, descriptor_angles> result{};
    for (int a = 0; a < descriptor_angles; ++a) {
        const Trace t = trace(mesh, centre, std::polar(1.0, 2.0 * M_PI * a / descriptor_angles), radius);
        result[a] = t.complete ? radius : t.length;
    }
    return result;
}

struct Bins {
    std::array<double, descriptor_cells> weight{};
    std::array<double, descriptor_cells> sum{};
    std::array<double, descriptor_rings> area{};
};

using SeenCells = std::array<bool, descriptor_cells>;

Bins fill_bins(const TriangleMesh& mesh, const Window& window, const std::vector<double>& curvature, double radius,
               const SeenCells& seen) {
    Bins bins;
    for (const int v : window.reached()) {
        const double r = window.distance(v) / radius * descriptor_rings - 0.5;
        if (r >= descriptor_rings) continue;
        double t = window.angle(v) / (2.0 * M_PI) * descriptor_angles;
        t -= std::floor(t / descriptor_angles) * descriptor_angles;
        const int r0 = static_cast<int>(std::floor(r));
        const int t0 = static_cast<int>(std::floor(t));
        for (int dr = 0; dr < 2; ++dr) {
            const int ring = std::max(r0 + dr, 0);
            if (ring >= descriptor_rings) continue;
            for (int da = 0; da < 2; ++da) {
                const int cell = ring * descriptor_angles + (t0 + da) % descriptor_angles;
                if (!seen[cell]) continue;
                const double w =
                    mesh.vertex_area[v] * (dr != 0 ? r - r0 : 1.0 - (r - r0)) * (da != 0 ? t - t0 : 1.0 - (t - t0));
                bins.weight[cell] += w;
                bins.sum[cell] += w * curvature[v];
                bins.area[ring] += w;
            }
        }
    }
    return bins;
}

// The mean of a cell; an empty one takes its nearest filled neighbours of the same ring, or the ring's mean.
double cell_mean(const Bins& bins, int ring, int angle, double ring_mean) {
    const auto index = [&](int a) { return ring * descriptor_angles + (a + descriptor_angles) % descriptor_angles; };
    if (bins.weight[index(angle)] > 0.0) return bins.sum[index(angle)] / bins.weight[index(angle)];
    for (int k = 1; k < 4; ++k) {
        const int left = index(angle + k);
        const int right = index(angle - k);
        const double w = bins.weight[left] + bins.weight[right];
        if (w > 0.0) return (bins.sum[left] + bins.sum[right]) / w;
    }
    return ring_mean;
}

}  // namespace

PolarDescriptor packed(const DescriptorValues& values) {
    PolarDescriptor descriptor;
    for (int c = 0; c < descriptor_cells; ++c) {
        const int first = (c / descriptor_angles) * 2 * descriptor_angles + c % descriptor_angles;
        for (const int i : {first, first + descriptor_angles}) {
            descriptor.cell[i] = static_cast<float>(values.cell[c]);
            descriptor.seen[i] = values.seen[c] ? 1.0F : 0.0F;
        }
    }
    for (int r = 0; r < descriptor_rings; ++r) descriptor.ring[r] = static_cast<float>(values.ring[r]);
    measure_visibility(descriptor);
    return descriptor;
}

double descriptor_distance(const PolarDescriptor& a, const PolarDescriptor& b, int shift,
                           const FeatureOptions& options) {
    if (a.whole && b.whole) {
        float sum = 0.0F;
        for (int r = 0; r < descriptor_rings; ++r) {
            sum += ring_share(r) * (ring_of(a.cell, r, 0) - ring_of(b.cell, r, shift)).square().sum();
        }
        return 3.0 * sum;
    }
    float sum = 0.0F;
    float shared = 0.0F;
    for (int r = 0; r < descriptor_rings; ++r) {
        const Ring both = ring_of(a.seen, r, 0) * ring_of(b.seen, r, shift);
        sum += ring_share(r) * (both * (ring_of(a.cell, r, 0) - ring_of(b.cell, r, shift)).square()).sum();
        shared += ring_share(r) * both.sum();
    }
    if (shared < options.min_visible) return not_comparable;
    return 3.0 * sum / shared + options.hidden_penalty * (1.0 - shared);
}

double ring_distance(const PolarDescriptor& a, const PolarDescriptor& b) {
    double sum = 0.0;
    int count = 0;
    for (int r = 0; r < descriptor_rings; ++r) {
        if (a.ring[r] < 0.0F || b.ring[r] < 0.0F) continue;
        const double d = std::log(a.ring[r] + 0.05) - std::log(b.ring[r] + 0.05);
        sum += d * d;
        ++count;
    }
    return count > 0 ? sum * descriptor_rings / count : 0.5;
}

BestShift best_shift(const PolarDescriptor& a, const PolarDescriptor& b, const FeatureOptions& options) {
    BestShift best;
    const auto consider = [&](int shift) {
        const double d = descriptor_distance(a, b, shift, options);
        if (d < best.distance) best = {d, shift};
    };
    for (int shift = 0; shift < descriptor_angles; shift += 2) consider(shift);
    const int middle = best.shift;
    consider((middle + 1) % descriptor_angles);
    consider((middle + descriptor_angles - 1) % descriptor_angles);
    return best;
}

Complex rotation_of(int shift) { return std::polar(1.0, 2.0 * M_PI * shift / descriptor_angles); }

int shift_of(Complex rotation) {
    const int shift = static_cast<int>(std::lround(std::arg(rotation) / (2.0 * M_PI) * descriptor_angles));
    return (shift % descriptor_angles + descriptor_angles) % descriptor_angles;
}

DescriptorValues window_values(const TriangleMesh& mesh, Window& window, const SurfacePoint& centre,
                               const std::vector<double>& curvature, double unit, const FeatureOptions& options) {
    const double radius = options.radius * unit;
    window.run(centre, 1.05 * radius + mesh.mean_edge);
    bool near_boundary = false;
    for (const int v : window.reached()) {
        near_boundary = near_boundary || (mesh.on_boundary[v] != 0 && window.distance(v) < 1.05 * radius);
    }
    DescriptorValues values;
    SeenCells& seen = values.seen;
    seen.fill(true);
    if (near_boundary) {
        const auto sight = visible_radii(mesh, centre, radius);
        for (int c = 0; c < descriptor_cells; ++c) {
            seen[c] = ring_radius(c / descriptor_angles, radius) <= sight[c % descriptor_angles];
        }
    }
    const Bins bins = fill_bins(mesh, window, curvature, radius, seen);
    for (int r = 0; r < descriptor_rings; ++r) {
        double sum = 0.0;
        double weight = 0.0;
        int visible = 0;
        for (int a = 0; a < descriptor_angles; ++a) {
            const int cell = r * descriptor_angles + a;
            sum += bins.sum[cell];
            weight += bins.weight[cell];
            visible += seen[cell] ? 1 : 0;
        }
        const double mean = weight > 0.0 ? sum / weight : 0.0;
        for (int a = 0; a < descriptor_angles; ++a) {
            const double h = cell_mean(bins, r, a, mean) * unit;
            values.cell[r * descriptor_angles + a] = std::atan(options.squash * h);
        }
        const double flat = M_PI * radius * radius * (2 * r + 1) / (descriptor_rings * descriptor_rings);
        const bool enough = visible >= descriptor_angles / 3;
        values.ring[r] = enough ? bins.area[r] / flat * descriptor_angles / visible : -1.0;
    }
    return values;
}

PolarDescriptor window_descriptor(const TriangleMesh& mesh, Window& window, const SurfacePoint& centre,
                                  const std::vector<double>& curvature, double unit, const FeatureOptions& options) {
    return packed(window_values(mesh, window, centre, curvature, unit, options));
}

DescriptorValues ray_values(const TriangleMesh& mesh, const SurfacePoint& centre, const std::vector<double>& curvature,
                            double radius, double gain, double phase, const FeatureOptions& options) {
    DescriptorValues values;
    values.ring.fill(1.0);
    for (int a = 0; a < descriptor_angles; ++a) {
        Walker walker(mesh, centre, std::polar(1.0, 2.0 * M_PI * a / descriptor_angles + phase));
        int ring = 0;
        // A ray that cannot go on leaves its outer cells unseen.
        for (int step = 0; step < 2000 && ring < descriptor_rings; ++step) {
            while (ring < descriptor_rings) {
                const double left = ring_radius(ring, radius) - walker.travelled();
                if (left > walker.inside()) break;
                const SurfacePoint p = point_at(mesh, walker.face(), walker.at(std::max(left, 0.0)));
                double h = 0.0;
                for (int k = 0; k < 3; ++k) h += p.weight[k] * curvature[mesh.face[p.face][k]];
                values.cell[ring * descriptor_angles + a] = std::atan(options.squash * gain * h);
                values.seen[ring * descriptor_angles + a] = true;
                ++ring;
            }
            if (ring == descriptor_rings || !walker.advance()) break;
        }
    }
    return values;
}

PolarDescriptor ray_descriptor(const TriangleMesh& mesh, const SurfacePoint& centre,
                               const std::vector<double>& curvature, double radius, double gain, double phase,
                               const FeatureOptions& options) {
    return packed(ray_values(mesh, centre, curvature, radius, gain, phase, options));
}

std::vector<PolarDescriptor> window_descriptors(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points,
                                                const std::vector<double>& curvature, double unit,
                                                const FeatureOptions& options, int threads, Monitor& monitor,
                                                double from, double to) {
    std::vector<PolarDescriptor> result(points.size());
    std::vector<Window> windows(worker_count(threads), Window(mesh));
    parallel_for(
        static_cast<int>(points.size()), threads,
        [&](int i, int worker) {
            result[i] = window_descriptor(mesh, windows[worker], points[i], curvature, unit, options);
        },
        monitor, "features", from, to);
    return result;
}

}  // namespace isograft
