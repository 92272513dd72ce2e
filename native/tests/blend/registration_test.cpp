// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/registration.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& blobs() { return Twins::of_a_blob(); }

using Where = std::function<bool(const Eigen::Vector3d& x)>;

/// Of the right map what lies at some places of the source, in unit lengths.
PartialMap part(const Twins& twins, const Where& where) {
    std::vector<int> samples;
    for (const int s : twins.all_samples()) {
        if (where(twins.pair().source.samples.position[s])) samples.push_back(s);
    }
    return twins.true_map(samples);
}

bool low(const Eigen::Vector3d& x) { return x.z() < 0.0; }

/// What was extended, and by how much it may be trusted.
struct Extended {
    PartialMap map;
    std::vector<double> risk;
    int added;
};

Extended extended(const Twins& twins, const PartialMap& from, int threads = 2) {
    Monitor monitor;
    Extended result{from, std::vector<double>(from.mapped.size(), 0.9), 0};
    result.added = extend_by_registration(result.map, twins.pair(), result.risk, threads, monitor);
    return result;
}

/// Two halves of a blob with nothing between them, `gap` unit lengths apart.
Twins halves(double gap) {
    const double half = 0.5 * gap * blobs().prepared().unit;
    return Twins(shapes::cut(shapes::blob(4), [&](const Eigen::Vector3d& x) { return std::abs(x.z()) > half; }));
}

TEST(Registration, GoesOnOverARigidBody) {
    const PartialMap before = part(blobs(), low);
    const Extended after = extended(blobs(), before);
    const int open = blobs().pair().source.samples.count() - before.count;
    ASSERT_GT(open, 80);
    EXPECT_EQ(after.added, after.map.count - before.count);
    EXPECT_GT(after.added, 0.98 * open);
    for (const int s : blobs().all_samples()) {
        if (after.map.mapped[s] == 0) continue;
        if (before.mapped[s] != 0) {
            EXPECT_EQ(after.map.position[s], before.position[s]);
            EXPECT_EQ(after.risk[s], 0.9);
            continue;
        }
        EXPECT_LT(blobs().error(s, after.map.position[s]), 0.3);
        EXPECT_EQ(after.risk[s], registered_doubt);
        const OrientedMatch truth = blobs().true_match(s);
        const Complex turn =
            carry(blobs().pair().target.mesh, truth.point.face, after.map.image[s].face, truth.rotation);
        EXPECT_LT(std::abs(std::arg(after.map.rotation[s] * std::conj(turn))), 0.3);
    }
}

TEST(Registration, StartsAPieceFromWhatLiesAcrossTheGap) {
    const Twins near = halves(0.08);
    ASSERT_EQ(near.pair().source.mesh.component_count, 2);
    const PartialMap before = part(near, low);
    const Extended after = extended(near, before);
    EXPECT_GT(after.map.count, 0.95 * near.pair().source.samples.count());
    double sum = 0.0;
    for (const int s : near.all_samples()) {
        if (after.map.mapped[s] == 0) continue;
        sum += near.error(s, after.map.position[s]);
        EXPECT_LT(near.error(s, after.map.position[s]), 0.5);
    }
    EXPECT_LT(sum / after.map.count, 0.1);
    const Twins distant = halves(0.2);
    ASSERT_EQ(distant.pair().source.mesh.component_count, 2);
    EXPECT_EQ(extended(distant, part(distant, low)).added, 0);
}

TEST(Registration, AddsNothingThatTLacks) {
    const shapes::Shape whole = shapes::blob(4);
    const double unit = blobs().prepared().unit;
    const auto there = [&](const Eigen::Vector3d& x) { return x.z() < 0.1 * unit; };
    const Twins twins(whole, shapes::cut(whole, there));
    const double scale = twins.prepared().unit;
    const double rim = 0.1 * unit / scale;
    const PartialMap before = part(twins, [](const Eigen::Vector3d& x) { return x.z() < -0.1; });
    const Extended after = extended(twins, before);
    int inside = 0, outside = 0, beyond = 0, reached = 0;
    for (const int s : twins.all_samples()) {
        const double z = twins.pair().source.samples.position[s].z();
        if (z < rim - 1.5 * twins.spacing()) {
            ++inside;
            reached += after.map.mapped[s];
        }
        // The rim is jagged by half an edge, what comes to lie a third of a spacing beside it is taken, and lengths may
        // be half a spacing short.
        beyond += z > rim + 0.5 * twins.spacing() ? after.map.mapped[s] : 0;
        if (z > rim + 1.5 * twins.spacing()) {
            ++outside;
            EXPECT_FALSE(after.map.mapped[s]);
        }
    }
    EXPECT_GT(after.added, 20);
    EXPECT_GT(outside, 40);
    EXPECT_LE(beyond, 3);
    EXPECT_GT(reached, 0.95 * inside);
}

