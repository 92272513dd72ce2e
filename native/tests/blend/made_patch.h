// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "shapes.h"
#include "twins.h"

namespace isograft {

/// A patch of the blob twins that holds the samples for which keep(position) holds, put where `place` of their true
/// image lies.
template <class Keep, class Place>
Patch made_patch(Keep&& keep, Place&& place) {
    const Twins& twins = Twins::of_a_blob();
    const Pair& pair = twins.pair();
    const Samples& samples = pair.source.samples;
    Patch result;
    result.map = PartialMap(samples.count());
    for (int s = 0; s < samples.count(); ++s) {
        if (!keep(samples.position[s])) continue;
        const OrientedMatch match = twins.true_match(s);
        const SurfacePoint p = shapes::point_nearest(pair.target.mesh, place(position(pair.target.mesh, match.point)));
        result.map.put(pair.target.mesh, s, p, match.rotation);
        result.map.seed = s;
    }
    measure_seed_distance(samples, result.map);
    return result;
}

inline bool everywhere(const Eigen::Vector3d& /*x*/) { return true; }
inline Eigen::Vector3d where_it_belongs(const Eigen::Vector3d& x) { return x; }
inline Eigen::Vector3d at_the_other_end(const Eigen::Vector3d& x) {
    return 2.0 * Twins::of_a_blob().truth(Eigen::Vector3d::Zero()) - x;
}

}  // namespace isograft
