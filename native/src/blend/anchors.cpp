// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace isograft {

namespace {
constexpr int most_anchors = 64;
// Samples of this level and above, some sixty, are taken first: other maps have measured from them already.
constexpr int common_level = 2;
}  // namespace

// An image lies up to half an edge beside its vertex, and that much nearer to what is ahead: a tenth of the distance to
// the next anchor would be too much to leave out.
std::vector<float> Anchors::from_image(const DistanceField& field, int vertex, const SurfacePoint& image) const {
    const TriangleMesh& mesh = fields_.pair().target.mesh;
    const SurfacePoint centre = point_near_vertex(mesh, vertex);
    const Eigen::Vector3d gap = position(mesh, image) - position(mesh, centre);
    const Complex along = flatten(mesh, centre.face, gap);
    const auto length = static_cast<float>(gap.norm());
    const auto direction = static_cast<float>(std::arg(along));
    std::vector<float> result = field.distance;
    for (std::size_t v = 0; v < result.size(); ++v) {
        if (field.sight[v] == Sight::none) continue;
        // The cosine law: exact on the plane, and right beside the vertex too.
        const float d = field.distance[v];
        const float square = d * d + length * length - 2.0F * d * length * std::cos(field.departure[v] - direction);
        result[v] = std::sqrt(std::max(0.0F, square));
    }
    return result;
}

bool Anchors::place(const PartialMap& map, int count, Monitor& monitor) {
    const Pair& pair = fields_.pair();
    const Samples& samples = pair.source.samples;
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
    // The same start again keeps most anchors where they are.
    if (!anchors_.empty() && map.mapped[anchors_.front().sample]) current = anchors_.front().sample;
    anchors_.clear();
    Window source_window(pair.source.mesh);
    Window target_window(pair.target.mesh);
    std::vector<float> nearest(samples.count(), std::numeric_limits<float>::max());
    for (int k = 0; k < std::min(count, most_anchors) && current >= 0; ++k) {
        monitor.check();
        const int vertex = nearest_corner(pair.target.mesh, map.image[current]);
        const auto field = fields_.from_vertex(vertex, target_window);
        anchors_.push_back({current, fields_.from_sample(current, source_window), field,
                            from_image(*field, vertex, map.image[current])});
        const std::vector<float>& away = anchors_.back().source->distance;
        current = -1;
        bool shared = false;
        float farthest = 0.0F;
        for (int s = 0; s < samples.count(); ++s) {
            nearest[s] = std::min(nearest[s], away[s]);
            if (!map.mapped[s] || nearest[s] <= 0.0F) continue;
            const bool common = samples.level[s] >= common_level;
            if (common < shared || (common == shared && nearest[s] <= farthest)) continue;
            shared = common;
            farthest = nearest[s];
            current = s;
        }
    }
    return true;
}

double Anchors::incompatibility(int sample, const SurfacePoint& point) const {
    std::array<double, most_anchors> difference{};
    int count = 0;
    const auto& corners = fields_.pair().target.mesh.face[point.face];
    for (const Anchor& anchor : anchors_) {
        const Sight on_source = anchor.source->sight[sample];
        Sight on_target = Sight::straight;
        double target = 0.0;
        for (int k = 0; k < 3; ++k) {
            target += point.weight[k] * anchor.target_distance[corners[k]];
            on_target = std::max(on_target, anchor.target->sight[corners[k]]);
        }
        if (on_source == Sight::none || on_target == Sight::none) continue;
        const double source = anchor.source->distance[sample];
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
