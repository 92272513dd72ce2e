// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/vertex_place.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "scale/resample.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

// The twins with other samples.
const Pair& other() {
    static const Pair pair = [] {
        Pair made = twins().pair();
        Monitor monitor;
        resample(made, twins().options(), 77, monitor, 0.0, 1.0);
        return made;
    }();
    return pair;
}

std::vector<int> low_samples() {
    std::vector<int> low;
    for (const int s : twins().all_samples()) {
        if (twins().pair().source.samples.position[s].y() < 0.0) low.push_back(s);
    }
    return low;
}

TEST(PlaceOfVertex, IsWhereItBelongs) {
    const Pair& pair = twins().pair();
    const PartialMap map = twins().true_map(twins().all_samples());
    for (int v = 0; v < pair.source.mesh.vertex_count(); v += 7) {
        const auto place = place_of_vertex(v, map, pair, 1.2 * pair.source.samples.spacing);
        ASSERT_TRUE(place.has_value());
        EXPECT_LT((place->position - twins().truth(pair.source.mesh.position[v])).norm(), 0.5 * twins().spacing());
        double total = 0.0;
        for (const VertexPlace::Say& say : place->said) total += say.weight;
        EXPECT_NEAR(place->total, total, 1e-9 * total);
    }
}

TEST(PlaceOfVertex, IsNoneWhereNoSampleIsInReach) {
    const Pair& pair = twins().pair();
    const PartialMap map = twins().true_map(low_samples());
    int none = 0;
    for (int v = 0; v < pair.source.mesh.vertex_count(); ++v) {
        if (pair.source.mesh.position[v].y() < 2.0 * twins().spacing()) continue;
        EXPECT_FALSE(place_of_vertex(v, map, pair, pair.source.samples.spacing).has_value());
        ++none;
    }
    EXPECT_GT(none, 100);
}

TEST(CarriedOver, PutsEverySampleWhereTheMapPutsItsSurroundings) {
    const PartialMap map = carried_over(twins().true_map(twins().all_samples()), twins().pair(), other());
    const TriangleMesh& source = other().source.mesh;
    // The disks of the samples leave gaps of a little more than a spacing.
    EXPECT_GT(map.count, 0.97 * other().source.samples.count());
    for (int s = 0; s < other().source.samples.count(); ++s) {
        if (map.mapped[s] == 0) continue;
        const Eigen::Vector3d& x = other().source.samples.position[s];
        EXPECT_LT((map.position[s] - twins().truth(x)).norm(), 0.5 * twins().spacing());
        const Eigen::Vector3d along = lift(source, other().source.samples.point[s].face, Complex(1.0, 0.0));
        const Complex there =
            flatten(other().target.mesh, map.image[s].face, twins().truth(x + along) - twins().truth(x));
        EXPECT_LT(std::abs(std::arg(map.rotation[s] * std::conj(there))), 0.4);
    }
}

TEST(CarriedOver, HoldsNothingFarFromTheMap) {
    const PartialMap map = carried_over(twins().true_map(low_samples()), twins().pair(), other());
    int low = 0, held = 0;
    for (int s = 0; s < other().source.samples.count(); ++s) {
        const double y = other().source.samples.position[s].y();
        if (y > 2.0 * twins().spacing()) {
            EXPECT_FALSE(map.mapped[s]);
        } else if (y < -2.0 * twins().spacing()) {
            low += 1;
            held += map.mapped[s];
        }
    }
    EXPECT_GT(held, 0.95 * low);
    EXPECT_EQ(carried_over(PartialMap(twins().pair().source.samples.count()), twins().pair(), other()).count, 0);
}

}  // namespace
}  // namespace isograft
