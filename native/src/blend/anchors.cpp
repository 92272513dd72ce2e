// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geodesic/window.h"

namespace isograft {

namespace {
constexpr float unreached = 9.0F;
constexpr int most_anchors = 64;
// Images nearer than this, in sample spacings, share their windows.
constexpr double same_place = 0.25;
}  // namespace

void Anchors::measure_source(Anchor& anchor, Window& window) const {
    const Samples& samples = pair_.source.samples;
    anchor.source_distance.assign(samples.count(), unreached);
    anchor.source_sight.assign(samples.count(), Sight::none);
    window.run(samples.point[anchor.sample], std::numeric_limits<double>::infinity());
    for (int s = 0; s < samples.count(); ++s) {
        const auto polar = window.query(samples.point[s]);
        if (!polar) continue;
        anchor.source_distance[s] = static_cast<float>(polar->distance);
        anchor.source_sight[s] = window.bent_at(samples.point[s]) ? Sight::bent : Sight::straight;
    }
}

void Anchors::measure_target(Anchor& anchor, Window& window) const {
    const TriangleMesh& mesh = pair_.target.mesh;
    anchor.target_distance.assign(mesh.vertex_count(), unreached);
    anchor.target_sight.assign(mesh.vertex_count(), Sight::none);
    window.run(anchor.image, std::numeric_limits<double>::infinity());
    for (const int v : window.reached()) {
        anchor.target_distance[v] = static_cast<float>(window.distance(v));
        anchor.target_sight[v] = window.bent(v) ? Sight::bent : Sight::straight;
    }
}

bool Anchors::place(const PartialMap& map, int count, Monitor& monitor) {
    const Samples& samples = pair_.source.samples;
    // Start in the thick of the map, where nothing is bent.
    int current = -1;
    int most = -1;
    for (int s = 0; s < samples.count(); ++s) {
        if (!map.mapped[s]) continue;
        int mapped = 0;
        for (const int e : samples.edges_of[s]) mapped += map.mapped[samples.edges[e].other(s)];
        if (mapped > most) {
            most = mapped;
            current = s;
        }
    }
    if (current < 0) return false;
    std::vector<Anchor> before = std::move(anchors_);
    anchors_.clear();
    // The same start again keeps most anchors, and their windows, where they are.
    if (!before.empty() && map.mapped[before.front().sample]) current = before.front().sample;
    Window source_window(pair_.source.mesh);
    Window target_window(pair_.target.mesh);
    std::vector<float> nearest(samples.count(), std::numeric_limits<float>::max());
    for (int k = 0; k < std::min(count, most_anchors) && current >= 0; ++k) {
        monitor.check();
        Anchor anchor;
        const auto old =
            std::find_if(before.begin(), before.end(), [&](const Anchor& a) { return a.sample == current; });
        if (old != before.end()) anchor = std::move(*old);
        if (anchor.sample < 0) {
            anchor.sample = current;
            measure_source(anchor, source_window);
        }
        const bool stayed = !anchor.target_distance.empty() &&
                            (anchor.image_position - map.position[current]).norm() < same_place * samples.spacing;
        if (!stayed) {
            anchor.image = map.image[current];
            anchor.image_position = map.position[current];
            measure_target(anchor, target_window);
        }
        anchors_.push_back(std::move(anchor));
        const Anchor& placed = anchors_.back();
        current = -1;
        float farthest = 0.0F;
        for (int s = 0; s < samples.count(); ++s) {
            nearest[s] = std::min(nearest[s], placed.source_distance[s]);
            if (map.mapped[s] && nearest[s] > farthest) {
                farthest = nearest[s];
                current = s;
            }
        }
    }
    return true;
}

double Anchors::incompatibility(int sample, const SurfacePoint& point) const {
    std::array<double, most_anchors> difference{};
    int count = 0;
    const auto& corners = pair_.target.mesh.face[point.face];
    for (const Anchor& anchor : anchors_) {
        const Sight on_source = anchor.source_sight[sample];
        Sight on_target = Sight::straight;
        double target = 0.0;
        for (int k = 0; k < 3; ++k) {
            target += point.weight[k] * anchor.target_distance[corners[k]];
            on_target = std::max(on_target, anchor.target_sight[corners[k]]);
        }
        if (on_source == Sight::none || on_target == Sight::none) continue;
        const double source = anchor.source_distance[sample];
        const double excess = target - source;
        if (on_source == Sight::bent && (on_target == Sight::bent || excess < 0.0)) continue;
        if (on_target == Sight::bent && excess > 0.0) continue;
        // A tenth of a long way is what bending a joint changes.
        difference[count++] = std::max(0.0, std::abs(excess) - 0.1 * source) / (0.1 + 0.5 * source);
    }
    if (count < 3) return count > 0 ? 0.1 : 0.15;
    std::sort(difference.begin(), difference.begin() + count);
    const int kept = std::max(1, 3 * count / 4);
    double sum = 0.0;
    for (int i = 0; i < kept; ++i) sum += difference[i];
    return sum / kept;
}

}  // namespace isograft
