// SPDX-License-Identifier: GPL-3.0-or-later
#include "tubes.h"

#include <cmath>

#include "geodesic/trace.h"

namespace isograft {

namespace {

Twins make_tubes(double ripple) {
    shapes::Shape tube = shapes::cylinder(90, 24, 1.0, 1.6);
    for (Eigen::Index v = 0; v < tube.vertices.rows(); ++v) {
        const double angle = std::atan2(tube.vertices(v, 1), tube.vertices(v, 0));
        tube.vertices.row(v).head<2>() *=
            1.0 + 0.14 * std::cos(2.0 * angle) + 0.1 * std::cos(3.0 * angle + 1.0) + ripple * std::cos(15.0 * angle);
    }
    return Twins(tube);
}

}  // namespace

const Twins& tubes() {
    static const Twins once = make_tubes(0.0);
    return once;
}

const Twins& grooved_tubes() {
    static const Twins once = make_tubes(0.01);
    return once;
}

PartialMap turned(const Twins& tubes, double way) {
    PartialMap map = tubes.true_map(tubes.all_samples());
    const SampledMesh& source = tubes.pair().source;
    const TriangleMesh& target = tubes.pair().target.mesh;
    for (const int s : tubes.all_samples()) {
        const int face = source.samples.point[s].face;
        const Eigen::Vector3d around =
            Eigen::Vector3d::UnitZ().cross(source.mesh.axis_x[face].cross(source.mesh.axis_y[face]));
        const Complex along = unit(flatten(source.mesh, face, around)) * map.rotation[s];
        const Trace t = trace(target, map.image[s], along, way * tubes.spacing());
        map.put(target, s, t.end, map.rotation[s] * t.direction * std::conj(along));
    }
    return map;
}

double mean_error(const Twins& of, const PartialMap& map) {
    double sum = 0.0;
    for (const int s : of.all_samples()) {
        if (map.mapped[s]) sum += of.error(s, map.position[s]);
    }
    return sum / map.count;
}

}  // namespace isograft
