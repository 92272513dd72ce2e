// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include "base/filling.h"
#include "isograft/monitor.h"

namespace isograft {

/// std::sort that asks `monitor` now and then. \throw Cancelled, with the items in any order.
template <class Iterator, class Less>
void sort_watched(Iterator begin, Iterator end, Less less, Monitor& monitor) {
    unsigned comparisons = 0;
    std::sort(begin, end, [&](const auto& a, const auto& b) {
        if (++comparisons % often == 0) monitor.check();
        return less(a, b);
    });
}

/// Sort items whose first criterion is a small number: linear where no bucket holds very many.
///
/// \param bucket_of number in [0, buckets), rising with the order. \param less a strict order without ties.
/// \return what std::sort with `less` would give. \throw Cancelled.
template <class Item, class BucketOf, class Less>
std::vector<Item> sort_by_buckets(std::vector<Item> items, int buckets, BucketOf bucket_of, Less less,
                                  Monitor& monitor) {
    std::vector<int> next(static_cast<std::size_t>(buckets) + 1, 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i % often == 0) monitor.check();
        ++next[bucket_of(items[i]) + 1];
    }
    std::partial_sum(next.begin(), next.end(), next.begin());
    monitor.check();
    std::vector<Item> sorted;
    fill_watched(sorted, items.size(), monitor);
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (i % often == 0) monitor.check();
        sorted[next[bucket_of(items[i])]++] = items[i];
    }
    // Every bucket now ends where `next` stands.
    const auto at = [&](int i) { return sorted.begin() + static_cast<std::ptrdiff_t>(i); };
    for (int b = 0, begin = 0; b < buckets; begin = next[b++]) {
        if (b % often == 0) monitor.check();
        if (next[b] - begin > 1) sort_watched(at(begin), at(next[b]), less, monitor);
    }
    return sorted;
}

}  // namespace isograft
