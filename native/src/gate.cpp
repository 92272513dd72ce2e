// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/gate.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/costs.h"
#include "base/parallel.h"
#include "isograft/errors.h"

namespace isograft {

namespace {

Surface make_surface(SurfaceParts parts, Monitor& monitor, double share) {
    try {
        if (parts.is_cloud) return Surface::from_points(std::move(parts.vertices), parts.normals, &monitor, share);
        return Surface::from_mesh(std::move(parts.vertices), std::move(parts.faces), &monitor, share);
    } catch (const InvalidInput& error) {
        throw InvalidInput((parts.name.empty() ? "" : parts.name + ": ") + error.what());
    }
}

}  // namespace

std::vector<Surface> make_surfaces(std::vector<SurfaceParts> parts, int threads, Monitor* monitor) {
    Monitor silent;
    Monitor& watcher = monitor != nullptr ? *monitor : silent;
    std::vector<double> cost;
    double all = 1e-300;
    for (const SurfaceParts& part : parts) {
        cost.push_back(Costs::gate(part.vertices.rows(), part.is_cloud));
        all += cost.back();
    }
    std::vector<std::optional<Surface>> made(parts.size());
    parallel_for(
        static_cast<int>(parts.size()), threads,
        [&](int i, int /*worker*/) { made[i] = make_surface(std::move(parts[i]), watcher, cost[i] / all); }, watcher,
        "surface", 0.0, 0.0);
    watcher.report("surface", 1.0);
    std::vector<Surface> surfaces;
    for (auto& surface : made) surfaces.push_back(std::move(*surface));
    return surfaces;
}

double gate_share(const std::vector<MeshSize>& made, const MeshSize& source, const MeshSize& target,
                  const MatchOptions& options) {
    const Costs costs(options);
    double sum = 0.0, longest = 0.0;
    for (const MeshSize& size : made) {
        const double one = Costs::gate(size.vertices, size.triangles == 0);
        sum += one;
        longest = std::max(longest, one);
    }
    const double gate = costs.side_by_side(sum, longest);
    const double rest = costs.preparation({source.vertices, target.vertices}) + costs.search(source.vertices);
    return gate / std::max(gate + rest, 1e-300);
}

}  // namespace isograft
