// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/registration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "blend/merge.h"
#include "geodesic/trace.h"
#include "growth/image_cells.h"
#include "growth/rigid_step.h"
#include "surface/kd_tree.h"

namespace isograft {

namespace {

using Eigen::Vector3d;

// Lengths are in the pair's unit length where nothing else is said.

// Width of the Gaussian weight of surroundings, which reach twice as far.
constexpr double width = 0.08;
// Vertices of the surroundings beside their samples.
constexpr double most_vertices = 100.0;
constexpr std::size_t fewest_points = 12;
// Mapped samples that a motion is taken from; those across a gap at most so far, and so many.
constexpr int fewest_known = 4;
constexpr double widest_gap = 0.15;
constexpr std::size_t most_across = 30;
constexpr int steps = 4;
// A point this far from T's nearest vertex has no counterpart there; at the other distance it has lost half its weight.
constexpr double far = 0.04, soft = 0.01;
// Cosine between normals of one side of a thin part.
constexpr double same_side = 0.5;
// A point lies on T if it is not higher above it, not farther beside its nearest vertex than an edge is long, and its
// normal is not more turned (cosine).
constexpr double highest = 0.008, same_normal = 0.7;
// Weighted share of the surroundings that lie on T, and their mean height.
constexpr double least_share = 0.5, most_height = 0.003;
// How far beside the surface the sample itself may come to lie, and up to what distance a place is taken; in spacings.
constexpr double beside = 0.3, taken = 0.75;
// Each moves the front on by a spacing: of longer pieces the rest stays out.
constexpr int most_rounds = 60;

struct Placed {
    SurfacePoint point;
    Complex rotation;
    double height = 0.0;
};

class Registration {
  public:
    /// One a thread.
    using Scratch = std::vector<KdTree::Found>;

    explicit Registration(const Pair& pair)
        : pair_(pair), tree_(pair.target.mesh.position), vertices_(vertices_of(pair.source)) {}

    // Where the sample comes to lie; nothing where its surroundings do not fit.
    [[nodiscard]] std::optional<Placed> place(const PartialMap& map, int sample, Scratch& found) const {
        const std::vector<int> around =
            samples_around(pair_.source.samples, sample, 2.0 * width, [](int /*other*/) { return true; });
        std::optional<RigidMotion> motion = motion_around(map, sample, around);
        if (!motion) return std::nullopt;
        const std::vector<Point> points = points_of(sample, around);
        if (points.size() < fewest_points || !lay(points, sample, *motion, found)) return std::nullopt;
        return judge(points, sample, *motion, found);
    }

    // Whether `other` is mapped and may move the sample across a gap.
    [[nodiscard]] bool moves_across(const PartialMap& map, int other, int sample) const {
        return map.mapped[other] != 0 && distance(other, sample) <= widest_gap &&
               normal(sample).dot(normal(other)) > 0.0;
    }

  private:
    struct Point {
        Vector3d position, normal;
        double weight;
    };
    // Of a point, moved to `x`, from T.
    struct Gap {
        Vector3d x;
        int vertex;
        double height, beside, cosine;
    };

    [[nodiscard]] const Vector3d& normal(int sample) const {
        return pair_.source.mesh.normal[pair_.source.samples.point[sample].face];
    }

    [[nodiscard]] double distance(int sample, int other) const {
        const Samples& source = pair_.source.samples;
        return (source.position[sample] - source.position[other]).norm();
    }

    [[nodiscard]] double weight(const Vector3d& x, int sample) const {
        return falloff((x - pair_.source.samples.position[sample]).squaredNorm(), width);
    }

