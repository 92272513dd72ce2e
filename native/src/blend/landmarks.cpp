// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/landmarks.h"

namespace isograft {

Heed heed(const PartialMap& map, const Pair& pair, const std::vector<double>& weight) {
    constexpr double near = 0.1;
    Heed result;
    double all = 0.0;
    for (std::size_t i = 0; i < weight.size(); ++i) {
        all += weight[i];
        if (map.mapped[i] == 0) continue;
        if ((map.position[i] - pair.target.samples.position[i]).norm() < near) {
            result.kept += weight[i];
            ++result.kept_count;
        } else {
            result.broken += weight[i];
        }
    }
    if (all > 0.0) result.share = 0.5 * (1.0 + (result.kept - result.broken) / all);
    return result;
}

}  // namespace isograft
