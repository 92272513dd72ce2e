// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "isograft/monitor.h"
#include "isograft/transfer.h"
#include "transfer/moments.h"

namespace isograft {

/// Sums over a wide surrounding of every vertex, if two surfaces hold one pose; nothing if limbs turn between them.
///
/// What one of two shapes has of its own turns small parts of it, and the less the wider one looks. A limb turns all
/// that hangs on it. So sums are diffused over the surface by ever wider heat kernels, and what the rotations change
/// from one width to the next is added up for narrow and for wide ones. Poses differ if the latter is large, or most of
/// the former. Only rotations are asked: a map that keeps lengths hides how the sizes differ.
///
/// \param faces triangles that count. \param moments by vertex. \return by vertex, of an arbitrary common scale.
/// O(#F log #F).
std::optional<std::vector<Moments>> fit_in_one_pose(const Points& vertices, const Triangles& faces,
                                                    const std::vector<Moments>& moments, Monitor& monitor);

}  // namespace isograft
