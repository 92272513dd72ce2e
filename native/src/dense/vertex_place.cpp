// SPDX-License-Identifier: GPL-3.0-or-later
#include "dense/vertex_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geodesic/trace.h"

namespace isograft {

std::optional<VertexPlace> place_of_vertex(int vertex, const PartialMap& map, const Pair& pair, double reach) {
    struct Landing {
        SurfacePoint point;
        Eigen::Vector3d position;
    };
    const TriangleMesh& target = pair.target.mesh;
    VertexPlace place;
    std::vector<Landing> landings;
    double nearest = std::numeric_limits<double>::max();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const NearSample& near : pair.source.samples.near_vertex[vertex]) {
        if (!map.mapped[near.sample]) continue;
        const double d = std::max<double>(near.distance, 1e-6);
        const Trace t = trace(target, map.image[near.sample],
                              std::polar(1.0, static_cast<double>(near.angle)) * map.rotation[near.sample], d);
        if (!t.complete) continue;
        const double weight = 1.0 / (d * d);
        landings.push_back({t.end, position(target, t.end)});
        place.said.push_back({near.sample, weight});
        place.total += weight;
        mean += weight * landings.back().position;
        nearest = std::min(nearest, d);
    }
    if (nearest > reach) return std::nullopt;
    mean /= place.total;
    const auto start = std::min_element(landings.begin(), landings.end(), [&](const Landing& a, const Landing& b) {
        return (a.position - mean).squaredNorm() < (b.position - mean).squaredNorm();
    });
    place.point = walked_to(target, start->point, mean);
    place.position = position(target, place.point);
    return place;
}

namespace {

// Of a point between the vertices of its triangle: its place, and by what the triangle turns.
void put_between(const SurfacePoint& point, const std::array<VertexPlace, 3>& corner, int sample, const Pair& pair,
                 PartialMap& map) {
    const TriangleMesh& source = pair.source.mesh;
    const TriangleMesh& target = pair.target.mesh;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) mean += point.weight[k] * corner[k].position;
    const auto heaviest = std::max_element(point.weight.begin(), point.weight.end()) - point.weight.begin();
    // Corners torn apart do not average to anything.
    if ((mean - corner[heaviest].position).norm() > 2.0 * pair.source.samples.spacing) return;
    const SurfacePoint image = walked_to(target, corner[heaviest].point, mean);
    const Eigen::Vector3d x = position(target, image);
    Complex turn(0.0, 0.0);
    for (int k = 0; k < 3; ++k) {
        const Complex on_source = source.corner[point.face][k] - planar(source, point);
        turn += flatten(target, image.face, corner[k].position - x) * std::conj(on_source);
    }
    if (std::abs(turn) > 0.0) map.put(target, sample, image, unit(turn));
}

}  // namespace

PartialMap carried_over(const PartialMap& map, const Pair& from, const Pair& to) {
    const Samples& samples = to.source.samples;
    PartialMap result(samples.count());
    for (int s = 0; s < samples.count(); ++s) {
        std::array<VertexPlace, 3> corner;
        bool known = true;
        for (int k = 0; k < 3 && known; ++k) {
            const int vertex = to.source.mesh.face[samples.point[s].face][k];
            auto place = place_of_vertex(vertex, map, from, from.source.samples.spacing);
            known = place.has_value();
            if (known) corner[k] = std::move(*place);
        }
        if (!known) continue;
        put_between(samples.point[s], corner, s, to, result);
        if (result.mapped[s] == 0) continue;
        result.seed_distance[s] = 0.0F;
        if (result.seed < 0) result.seed = s;
    }
    return result;
}

}  // namespace isograft
