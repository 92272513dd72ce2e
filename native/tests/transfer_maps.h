// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "isograft/correspondence.h"
#include "shapes.h"

namespace isograft::maps {

/// Every vertex of a shape to itself, in the last of its triangles; face, barycentric, vertex only.
Correspondence identity(const shapes::Shape& shape);

/// Every vertex to the one it became.
Correspondence to_renumbered(const shapes::Shape& shape, const shapes::Renumbered& renumbered);

}  // namespace isograft::maps
