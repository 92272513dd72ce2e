// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/filling.h"

#include <cstddef>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "isograft/errors.h"

namespace isograft {
namespace {

TEST(Filling, LeavesAsManyAsAskedForAndNothingOfBefore) {
    Monitor monitor;
    for (const int count : {0, 1, often - 1, often, 3 * often + 5}) {
        std::vector<int> items(7, 1);
        fill_watched(items, count, 4, monitor);
        EXPECT_EQ(items, std::vector<int>(count, 4));
        fill_watched(items, count, monitor);
        EXPECT_EQ(items, std::vector<int>(count, 0));
        std::vector<int> numbers(count);
        std::iota(numbers.begin(), numbers.end(), 0);
        copy_watched(items, numbers, monitor);
        EXPECT_EQ(items, numbers);
    }
}

// Asks its monitor to stop when it is copied.
struct Wish {
    Monitor* monitor = nullptr;
    Wish() = default;
    explicit Wish(Monitor& asked) : monitor(&asked) {}
    Wish(const Wish& other) : monitor(other.monitor) {
        if (monitor != nullptr) monitor->cancel();
    }
    Wish& operator=(const Wish&) = default;
};

TEST(Filling, StopsOnItsWay) {
    Monitor first, second;
    std::vector<Wish> items;
    const Wish wish(first);
    EXPECT_THROW(fill_watched(items, 5 * often, wish, first), Cancelled);
    EXPECT_EQ(items.size(), often);
    std::vector<Wish> from(5 * often);
    from.front().monitor = &second;
    EXPECT_THROW(copy_watched(items, from, second), Cancelled);
    EXPECT_EQ(items.size(), often);
}

}  // namespace
}  // namespace isograft
