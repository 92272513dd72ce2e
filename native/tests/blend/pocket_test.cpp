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

TEST(Pocket, IsFilledFromTheDistancesAround) {
    Monitor monitor;
    for (const int centre : {0, 40, 90}) {
        const std::vector<int> pocket = nearest(centre, 6);
        ASSERT_LT(share(pocket), 0.05);
        PartialMap map = without(pocket);
        const PartialMap before = map;
        EXPECT_EQ(fill_pockets(map, twins().pair(), 2, monitor), 6);
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
    Monitor monitor;
    const std::vector<int> large = nearest(0, twins().all_samples().size() / 10);
    ASSERT_GT(share(large), 0.05);
    PartialMap map = without(large);
    EXPECT_EQ(fill_pockets(map, twins().pair(), 2, monitor), 0);
    PartialMap whole = without({});
    EXPECT_EQ(fill_pockets(whole, twins().pair(), 2, monitor), 0);
    PartialMap none(twins().pair().source.samples.count());
    EXPECT_EQ(fill_pockets(none, twins().pair(), 2, monitor), 0);
}

TEST(Pocket, StaysEmptyWhereItsPlaceOnTIsTaken) {
    Monitor monitor;
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
    EXPECT_EQ(fill_pockets(map, twins().pair(), 2, monitor), 0);
}

TEST(Pocket, StopsWhenCancelled) {
    Monitor monitor;
    monitor.cancel();
    PartialMap map = without(nearest(0, 6));
    EXPECT_THROW(fill_pockets(map, twins().pair(), 2, monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
