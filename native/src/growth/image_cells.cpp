// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/image_cells.h"

#include <algorithm>

namespace isograft {

void ImageCells::put(const PartialMap& map, int sample) {
    const int home = pair_.target.samples.nearest(pair_.target.mesh, map.image[sample]);
    if (home >= 0) cell_[home].push_back(sample);
}

bool ImageCells::taken(const PartialMap& map, int sample, const SurfacePoint& point, double radius) const {
    const Samples& source = pair_.source.samples;
    const Samples& target = pair_.target.samples;
    const int home = target.nearest(pair_.target.mesh, point);
    if (home < 0) return false;
    const Eigen::Vector3d x = position(pair_.target.mesh, point);
    const auto hit = [&](int index) {
        return std::any_of(cell_[index].begin(), cell_[index].end(), [&](int other) {
            return (map.position[other] - x).norm() < radius &&
                   (source.position[other] - source.position[sample]).norm() > 2.0 * source.spacing;
        });
    };
    const std::vector<int>& around = target.base_edges_of[home];
    return hit(home) ||
           std::any_of(around.begin(), around.end(), [&](int e) { return hit(target.edges[e].other(home)); });
}

}  // namespace isograft
