// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/distance_fields.h"

#include <limits>
#include <utility>

namespace isograft {

namespace {

constexpr float unreached = 9.0F;
constexpr double everywhere = std::numeric_limits<double>::infinity();

DistanceField empty_field(int size) {
    return {std::vector<float>(size, unreached), std::vector<Sight>(size, Sight::none), {}};
}

}  // namespace

template <class Measure>
DistanceFields::Slot DistanceFields::once(Slot& slot, Measure&& measure) {
    {
        const std::lock_guard lock(mutex_);
        if (slot) return slot;
    }
    Slot made = std::make_shared<const DistanceField>(measure());
    const std::lock_guard lock(mutex_);
    if (!slot) slot = std::move(made);
    return slot;
}

std::shared_ptr<const DistanceField> DistanceFields::from_sample(int sample, Window& window) {
    return once(of_source_[sample], [&] {
        const Samples& samples = pair_.source.samples;
        DistanceField field = empty_field(samples.count());
        window.run(samples.point[sample], everywhere);
        for (int s = 0; s < samples.count(); ++s) {
            const auto polar = window.query(samples.point[s]);
            if (!polar) continue;
            field.distance[s] = static_cast<float>(polar->distance);
            field.sight[s] = window.bent_at(samples.point[s]) ? Sight::bent : Sight::straight;
        }
        return field;
    });
}

std::shared_ptr<const DistanceField> DistanceFields::from_vertex(int vertex, Window& window) {
    return once(of_target_[vertex], [&] {
        const TriangleMesh& mesh = pair_.target.mesh;
        DistanceField field = empty_field(mesh.vertex_count());
        field.departure.assign(mesh.vertex_count(), 0.0F);
        window.run(point_near_vertex(mesh, vertex), everywhere);
        for (const int v : window.reached()) {
            field.departure[v] = static_cast<float>(window.angle(v));
            field.distance[v] = static_cast<float>(window.distance(v));
            field.sight[v] = window.bent(v) ? Sight::bent : Sight::straight;
        }
        return field;
    });
}

}  // namespace isograft
