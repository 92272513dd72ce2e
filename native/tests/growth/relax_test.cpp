// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/relax.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "gate.h"
#include "geodesic/shoot.h"
#include "shapes.h"

namespace isograft {
namespace {

Samples sample(const TriangleMesh& mesh, int count) {
    Monitor monitor;
    return make_samples(mesh, sample_spacing(mesh.area, count), {}, 0, 2, monitor, 0.0, 1.0);
}

PartialMap identity(const TriangleMesh& mesh, const Samples& samples) {
    PartialMap map(samples.count());
    for (int s = 0; s < samples.count(); ++s) map.put(mesh, s, samples.point[s], Complex(1.0, 0.0));
    map.seed = 0;
    return map;
}

// Every image walked off by up to `share` of the spacing, its rotation carried along.
PartialMap disturbed(const TriangleMesh& mesh, const Samples& samples, double share) {
    Random random(1);
    PartialMap map = identity(mesh, samples);
    for (int s = 0; s < samples.count(); ++s) {
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const Trace t = trace(mesh, samples.point[s], d, share * samples.spacing * random.uniform());
        map.put(mesh, s, t.end, t.direction / d);
    }
    return map;
}

double mean_error(const Samples& samples, const PartialMap& map) {
    double sum = 0.0;
    for (int s = 0; s < samples.count(); ++s) sum += (map.position[s] - samples.position[s]).norm();
    return sum / samples.count() / samples.spacing;
}

TEST(StretchDerivative, AgreesWithFiniteDifferences) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    Random random(2);
    int count = 0;
    for (int i = 0; i < 100; ++i) {
        SurfacePoint u;
        u.face = random.below(mesh.face_count());
        const Complex d = std::polar(1.0, 2.0 * M_PI * random.uniform());
        const double length = 0.2 + 0.4 * random.uniform();
        const Trace t = trace(mesh, u, d, length);
        const SurfacePoint v = point_at(mesh, t.end.face, planar(mesh, t.end));
        // Away from edges, so that a step stays in its triangle.
        if (*std::min_element(v.weight.begin(), v.weight.end()) < 0.05) continue;
        const StretchDerivative here = stretch_derivative(mesh, u, v, d, length);
        EXPECT_NEAR(here.residual, 0.0, 1e-6);
        ++count;
        const double h = 1e-4 * mesh.mean_edge;
        for (const Complex e : {Complex(1.0, 0.0), Complex(0.0, 1.0)}) {
            const auto residual = [&](double du, double dv) {
                const SurfacePoint a = point_at(mesh, u.face, planar(mesh, u) + du * e);
                const SurfacePoint b = point_at(mesh, v.face, planar(mesh, v) + dv * e);
                return stretch_derivative(mesh, a, b, d, length).residual;
            };
            EXPECT_NEAR((residual(h, 0.0) - residual(-h, 0.0)) / (2.0 * h), dot(here.by_u, e), 2e-3);
            EXPECT_NEAR((residual(0.0, h) - residual(0.0, -h)) / (2.0 * h), dot(here.by_v, e), 2e-3);
        }
    }
    EXPECT_GT(count, 50);
}

TEST(Relax, LeavesAnIsometryWhereItIs) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 250);
    PartialMap map = identity(mesh, samples);
    const auto stretch = relax(samples, mesh, {}, {.iterations = 5, .term_weight = 0.0, .term = {}, .trim = 0.1}, map);
    EXPECT_EQ(map.count, samples.count());
    EXPECT_LT(map.stress, 0.005);
    EXPECT_LT(mean_error(samples, map), 0.01);
    EXPECT_LT(shapes::mean(stretch), 0.005);
    for (const Complex r : map.rotation) EXPECT_LT(std::abs(std::arg(r)), 0.1);
}

TEST(Relax, BringsDisturbedImagesBack) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 250);
    PartialMap map = disturbed(mesh, samples, 0.3);
    const double before = mean_error(samples, map);
    PartialMap once = map;
    relax(samples, mesh, {}, {.iterations = 2, .term_weight = 0.0, .term = {}, .trim = 0.0}, once);
    relax(samples, mesh, {}, {.iterations = 30, .term_weight = 0.0, .term = {}, .trim = 0.0}, map);
    EXPECT_LT(mean_error(samples, once), 0.5 * before);
    EXPECT_LT(mean_error(samples, map), 0.15 * before);
    EXPECT_LT(map.stress, 0.01);
    EXPECT_LE(map.stress, once.stress * (1.0 + 1e-9));
}

TEST(Relax, DropsWhatStaysStretchedAndOnlyThen) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 250);
    auto shape = shapes::blob(4);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        // One side drawn out to twice its length, the other as it was.
        if (shape.vertices(v, 2) > 0.0) shape.vertices(v, 2) *= 2.0;
    }
    const TriangleMesh longer = shapes::mesh_of(shape);
    PartialMap kept = identity(longer, samples), trimmed = kept;
    const auto stretch =
        relax(samples, longer, {}, {.iterations = 1, .term_weight = 0.0, .term = {}, .trim = 0.0}, kept);
    relax(samples, longer, {}, {.iterations = 1, .term_weight = 0.0, .term = {}, .trim = 0.2}, trimmed);
    EXPECT_EQ(kept.count, samples.count());
    EXPECT_LT(trimmed.count, samples.count());
    EXPECT_GT(trimmed.count, samples.count() / 4);
    for (int s = 0; s < samples.count(); ++s) EXPECT_EQ(trimmed.mapped[s] != 0, stretch[s] <= 0.2);
}

TEST(Relax, FollowsATermWhereTheStretchDoesNotMind) {
    // A sheet inside a larger one may slide freely.
    const TriangleMesh small = shapes::mesh_of(shapes::grid(20, 20, 0.1, 0.1));
    const TriangleMesh large =
        shapes::mesh_of(shapes::moved(shapes::grid(40, 40, 0.1, 0.1), Eigen::Matrix3d::Identity(), {-1.0, -1.0, 0.0}));
    const Samples samples = sample(small, 150);
    PartialMap map(samples.count());
    for (int s = 0; s < samples.count(); ++s) {
        const SurfacePoint p = shapes::point_nearest(large, samples.position[s]);
        const Complex turn = flatten(large, p.face, small.axis_x[samples.point[s].face]);
        map.put(large, s, p, turn);
    }
    const Eigen::Vector3d pull(0.06, -0.04, 0.0);
    RelaxSettings settings;
    settings.iterations = 6;
    settings.term_weight = 1.0;
    settings.term = [&](const PartialMap& now, std::vector<SampleTerm>& terms) {
        for (int s = 0; s < samples.count(); ++s) {
            const Complex way = flatten(large, now.image[s].face, samples.position[s] + pull - now.position[s]);
            terms[s] = {-way.real(), -way.imag(), 1.0, 0.0, 1.0};
        }
    };
    relax(samples, large, {}, settings, map);
    for (int s = 0; s < samples.count(); ++s) {
        EXPECT_LT((map.position[s] - samples.position[s] - pull).norm(), 0.02 * pull.norm());
    }
    EXPECT_LT(map.stress, 0.005);
}

TEST(Relax, IsTheSameEveryTime) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    const Samples samples = sample(mesh, 150);
    PartialMap a = disturbed(mesh, samples, 0.2), b = a;
    relax(samples, mesh, {}, {}, a);
    relax(samples, mesh, {}, {}, b);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.rotation, b.rotation);
    EXPECT_EQ(a.stress, b.stress);
}

}  // namespace
}  // namespace isograft
