// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "isograft/monitor.h"

namespace isograft {

/// Steps of a light loop between two looks at the monitor.
constexpr int often = 1 << 16;

/// std::vector::assign that asks `monitor` now and then: memory that is touched for the first time takes longer than
/// most of what is done with it. \throw Cancelled, with part of the items.
template <class T>
void fill_watched(std::vector<T>& items, std::size_t count, const T& value, Monitor& monitor) {
    items.clear();
    items.reserve(count);
    while (items.size() < count) {
        monitor.check();
        items.resize(std::min(count, items.size() + often), value);
    }
}

/// `count` times the value that a T has by itself.
template <class T>
void fill_watched(std::vector<T>& items, std::size_t count, Monitor& monitor) {
    fill_watched(items, count, T{}, monitor);
}

/// items = from, which is another vector; asks as fill_watched() does. \throw Cancelled, with part of the items.
template <class T>
void copy_watched(std::vector<T>& items, const std::vector<T>& from, Monitor& monitor) {
    items.clear();
    items.reserve(from.size());
    while (items.size() < from.size()) {
        monitor.check();
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(items.size());
        items.insert(items.end(), begin, begin + std::min<std::ptrdiff_t>(often, from.end() - begin));
    }
}

}  // namespace isograft
