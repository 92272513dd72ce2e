// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/refine.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include "base/parallel.h"
#include "geodesic/trace.h"
#include "growth/relax.h"
#include "growth/relief.h"

namespace isograft {

namespace {

// What is compared, and how far around an image it is tried.
struct Scale {
    /// Of the rays, in unit lengths.
    double radius;
    /// Between the places tried, in spacings.
    double step;
    /// Of the term, in DenseOptions::refine_weight.
    double weight;
};
constexpr Scale coarse{0.1, 0.8, 2.0};
// Small enough to tell a centimetre on a body, large enough to see shape.
constexpr Scale fine{0.06, 0.4, 1.0};
// A piece that shows its place, and one that shows it exactly.
constexpr ReliefScale wide_relief{.width = 0.08}, narrow_relief{.width = 0.05};
// A distance at which the term has lost half its pull.
constexpr double soft = 0.02;

struct Stencil {
    double value[3][3];
    double step;
};

std::optional<Stencil> sample_stencil(const Pair& pair, const std::vector<double>& curvature,
                                      const PolarDescriptor& wanted, const SurfacePoint& centre, Complex rotation,
                                      const FeatureOptions& features, const Scale& scale) {
    Stencil stencil{};
    stencil.step = scale.step * pair.source.samples.spacing;
    for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
            SurfacePoint point = centre;
            Complex turn = rotation;
            if (i != 0 || j != 0) {
                const Complex offset(i * stencil.step, j * stencil.step);
                const Trace t = trace(pair.target.mesh, centre, offset, std::abs(offset));
                if (!t.complete) return std::nullopt;
                point = t.end;
                turn *= t.direction * std::conj(unit(offset));
            }
            const PolarDescriptor seen =
                ray_descriptor(pair.target.mesh, point, curvature, scale.radius, 1.0, std::arg(turn), features);
            const double d = descriptor_distance(wanted, seen, 0, features);
            if (d >= 0.5 * not_comparable) return std::nullopt;
            stencil.value[i + 1][j + 1] = d;
        }
    }
    return stencil;
}

// The least squares parabola through the stencil, made convex enough not to throw the point out of it.
SampleTerm fit_term(const Stencil& stencil) {
    const auto& v = stencil.value;
    const double h = stencil.step;
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
    for (int k = 0; k < 3; ++k) {
        gradient += Eigen::Vector2d(v[2][k] - v[0][k], v[k][2] - v[k][0]) / 6.0;
        hessian(0, 0) += (v[2][k] - 2.0 * v[1][k] + v[0][k]) / 3.0;
        hessian(1, 1) += (v[k][2] - 2.0 * v[k][1] + v[k][0]) / 3.0;
    }
    hessian(0, 1) = hessian(1, 0) = 0.25 * (v[2][2] - v[2][0] - v[0][2] + v[0][0]);
    gradient /= h;
    hessian /= h * h;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(hessian);
    const Eigen::Vector2d bounded = solver.eigenvalues().cwiseMax(gradient.norm() / (1.5 * h) + 1e-6);
    hessian = solver.eigenvectors() * bounded.asDiagonal() * solver.eigenvectors().transpose();
    const double scale = soft / (soft + v[1][1]);
    gradient *= scale;
    hessian *= scale;
    return {gradient[0], gradient[1], hessian(0, 0), hessian(0, 1), hessian(1, 1)};
}

}  // namespace

void refine(PartialMap& map, const Pair& pair, const FeatureOptions& features, const GrowthOptions& growth,
            const DenseOptions& options, int threads, Monitor& monitor, double from, double to) {
    const Samples& source = pair.source.samples;
    const int relieving = options.refine_relief_iterations;
    const int all = options.refine_coarse_iterations + 2 * relieving + options.refine_iterations;
    if (options.refine_weight <= 0.0 || all == 0 || map.count == 0) return;
    int done = 0;
    const auto slide = [&](const Scale& scale, int iterations, const std::vector<double>& source_curvature,
                           const std::vector<double>& target_curvature) {
        if (iterations == 0) return;
        std::vector<PolarDescriptor> wanted(source.count());
        parallel_for(
            source.count(), threads,
            [&](int s, int /*worker*/) {
                if (map.mapped[s]) {
                    wanted[s] = ray_descriptor(pair.source.mesh, source.point[s], source_curvature, scale.radius, 1.0,
                                               0.0, features);
                }
            },
            monitor, "refinement", from, from);
        RelaxSettings settings;
        settings.iterations = iterations;
        settings.threads = threads;
        settings.term_weight = scale.weight * options.refine_weight;
        settings.term = [&](const PartialMap& now, std::vector<SampleTerm>& terms) {
            const double begin = from + (to - from) * done / all;
            ++done;
            parallel_for(
                source.count(), threads,
                [&](int s, int /*worker*/) {
                    if (!now.mapped[s]) return;
                    const auto stencil = sample_stencil(pair, target_curvature, wanted[s], now.image[s],
                                                        now.rotation[s], features, scale);
                    if (stencil) terms[s] = fit_term(*stencil);
                },
                monitor, "refinement", begin, from + (to - from) * done / all);
        };
        relax(source, pair.target.mesh, growth, settings, map);
    };
    slide(coarse, options.refine_coarse_iterations, pair.source_curvature, pair.target_curvature);
    const Relief relief(pair);
    for (const ReliefScale& scale : {wide_relief, narrow_relief}) {
        relief.relax(map, growth, scale, relieving, threads, monitor);
        done += relieving;
        monitor.report("refinement", from + (to - from) * done / all);
    }
    slide(fine, options.refine_iterations, pair.source_detail, pair.target_detail);
}

}  // namespace isograft
