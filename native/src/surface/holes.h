// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "surface/mesh.h"

namespace isograft {

class Monitor;

/// The same mesh with its small holes closed by smooth pieces, so that geodesics cross them as they would cross what
/// was lost, and do not bend around.
///
/// A hole is a rim of at most `longest` roots of its component's area whose middle lies along the surface, and to which
/// the surface leads: the stump of a limb stays open, the fold of a modelled lip, and by its length the outer rim of a
/// sheet. A piece is rings of vertices from
/// the rim to the middle, about as fine as the rim or a hundredth of the root of the area, which minimise the
/// bi-Laplacian with weights 1 / edge length. What is new has `input_vertex`, `input_face` -1 and comes behind the
/// rest. A hole whose piece would have triangles without area stays open. O(#F + sum of rims).
/// \return nothing if there is no such hole. \throw Cancelled if `monitor` asks for it.
std::optional<TriangleMesh> with_holes_closed(const TriangleMesh& mesh, double longest, Monitor& monitor);

}  // namespace isograft