    // The mapped samples around move the others; where they are too few, those across a gap as well.
    [[nodiscard]] std::optional<RigidMotion> motion_around(const PartialMap& map, int sample,
                                                           const std::vector<int>& around) const {
        const Samples& source = pair_.source.samples;
        std::vector<int> known;
        for (const int s : around) {
            if (map.mapped[s]) known.push_back(s);
        }
        if (known.size() < fewest_known) {
            std::vector<std::pair<double, int>> across;
            for (int s = 0; s < source.count(); ++s) {
                if (!moves_across(map, s, sample)) continue;
                if (std::find(known.begin(), known.end(), s) == known.end()) {
                    across.emplace_back(distance(s, sample), s);
                }
            }
            std::sort(across.begin(), across.end());
            if (across.size() > most_across) across.resize(most_across);
            for (const auto& [apart, s] : across) known.push_back(s);
        }
        if (known.size() < fewest_known) return std::nullopt;
        std::vector<double> weights;
        weights.reserve(known.size());
        for (const int s : known) weights.push_back(weight(source.position[s], sample));
        return motion_of(map, source, known, weights);
    }

    // The sample itself first.
    [[nodiscard]] std::vector<Point> points_of(int sample, const std::vector<int>& around) const {
        const TriangleMesh& mesh = pair_.source.mesh;
        std::vector<Point> points;
        for (const int s : around) {
            const Vector3d& x = pair_.source.samples.position[s];
            points.push_back({x, normal(s), weight(x, sample)});
        }
        spread_vertices(vertices_, around, most_vertices, [&](std::size_t /*i*/, int v) {
            points.push_back({mesh.position[v], mesh.vertex_normal[v], weight(mesh.position[v], sample)});
        });
        return points;
    }

    [[nodiscard]] Gap gap_of(const Point& point, const RigidMotion& motion, Scratch& found) const {
        const TriangleMesh& mesh = pair_.target.mesh;
        const Vector3d x = motion(point.position);
        tree_.nearest(x, 1, found);
        const int vertex = found.front().index;
        const Vector3d& plane = mesh.vertex_normal[vertex];
        const Vector3d gap = mesh.position[vertex] - x;
        const double height = gap.dot(plane);
        return {x, vertex, height, (gap - height * plane).norm(), plane.dot(motion.turn * point.normal)};
    }

    [[nodiscard]] bool lay(const std::vector<Point>& points, int sample, RigidMotion& motion, Scratch& found) const {
        const TriangleMesh& mesh = pair_.target.mesh;
        for (int k = 0; k < steps; ++k) {
            RigidStep step(motion(pair_.source.samples.position[sample]), width);
            for (const Point& point : points) {
                const Gap gap = gap_of(point, motion, found);
                if (std::hypot(gap.height, gap.beside) > far || gap.cosine < same_side) continue;
                const double trust = 1.0 / (1.0 + gap.height * gap.height / (soft * soft));
                step.add(gap.x, mesh.vertex_normal[gap.vertex], gap.height, point.weight * trust);
            }
            if (step.points() == 0 || !step.apply(motion)) return false;
        }
        return true;
    }

    [[nodiscard]] std::optional<Placed> judge(const std::vector<Point>& points, int sample, const RigidMotion& motion,
                                              Scratch& found) const {
        const TriangleMesh& mesh = pair_.target.mesh;
        const Samples& source = pair_.source.samples;
        const auto lies_on_target = [&](const Gap& gap) {
            return std::abs(gap.height) < highest && gap.beside < mesh.mean_edge && gap.cosine > same_normal;
        };
        const Gap own = gap_of(points.front(), motion, found);
        if (!lies_on_target(own)) return std::nullopt;
        double all = 0.0, on_target = 0.0, height = 0.0;
        for (const Point& point : points) {
            all += point.weight;
            const Gap gap = gap_of(point, motion, found);
            if (!lies_on_target(gap)) continue;
            on_target += point.weight;
            height += point.weight * std::abs(gap.height);
        }
        height /= on_target;
        if (on_target < least_share * all || height > most_height) return std::nullopt;
        const Vector3d x = motion(source.position[sample]);
        const SurfacePoint point = walked_to(mesh, point_near_vertex(mesh, own.vertex), x);
        if ((position(mesh, point) - x).norm() > beside * source.spacing) return std::nullopt;
        const Vector3d axis = motion.turn * pair_.source.mesh.axis_x[source.point[sample].face];
        const Complex ahead = flatten(mesh, point.face, axis);
        if (std::abs(ahead) < same_side) return std::nullopt;
        return Placed{point, unit(ahead), height};
    }

