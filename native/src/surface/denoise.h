// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "isograft/monitor.h"
#include "isograft/options/surface.h"
#include "surface/mesh.h"

namespace isograft {

/// The mesh with its vertices on the robust implicit surface through them (see Rimls); connected and numbered as
/// before.
///
/// Vertices whose projection fails, or whose triangles would turn over or lose their area, stay where they are.
/// \param support radius of the weights in local mean edge lengths. O(#V log #V).
TriangleMesh denoised(const TriangleMesh& mesh, double support, Monitor& monitor);

}  // namespace isograft
