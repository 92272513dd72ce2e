// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/pocket.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

/// The samples nearest to sample `centre`, in space.
std::vector<int> nearest(int centre, std::size_t count) {
    const Samples& source = twins().pair().source.samples;
    std::vector<int> result = twins().all_samples();
    std::sort(result.begin(), result.end(), [&](int a, int b) {
        return (source.position[a] - source.position[centre]).norm() <
               (source.position[b] - source.position[centre]).norm();
    });
    result.resize(count);
    return result;
}

double share(const std::vector<int>& samples) {
    const Samples& source = twins().pair().source.samples;
    double part = 0.0;
    double all = 0.0;
    for (const int s : samples) part += source.area[s];
    for (const double a : source.area) all += a;
    return part / all;
}

PartialMap without(const std::vector<int>& samples) {
    PartialMap map = twins().true_map(twins().all_samples());
    for (const int s : samples) map.drop(s);
    return map;
}

/// Fills the pockets of a map; how many samples more it holds then.
int gained(PartialMap& map, int landmarks = 0) {
    Monitor monitor;
    const int before = map.count;
    fill_pockets(map, twins().pair(), landmarks, 2, monitor);
    return map.count - before;
}

TEST(Pocket, IsFilledFromTheDistancesAround) {
    for (const int centre : {0, 40, 90}) {
        const std::vector<int> pocket = nearest(centre, 6);
        ASSERT_LT(share(pocket), 0.05);
        PartialMap map = without(pocket);
        const PartialMap before = map;
        EXPECT_EQ(gained(map), 6);
        for (const int s : pocket) {
            ASSERT_TRUE(map.mapped[s]);
            // Images are vertices of T, whose edges are half a spacing long.
            EXPECT_LT(twins().error(s, map.position[s]), 0.6);
            EXPECT_LT(std::abs(std::arg(map.rotation[s] *
                                        std::conj(carry(twins().pair().target.mesh, twins().true_match(s).point.face,
                                                        map.image[s].face, twins().true_match(s).rotation)))),
                      0.5);
        }
        for (const int s : twins().all_samples()) {
            if (before.mapped[s] != 0) {
                EXPECT_EQ(before.position[s], map.position[s]);
            }
        }
    }
}

TEST(Pocket, LeavesAloneALargePartAndAWholeMap) {
    const std::vector<int> large = nearest(0, twins().all_samples().size() / 10);
    ASSERT_GT(share(large), 0.05);
    PartialMap map = without(large);
    EXPECT_EQ(gained(map), 0);
    PartialMap whole = without({});
    EXPECT_EQ(gained(whole), 0);
    PartialMap none(twins().pair().source.samples.count());
    EXPECT_EQ(gained(none), 0);
}

/// A sample and those beside it.
std::vector<int> ring(int centre) {
    const Samples& source = twins().pair().source.samples;
    std::vector<int> result{centre};
    for (const int e : source.base_edges_of[centre]) result.push_back(source.edges[e].other(centre));
    return result;
}

/// Without the ring of `centre`, which itself lies where the sample farthest from it belongs.
PartialMap with_a_stray(int centre) {
    PartialMap map = without(ring(centre));
    const PartialMap truth = twins().true_map(twins().all_samples());
    const int far = nearest(centre, twins().all_samples().size()).back();
    map.put(twins().pair().target.mesh, centre, truth.image[far], Complex(1.0, 0.0));
    return map;
}

TEST(Pocket, PlacesAnewASampleThatIsAloneInIt) {
    for (const int centre : {0, 40, 90}) {
        ASSERT_LT(share(ring(centre)), 0.05);
        PartialMap map = with_a_stray(centre);
        ASSERT_GT(twins().error(centre, map.position[centre]), 5.0);
        EXPECT_EQ(gained(map), static_cast<int>(ring(centre).size()) - 1);
        ASSERT_TRUE(map.mapped[centre]);
        EXPECT_LT(twins().error(centre, map.position[centre]), 0.6);
    }
}

TEST(Pocket, DoesNotMoveALandmark) {
    for (const int centre : {0, 40}) {
        PartialMap map = with_a_stray(centre);
        const PartialMap before = map;
        gained(map, centre + 1);
        ASSERT_TRUE(map.mapped[centre]);
        EXPECT_EQ(map.position[centre], before.position[centre]);
    }
}

TEST(Pocket, LeavesASampleThatIsAloneInALargePart) {
    const std::vector<int> large = nearest(0, twins().all_samples().size() / 10);
    ASSERT_GT(share(large), 0.05);
    PartialMap map = without(large);
    const PartialMap truth = twins().true_map(twins().all_samples());
    map.put(twins().pair().target.mesh, 0, truth.image[0], truth.rotation[0]);
    EXPECT_EQ(gained(map), 0);
    ASSERT_TRUE(map.mapped[0]);
    EXPECT_EQ(map.position[0], truth.position[0]);
}

TEST(Pocket, StaysEmptyWhereItsPlaceOnTIsTaken) {
    const std::vector<int> pocket = nearest(0, 6);
    const PartialMap truth = twins().true_map(twins().all_samples());
    PartialMap map = without(pocket);
    // Samples from the far end lie on every vertex of T around the pocket's place.
    std::vector<int> far = nearest(0, twins().all_samples().size());
    const TriangleMesh& target = twins().pair().target.mesh;
    for (int v = 0; v < target.vertex_count(); ++v) {
        const bool inside = std::any_of(pocket.begin(), pocket.end(), [&](int s) {
            return (truth.position[s] - target.position[v]).norm() < 1.5 * twins().spacing();
        });
        if (!inside) continue;
        ASSERT_GT(far.size(), 40U);
        map.put(target, far.back(), point_near_vertex(target, v), Complex(1.0, 0.0));
        far.pop_back();
    }
    EXPECT_EQ(gained(map), 0);
}

TEST(Pocket, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    PartialMap map = without(nearest(0, 6));
    EXPECT_THROW(fill_pockets(map, twins().pair(), 0, 2, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