    const Pair& pair_;
    KdTree tree_;
    std::vector<std::vector<int>> vertices_;
};

// Unmapped samples beside the map that were not tried with as many mapped neighbours yet, and those of pieces across a
// gap, once.
class Front {
  public:
    explicit Front(const Pair& pair) : pair_(pair), tried_(pair.source.samples.count(), untried) {}

    std::vector<int> next(const PartialMap& map, const Registration& registration, Monitor& monitor) {
        const Samples& source = pair_.source.samples;
        std::vector<char> begun(pair_.source.mesh.component_count, 0);
        for (int s = 0; s < source.count(); ++s) {
            if (map.mapped[s]) begun[component(s)] = 1;
        }
        std::vector<int> result;
        for (int s = 0; s < source.count(); ++s) {
            if (map.mapped[s]) continue;
            monitor.check();
            int neighbours = 0;
            for (const int e : source.base_edges_of[s]) neighbours += map.mapped[source.edges[e].other(s)];
            if (tried_[s] == neighbours) continue;
            if (neighbours == 0 && (begun[component(s)] || !is_near(map, s, registration))) continue;
            tried_[s] = neighbours;
            result.push_back(s);
        }
        return result;
    }

  private:
    static constexpr int untried = -1;

    [[nodiscard]] int component(int sample) const {
        return pair_.source.mesh.component[pair_.source.samples.point[sample].face];
    }
    [[nodiscard]] bool is_near(const PartialMap& map, int sample, const Registration& registration) const {
        const Samples& source = pair_.source.samples;
        int near = 0;
        for (int s = 0; s < source.count() && near < fewest_known; ++s) {
            near += registration.moves_across(map, s, sample) ? 1 : 0;
        }
        return near == fewest_known;
    }

    const Pair& pair_;
    /// Mapped neighbours when it was tried last.
    std::vector<int> tried_;
};

// Most mapped neighbours are as far away as on S.
bool keeps_lengths(const PartialMap& map, const Samples& source, int sample, const Vector3d& x) {
    int kept = 0, broken = 0;
    for (const int e : source.base_edges_of[sample]) {
        const int other = source.edges[e].other(sample);
        if (!map.mapped[other]) continue;
        ++(keeps_length(source, source.edges[e], x, map.position[other]) ? kept : broken);
    }
    return kept > broken || kept + broken == 0;
}

}  // namespace

int extend_by_registration(PartialMap& map, const Pair& pair, std::vector<double>& risk, int threads,
                           Monitor& monitor) {
    const Samples& source = pair.source.samples;
    if (map.count == 0 || map.count == source.count()) return 0;
    const TriangleMesh& target = pair.target.mesh;
    const int before = map.count;
    const Registration registration(pair);
    ImageCells images(pair);
    for (int s = 0; s < source.count(); ++s) {
        if (map.mapped[s]) images.put(map, s);
    }
    Front front(pair);
    std::vector<Registration::Scratch> found(worker_count(threads));
    for (int round = 0; round < most_rounds; ++round) {
        const std::vector<int> samples = front.next(map, registration, monitor);
        std::vector<std::optional<Placed>> placed(samples.size());
        parallel_for(
            static_cast<int>(samples.size()), threads,
            [&](int i, int worker) { placed[i] = registration.place(map, samples[i], found[worker]); }, monitor);
        std::vector<int> order;
        for (std::size_t i = 0; i < placed.size(); ++i) {
            if (placed[i]) order.push_back(static_cast<int>(i));
        }
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return placed[a]->height < placed[b]->height; });
        const int count = map.count;
        for (const int i : order) {
            const int s = samples[i];
            const SurfacePoint& point = placed[i]->point;
            if (images.taken(map, s, point, taken * source.spacing)) continue;
            if (!keeps_lengths(map, source, s, position(target, point))) continue;
            map.put(target, s, point, placed[i]->rotation);
            images.put(map, s);
            risk[s] = registered_doubt;
        }
        if (map.count == count) break;
    }
    return map.count - before;
}

}  // namespace isograft
