// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/shoot.h"

#include <algorithm>
#include <limits>

namespace isograft {

std::optional<Shot> shoot(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to, Complex direction,
                          double length, const ShootOptions& options) {
    const Eigen::Vector3d target = position(mesh, to);
    direction = unit(direction);
    double best_miss = std::numeric_limits<double>::max();
    Shot best;
    for (int i = 0; i < options.max_traces; ++i) {
        const Trace t = trace(mesh, from, direction, length);
        const Eigen::Vector3d miss = target - position(mesh, t.end);
        const double missed = miss.norm();
        if (!t.complete && missed > 0.5 * length) return std::nullopt;
        const Complex seen = flatten(mesh, t.end.face, miss);
        // A miss seen at a slant is longer than its tangent part.
        const double slant = missed > 1e-12 * length ? std::min(1.5, missed / std::max(1e-300, modulus(seen))) : 1.0;
        const double ahead = t.length + slant * dot(t.direction, seen);
        const double aside = slant * cross(t.direction, seen);
        if (ahead <= 0.2 * length) return std::nullopt;
        const double corrected = modulus({ahead, aside});
        const Complex turn = Complex(ahead, aside) * (1.0 / corrected);
        direction *= turn;
        if (missed < best_miss) {
            best_miss = missed;
            best.length = corrected;
            best.departure = direction;
            best.arrival = unit(carry(mesh, t.end.face, to.face, t.direction * turn));
        }
        length = corrected;
        if (missed < options.tolerance * length) break;
    }
    if (best_miss > 0.15 * best.length) return std::nullopt;
    return best;
}

}  // namespace isograft