TEST(Registration, AddsNothingWhereTheShapeIsAnother) {
    const shapes::Shape whole = shapes::blob(4);
    const double unit = blobs().prepared().unit;
    shapes::Shape other = shapes::noisy(whole, 0.03 * unit, 3);
    for (Eigen::Index v = 0; v < whole.vertices.rows(); ++v) {
        if (whole.vertices(v, 2) < 0.05 * unit) other.vertices.row(v) = whole.vertices.row(v);
    }
    const Twins twins(whole, other);
    const Extended after = extended(twins, part(twins, low));
    EXPECT_GT(after.added, 20);
    int rough = 0, mapped = 0;
    for (const int s : twins.all_samples()) {
        if (twins.pair().source.samples.position[s].z() < 0.12) continue;
        ++rough;
        mapped += after.map.mapped[s];
    }
    EXPECT_GT(rough, 20);
    EXPECT_LE(mapped, 0.05 * rough);
}

TEST(Registration, AddsNothingTooFarFromItsNeighbours) {
    PartialMap map = part(blobs(), low);
    const TriangleMesh& target = blobs().pair().target.mesh;
    const Samples& source = blobs().pair().source.samples;
    // The rim of the map slid back by five spacings: what goes on from the rest lies too far from it.
    const Eigen::Vector3d back(0.0, 0.0, -5.0 * blobs().spacing());
    for (const int s : blobs().all_samples()) {
        const double z = source.position[s].z();
        if (z >= 0.0 || z < -1.5 * blobs().spacing()) continue;
        const SurfacePoint there = shapes::point_nearest(target, blobs().truth(source.position[s] + back));
        map.put(target, s, there, map.rotation[s]);
    }
    // Were lengths not asked for, 124 would follow.
    EXPECT_LT(extended(blobs(), map).added, 12);
}

TEST(Registration, TakesNoPlaceTwice) {
    PartialMap map = part(blobs(), low);
    const int before = map.count;
    // Samples of the lower half lie where the tip of the upper one belongs.
    const TriangleMesh& target = blobs().pair().target.mesh;
    const Samples& source = blobs().pair().source.samples;
    const auto height = [&](int s) { return source.position[s].z(); };
    std::vector<int> lower;
    double top = 0.0;
    for (const int s : blobs().all_samples()) {
        if (height(s) < -0.15) lower.push_back(s);
        top = std::max(top, height(s));
    }
    const double tip = 0.5 * top;
    int moved = 0;
    for (const int s : blobs().all_samples()) {
        if (height(s) < tip) continue;
        ASSERT_FALSE(lower.empty());
        const OrientedMatch there = blobs().true_match(s);
        map.put(target, lower.back(), there.point, there.rotation);
        lower.pop_back();
        ++moved;
    }
    ASSERT_GT(moved, 20);
    ASSERT_EQ(map.count, before);
    const Extended after = extended(blobs(), map);
    for (const int s : blobs().all_samples()) {
        if (height(s) > tip + blobs().spacing()) {
            EXPECT_FALSE(after.map.mapped[s]);
        }
    }
    // Without them it is reached.
    const Extended free = extended(blobs(), part(blobs(), low));
    for (const int s : blobs().all_samples()) {
        if (height(s) > tip) {
            EXPECT_TRUE(free.map.mapped[s]);
        }
    }
}

TEST(Registration, LeavesWholeAndEmptyMapsAlone) {
    EXPECT_EQ(extended(blobs(), blobs().true_map(blobs().all_samples())).added, 0);
    EXPECT_EQ(extended(blobs(), blobs().true_map({})).added, 0);
}

TEST(Registration, IsTheSameWithAnyNumberOfThreads) {
    const PartialMap before = part(blobs(), low);
    const Extended one = extended(blobs(), before, 1), four = extended(blobs(), before, 4);
    EXPECT_GT(one.added, 80);
    EXPECT_EQ(one.map.mapped, four.map.mapped);
    EXPECT_EQ(one.map.position, four.map.position);
    EXPECT_EQ(one.map.rotation, four.map.rotation);
    EXPECT_EQ(one.risk, four.risk);
}

TEST(Registration, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    PartialMap map = part(blobs(), low);
    std::vector<double> risk(map.mapped.size(), 0.0);
    EXPECT_THROW(extend_by_registration(map, blobs().pair(), risk, 2, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
