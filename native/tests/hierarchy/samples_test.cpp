// SPDX-License-Identifier: GPL-3.0-or-later
#include "hierarchy/samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "gate.h"
#include "geodesic/trace.h"
#include "geodesic/window.h"
#include "isograft/errors.h"
#include "shapes.h"

namespace isograft {
namespace {

Samples sample(const TriangleMesh& mesh, int count, int threads = 1, std::uint64_t seed = 0,
               const std::vector<SurfacePoint>& fixed = {}) {
    Monitor monitor;
    return make_samples(mesh, sample_spacing(mesh.area, count), {}, seed, threads, monitor, 0.0, 1.0, fixed);
}

// Distances from each sample to all others, in full windows.
std::vector<std::vector<double>> distances(const TriangleMesh& mesh, const Samples& samples) {
    Window window(mesh);
    std::vector<std::vector<double>> result;
    for (const SurfacePoint& p : samples.point) {
        window.run(p, 1e9);
        result.emplace_back();
        for (const SurfacePoint& q : samples.point) {
            const auto polar = window.query(q);
            result.back().push_back(polar ? polar->distance : 1e9);
        }
    }
    return result;
}

TEST(Samples, AreAsManyAsAskedForWithinAFifthWhateverTheTriangulation) {
    for (const auto& shape : {shapes::blob(4), shapes::grid(60, 60, 0.1, 0.1), shapes::grid(20, 200, 0.3, 0.03),
                              shapes::torus(40, 20, 1.0, 0.4)}) {
        const TriangleMesh mesh = shapes::mesh_of(shape);
        EXPECT_NEAR(sample(mesh, 400).count(), 400, 80);
    }
}

TEST(Samples, KeepTheirDistanceAndLeaveNoHoles) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 300);
    const auto d = distances(mesh, samples);
    for (int i = 0; i < samples.count(); ++i) {
        for (int j = 0; j < i; ++j) EXPECT_GT(d[i][j], 0.98 * samples.spacing);
    }
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        ASSERT_GE(samples.owner[v], 0);
        Window window(mesh);
        window.run(samples.point[samples.owner[v]], 1.4 * samples.spacing);
        EXPECT_TRUE(window.has(v) && window.distance(v) < 1.25 * samples.spacing) << v;
    }
}

TEST(Samples, HaveNestedLevelsOfDoubledSpacing) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 300);
    const auto d = distances(mesh, samples);
    const int top = *std::max_element(samples.level.begin(), samples.level.end());
    EXPECT_EQ(top, HierarchyOptions{}.levels - 1);
    for (int level = 1; level <= top; ++level) {
        const double radius = samples.spacing * (1 << level);
        for (int i = 0; i < samples.count(); ++i) {
            double nearest = 1e9;
            for (int j = 0; j < samples.count(); ++j) {
                if (samples.level[j] < level || j == i) continue;
                nearest = std::min(nearest, d[i][j]);
            }
            if (samples.level[i] >= level) {
                EXPECT_GT(nearest, 0.97 * radius);
            } else if (samples.level[i] == level - 1) {
                EXPECT_LT(nearest, 1.03 * radius);
            }
        }
    }
}

TEST(Samples, AreJoinedByGeodesicsThatArriveAndAgreeAtBothEnds) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 300);
    int base = 0, astray = 0;
    for (const SampleEdge& e : samples.edges) {
        EXPECT_LT(e.u, e.v);
        EXPECT_NEAR(std::abs(e.at_u), 1.0, 1e-12);
        EXPECT_NEAR(std::abs(e.at_v), 1.0, 1e-12);
        const Trace there = trace(mesh, samples.point[e.u], e.at_u, e.length);
        astray += (position(mesh, there.end) - samples.position[e.v]).norm() > 0.01 * e.length;
        const Trace back = trace(mesh, samples.point[e.v], e.at_v, e.length);
        EXPECT_LT((position(mesh, back.end) - samples.position[e.u]).norm(), 0.08 * e.length);
        base += e.level == 0;
        EXPECT_TRUE(e.level == 0 || e.length > HierarchyOptions{}.base_reach * samples.spacing * 0.9);
    }
    EXPECT_LT(astray, 0.01 * static_cast<double>(samples.edges.size()));
    // Around each of a Poisson disk sampling about nine others are within 2.3 spacings.
    EXPECT_GT(base, 4 * samples.count());
}

TEST(Samples, AreJoinedToEveryoneInReachOnThePlane) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::grid(60, 60, 0.1, 0.1));
    const Samples samples = sample(mesh, 300);
    const double reach = HierarchyOptions{}.base_reach * samples.spacing;
    std::vector<std::vector<char>> joined(samples.count(), std::vector<char>(samples.count(), 0));
    for (const SampleEdge& e : samples.edges) {
        joined[e.u][e.v] = joined[e.v][e.u] = 1;
        EXPECT_NEAR(e.length, (samples.position[e.u] - samples.position[e.v]).norm(), 1e-3 * e.length);
    }
    for (int i = 0; i < samples.count(); ++i) {
        for (int j = 0; j < i; ++j) {
            const double d = (samples.position[i] - samples.position[j]).norm();
            if (d < 0.999 * reach) {
                EXPECT_TRUE(joined[i][j]) << i << " " << j << " " << d / samples.spacing;
            }
        }
    }
}

