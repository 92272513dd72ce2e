// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/sorting.h"

#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/random.h"
#include "isograft/errors.h"

namespace isograft {
namespace {

using Item = std::pair<int, int>;

std::vector<Item> random_items(int count, int buckets) {
    Random random(7);
    std::vector<Item> items;
    for (int i = 0; i < count; ++i) items.emplace_back(random.below(buckets), random.below(1 << 20));
    return items;
}

int first_of(const Item& item) { return item.first; }

TEST(SortByBuckets, GivesWhatSortGivesWithManyFewAndEmptyBuckets) {
    for (const auto& [count, buckets] : {std::pair{5000, 3000}, {5000, 1}, {3, 1000}, {0, 5}, {0, 0}}) {
        std::vector<Item> items = random_items(count, std::max(1, buckets));
        Monitor monitor;
        const auto sorted = sort_by_buckets(items, buckets, first_of, std::less<Item>(), monitor);
        std::sort(items.begin(), items.end());
        EXPECT_EQ(sorted, items) << count << " in " << buckets;
    }
}

TEST(SortByBuckets, StopsInTheMiddleOfOneLargeBucket) {
    int asked = 0;
    Monitor monitor;
    const auto less = [&](const Item& a, const Item& b) {
        if (++asked == 1000) monitor.cancel();
        return a < b;
    };
    EXPECT_THROW(sort_by_buckets(random_items(200'000, 1), 1, first_of, less, monitor), Cancelled);
    EXPECT_LT(asked, 200'000);
}

TEST(SortWatched, SortsAndStopsInTheMiddle) {
    std::vector<Item> items = random_items(100'000, 1000);
    std::vector<Item> same = items;
    Monitor monitor;
    sort_watched(items.begin(), items.end(), std::less<Item>(), monitor);
    std::sort(same.begin(), same.end());
    EXPECT_EQ(items, same);
    monitor.cancel();
    items = random_items(100'000, 1000);
    EXPECT_THROW(sort_watched(items.begin(), items.end(), std::less<Item>(), monitor), Cancelled);
}

}  // namespace
}  // namespace isograft
