// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "surface/mesh.h"

namespace isograft {

class Monitor;

/// The same mesh where it would be if nobody had moved it: its centre at the origin, the axes of its inertia along the
/// coordinates, what weighs more on their positive sides, the coordinates rounded to single precision, and all numbered
/// by place (in_order_of_place).
///
/// So moving, turning and renumbering the input changes no bit of what follows. A mesh without axes of its own, such as
/// a sphere's, comes to lie anywhere. Triangles that this rounding would squeeze are rounded to less. O(#V log #V).
/// \return the same connectivity; `input_vertex`, `input_face` and `input_order` lead back. \throw Cancelled if
/// `monitor` asks for it.
TriangleMesh in_own_frame(const TriangleMesh& mesh, Monitor& monitor);

}  // namespace isograft
