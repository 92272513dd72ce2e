// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "isograft/memory.h"
#include "isograft/surface.h"

namespace isograft {

/// What a surface is made from, and what errors call it.
struct SurfaceParts {
    std::string name;
    Points vertices{0, 3};
    /// Not looked at if it is a point cloud.
    Triangles faces{0, 3};
    bool is_cloud = false;
    /// Of a point cloud; without rows to have them estimated.
    Points normals{0, 3};
};

/// Surface::from_mesh() or Surface::from_points() of each, side by side.
///
/// \param monitor may be null; its progress goes from 0 to 1.
/// \throw InvalidInput beginning with the name and a colon (if there is a name) and what they throw; of several, the
/// first's. Cancelled if `monitor` asks for it.
std::vector<Surface> make_surfaces(std::vector<SurfaceParts> parts, int threads, Monitor* monitor = nullptr);

/// The share of make_surfaces() in the time of that and match() together: for telling both as one progress.
/// \param made sizes of what still has to be made; clouds have no triangles. \param source, target of both.
double gate_share(const std::vector<MeshSize>& made, const MeshSize& source, const MeshSize& target,
                  const MatchOptions& options);

}  // namespace isograft
