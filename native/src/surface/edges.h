// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/sorting.h"

namespace isograft {

using Corners = std::array<int, 3>;

/// The half-edge after this one in its triangle.
constexpr int following(int halfedge) { return halfedge / 3 * 3 + (halfedge % 3 + 1) % 3; }

/// The lower and the higher end of the edge that half-edge 3 f + k runs along.
struct EdgeItem {
    int low, high, halfedge;
    auto operator<=>(const EdgeItem&) const = default;
};

/// The items [begin, end) of one edge.
struct EdgeGroup {
    int begin, end;
};

/// Half-edges sorted by the edge they run along, and where each edge's begin.
struct Edges {
    std::vector<EdgeItem> item;
    std::vector<EdgeGroup> group;
};

/// \param monitor asked now and then. O(#F) where no vertex has very many triangles.
inline Edges collect_edges(const std::vector<Corners>& face, Monitor& monitor) {
    std::vector<EdgeItem> loose;
    fill_watched(loose, 3 * face.size(), monitor);
    const int halfedges = static_cast<int>(loose.size());
    int vertices = 0;
    for (int h = 0; h < halfedges; ++h) {
        if (h % often == 0) monitor.check();
        const int a = face[h / 3][h % 3], b = face[h / 3][(h % 3 + 1) % 3];
        loose[h] = {std::min(a, b), std::max(a, b), h};
        vertices = std::max(vertices, std::max(a, b) + 1);
    }
    Edges edges;
    edges.item = sort_by_buckets(
        std::move(loose), vertices, [](const EdgeItem& e) { return e.low; }, std::less<EdgeItem>(), monitor);
    edges.group.reserve(edges.item.size() / 2);
    int looked = 0;
    for (int i = 0; i < halfedges;) {
        if (looked++ % often == 0) monitor.check();
        const EdgeItem& first = edges.item[i];
        int end = i + 1;
        while (end < halfedges && edges.item[end].low == first.low && edges.item[end].high == first.high) ++end;
        edges.group.push_back({i, end});
        i = end;
    }
    monitor.check();
    return edges;
}

/// Append "n one" or "n many"; nothing for zero.
inline void warn(std::vector<std::string>& warnings, std::int64_t n, const char* one, const char* many) {
    if (n > 0) warnings.push_back(std::to_string(n) + " " + (n == 1 ? one : many));
}

}  // namespace isograft
