// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "isograft/match.h"

namespace isograft {

/// Numbers of vertices and triangles of a mesh.
struct MeshSize {
    std::int64_t vertices = 0;
    std::int64_t triangles = 0;
};

/// Bytes that the gate and match() will hold at the most, from measured peaks: meant to err upward, by a third at the
/// most for meshes of 10,000 vertices and more.
std::int64_t estimated_memory(const MeshSize& source, const MeshSize& target, const MatchOptions& options);

/// \throw ResourceLimit with both numbers and what to do if the estimate exceeds `limit` bytes; 0 is no limit.
void check_memory(const MeshSize& source, const MeshSize& target, const MatchOptions& options, std::int64_t limit);

}  // namespace isograft