TEST(Samples, AreNotJoinedAcrossSheetsThatLieClose) {
    // A strip folded into a hairpin: near in space, far along the surface.
    auto strip = shapes::grid(80, 20, 0.1, 0.1);
    for (Eigen::Index v = 0; v < strip.vertices.rows(); ++v) {
        const double s = strip.vertices(v, 0) - 4.0, r = 0.02;
        const double turn = std::clamp(s / r, -0.5 * M_PI, 0.5 * M_PI);
        const double past = std::abs(s) - 0.5 * M_PI * r;
        strip.vertices(v, 0) = r * std::cos(turn) - std::max(past, 0.0);
        strip.vertices(v, 2) = r * std::sin(turn);
    }
    const Surface surface = gate(strip);
    const TriangleMesh& mesh = surface.mesh_with_paths();
    const Samples samples = sample(mesh, 300);
    int sheets[2] = {0, 0};
    for (const SampleEdge& e : samples.edges) {
        const Eigen::Vector3d a = samples.position[e.u], b = samples.position[e.v];
        if (a.z() * b.z() < 0.0) {
            EXPECT_GE(e.length, 0.99 * (std::abs(a.x()) + std::abs(b.x())));
        } else {
            ++sheets[a.z() > 0.0];
        }
    }
    EXPECT_GT(sheets[0], 500);
    EXPECT_GT(sheets[1], 500);
}

TEST(Samples, GiveTheirVerticesPolarCoordinatesThatLeadThere) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 300);
    std::vector<double> miss;
    for (int v = 0; v < mesh.vertex_count(); v += 7) {
        ASSERT_FALSE(samples.near_vertex[v].empty());
        float nearest = 1e9F;
        int owner = -1;
        for (const NearSample& n : samples.near_vertex[v]) {
            if (n.distance < nearest) {
                nearest = n.distance;
                owner = n.sample;
            }
            const Trace t = trace(mesh, samples.point[n.sample], std::polar(1.0, double(n.angle)), n.distance);
            miss.push_back((position(mesh, t.end) - mesh.position[v]).norm() / samples.spacing);
        }
        EXPECT_EQ(owner, samples.owner[v]);
    }
    EXPECT_LT(shapes::mean(miss), 0.02);
}

TEST(Samples, ShareOutTheArea) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples samples = sample(mesh, 200);
    double sum = 0.0;
    for (const double a : samples.area) sum += a;
    EXPECT_NEAR(sum / mesh.area, 1.0, 0.02);
}

TEST(Samples, BeginWithTheFixedOnes) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    std::vector<SurfacePoint> fixed(3);
    fixed[0].face = 40;
    fixed[1].face = 41;
    fixed[2].face = 4000;
    const Samples samples = sample(mesh, 300, 1, 0, fixed);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(samples.point[i].face, fixed[i].face);
    EXPECT_NEAR(samples.count(), sample(mesh, 300).count(), 15);
}

TEST(Samples, AreEqualBitForBitForAnyNumberOfThreadsAndTheSameSeed) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(4));
    const Samples one = sample(mesh, 300, 1), four = sample(mesh, 300, 4), other = sample(mesh, 300, 1, 99);
    ASSERT_EQ(one.edges.size(), four.edges.size());
    for (std::size_t i = 0; i < one.edges.size(); ++i) {
        EXPECT_EQ(one.edges[i].length, four.edges[i].length);
        EXPECT_EQ(one.edges[i].at_u, four.edges[i].at_u);
        EXPECT_EQ(one.edges[i].at_v, four.edges[i].at_v);
        EXPECT_EQ(one.edges[i].witnesses, four.edges[i].witnesses);
    }
    EXPECT_EQ(one.owner, four.owner);
    EXPECT_NE(one.position, other.position);
}

TEST(Samples, StopWhenCancelled) {
    const TriangleMesh mesh = shapes::mesh_of(shapes::blob(3));
    Monitor before;
    before.cancel();
    EXPECT_THROW(make_samples(mesh, 0.2, {}, 0, 1, before, 0.0, 1.0), Cancelled);
    Monitor during([](const std::string&, double fraction) { return fraction < 0.5; });
    EXPECT_THROW(make_samples(mesh, 0.2, {}, 0, 2, during, 0.0, 1.0), Cancelled);
}

TEST(HierarchyOptions, AreRefusedByName) {
    HierarchyOptions options;
    EXPECT_NO_THROW(options.validate());
    const auto refused = [](auto change) {
        HierarchyOptions bad;
        change(bad);
        try {
            bad.validate();
        } catch (const InvalidInput& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    const double nan = std::nan("");
    EXPECT_NE(refused([](auto& o) { o.samples = 0; }).find("hierarchy.samples"), std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.min_samples = 5000; }).find("hierarchy.min_samples"), std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.levels = 0; }).find("hierarchy.levels"), std::string::npos);
    EXPECT_NE(refused([&](auto& o) { o.base_reach = nan; }).find("hierarchy.base_reach"), std::string::npos);
    EXPECT_NE(refused([&](auto& o) { o.level_reach = nan; }).find("hierarchy.level_reach"), std::string::npos);
    EXPECT_NE(refused([&](auto& o) { o.reshoot_tolerance = nan; }).find("reshoot_tolerance"), std::string::npos);
}

}  // namespace
}  // namespace isograft
