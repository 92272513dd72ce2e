// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/vacancy.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "twins.h"

namespace isograft {
namespace {

const Twins& twins() { return Twins::of_a_blob(); }

/// Source samples within `radius` of sample `centre`, in space.
std::vector<int> around(int centre, double radius) {
    const Samples& source = twins().pair().source.samples;
    std::vector<int> result;
    for (const int s : twins().all_samples()) {
        if ((source.position[s] - source.position[centre]).norm() < radius) result.push_back(s);
    }
    return result;
}

int farthest_from(int sample) {
    const Samples& source = twins().pair().source.samples;
    int best = sample;
    for (const int s : twins().all_samples()) {
        const auto away = [&](int i) { return (source.position[i] - source.position[sample]).norm(); };
        if (away(s) > away(best)) best = s;
    }
    return best;
}

std::vector<int> without(const std::vector<int>& all, const std::vector<int>& some) {
    std::vector<int> result;
    std::set_difference(all.begin(), all.end(), some.begin(), some.end(), std::back_inserter(result));
    return result;
}

/// The true map, but the samples of `moved` lie among the images of those around `onto`.
PartialMap moved_onto(const std::vector<int>& moved, int onto) {
    PartialMap map = twins().true_map(twins().all_samples());
    const std::vector<int> there = around(onto, 0.3);
    for (std::size_t i = 0; i < moved.size(); ++i) {
        const OrientedMatch match = twins().true_match(there[i % there.size()]);
        map.put(twins().pair().target.mesh, moved[i], match.point, match.rotation);
    }
    return map;
}

TEST(VacantParts, AreNoneWhereTheMapIsWhole) {
    EXPECT_TRUE(vacant_parts(twins().pair(), twins().true_map(twins().all_samples()), 0.001).empty());
}

TEST(VacantParts, LieWhereSamplesAreMissing) {
    const Samples& source = twins().pair().source.samples;
    const Samples& target = twins().pair().target.samples;
    const int far = farthest_from(0);
    std::vector<int> missing = around(0, 0.25);
    const std::vector<int> more = around(far, 0.35);
    missing.insert(missing.end(), more.begin(), more.end());
    std::sort(missing.begin(), missing.end());
    const PartialMap map = twins().true_map(without(twins().all_samples(), missing));
    const auto parts = vacant_parts(twins().pair(), map, 0.005);
    ASSERT_EQ(parts.size(), 2U);
    const auto area = [&](const std::vector<int>& part) {
        return std::accumulate(part.begin(), part.end(), 0.0, [&](double sum, int t) { return sum + target.area[t]; });
    };
    EXPECT_GT(area(parts[0]), area(parts[1]));
    EXPECT_TRUE(std::is_sorted(parts[0].begin(), parts[0].end()));
    const double reach[] = {0.35, 0.25};
    const int centre[] = {far, 0};
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
        for (const int t : parts[i]) {
            EXPECT_LT((target.position[t] - twins().truth(source.position[centre[i]])).norm(), reach[i]);
        }
    }
    // Smaller than the limit is no vacancy.
    const double total = std::accumulate(target.area.begin(), target.area.end(), 0.0);
    EXPECT_EQ(vacant_parts(twins().pair(), map, 1.01 * area(parts[1]) / total).size(), 1U);
}

TEST(Doubled, IsNothingInAWholeMap) {
    const PartialMap map = twins().true_map(twins().all_samples());
    const std::vector<char> loses = doubled(twins().pair(), map, std::vector<double>(map.mapped.size(), 0.1));
    EXPECT_EQ(std::count(loses.begin(), loses.end(), 1), 0);
}

TEST(Doubled, LeavesAPlaceToThePartWithLessDoubt) {
    const int far = farthest_from(0);
    const std::vector<int> guests = around(far, 0.3);
    std::vector<int> hosts = around(0, 0.3);
    ASSERT_GE(hosts.size(), guests.size());
    hosts.resize(guests.size());  // those that got a guest
    const PartialMap map = moved_onto(guests, 0);
    for (const bool guests_doubted : {true, false}) {
        std::vector<double> doubts(map.mapped.size(), 0.2);
        for (const int s : guests) doubts[s] = guests_doubted ? 0.3 : 0.1;
        const std::vector<char> loses = doubled(twins().pair(), map, doubts);
        const auto share = [&](const std::vector<int>& part) {
            return static_cast<double>(std::count_if(part.begin(), part.end(), [&](int s) { return loses[s] != 0; })) /
                   static_cast<double>(part.size());
        };
        EXPECT_GT(share(guests_doubted ? guests : hosts), 0.9);
        EXPECT_EQ(share(guests_doubted ? hosts : guests), 0.0);
    }
}

TEST(CompatibleSets, HoldsMapsThatAgreeAndPartsOthers) {
    const Samples& source = twins().pair().source.samples;
    const int far = farthest_from(0);
    const PartialMap here = twins().true_map(around(0, 0.4));
    const PartialMap part_of_it = twins().true_map(around(0, 0.25));
    const PartialMap there = twins().true_map(around(far, 0.4));
    // Puts the far samples where those of `here` lie.
    PartialMap doubling(source.count());
    const std::vector<int> guests = around(far, 0.3);
    const PartialMap moved = moved_onto(guests, 0);
    for (const int s : guests) doubling.put(twins().pair().target.mesh, s, moved.image[s], moved.rotation[s]);

    const std::vector<const PartialMap*> maps{&doubling, &here, &part_of_it, &there};
    const auto sets = compatible_sets(source, maps, {0.5, 1.0, 0.2, 0.9}, 0.06, 5);
    ASSERT_EQ(sets.size(), 2U);
    EXPECT_EQ(sets[0], (std::vector<std::size_t>{1, 3, 2}));
    EXPECT_EQ(sets[1], (std::vector<std::size_t>{0}));
    EXPECT_EQ(compatible_sets(source, maps, {0.5, 1.0, 0.2, 0.9}, 0.06, 1).size(), 1U);
    // The heaviest comes first.
    EXPECT_EQ(compatible_sets(source, maps, {2.0, 1.0, 0.2, 0.9}, 0.06, 5)[0], (std::vector<std::size_t>{0}));
}

}  // namespace
}  // namespace isograft
