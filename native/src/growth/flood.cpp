// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/flood.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <queue>
#include <utility>

#include "base/parallel.h"
#include "geodesic/trace.h"

namespace isograft {

namespace {

// A map that does not fill one cell of the top level, nor this share of S, has met a mismatch at once (section 3.3).
constexpr double least_share = 0.1;
// Grown at the same time, whatever the number of threads; redundancy is looked for between batches.
constexpr int batch = 8;
constexpr double same_angle = M_PI / 6.0;

class Flood {
  public:
    Flood(const VertexLevels& source, const TriangleMesh& target, const FloodOptions& options)
        : source_(source),
          target_(target),
          options_(options),
          map_(source.samples.count()),
          carried_(2 * source.near.size()),
          over_(target.vertex_count()) {}

    PartialMap run(const OrientedMatch& match, Monitor& monitor) {
        map_.seed = match.sample;
        add(match.sample, match.point, match.rotation, 0.0F);
        double next_fit = 2.0 * area_;
        while (!queue_.empty()) {
            const auto [distance, u] = queue_.top();
            queue_.pop();
            if (map_.mapped[u] || distance > map_.seed_distance[u]) continue;
            SurfacePoint point;
            Complex rotation;
            if (!predict(u, point, rotation) || covered(u, point)) continue;
            if (map_.count % 64 == 0) monitor.check();
            add(u, point, rotation, distance);
            if (area_ < next_fit || map_.count < 3) continue;
            fit(monitor);
            next_fit = 2.0 * area_;
            requeue();
        }
        fit(monitor);
        measure_way();
        return std::move(map_);
    }

  private:
    using Item = std::pair<float, int>;
    struct Carried {
        int version = -1;
        bool arrived = false;
        SurfacePoint end;
        double length = 0.0;
        Complex direction;
    };

    void add(int u, const SurfacePoint& point, Complex rotation, float distance) {
        map_.put(target_, u, point, rotation);
        over_[nearest_corner(target_, point)].push_back(u);
        map_.seed_distance[u] = distance;
        area_ += source_.samples.area[u];
        offer_around(u);
    }

    // The boundary of U moves from edge to edge: what leaps over a refused vertex would soon be everywhere, and each
    // map would cover half of S. Each new neighbour gives a vertex that was refused another chance.
    void offer_around(int u) {
        for (const int index : source_.near_of[u]) {
            const SampleEdge& e = source_.near[index];
            if (e.level > 0) continue;
            const int v = e.other(u);
            if (map_.mapped[v]) continue;
            float& known = map_.seed_distance[v];
            known = std::min(known, map_.seed_distance[u] + static_cast<float>(e.length));
            queue_.emplace(known, v);
        }
    }

    void requeue() {
        queue_ = {};
        for (int u = 0; u < source_.samples.count(); ++u) {
            if (map_.mapped[u]) offer_around(u);
        }
    }

    void fit(Monitor& monitor) {
        fit_metric(source_.samples, target_, options_.fit, map_, monitor);
        ++version_;
        for (auto& list : over_) list.clear();
        for (int u = 0; u < source_.samples.count(); ++u) {
            if (map_.mapped[u]) over_[nearest_corner(target_, map_.image[u])].push_back(u);
        }
    }

    const Carried& carried(int index, int from) {
        const SampleEdge& e = source_.near[index];
        Carried& c = carried_[2 * index + (from == e.u ? 0 : 1)];
        if (c.version == version_) return c;
        const Trace t =
            trace(target_, map_.image[from], (from == e.u ? e.at_u : e.at_v) * map_.rotation[from], e.length);
        // A boundary may cut the path short by what the stretch may be: else no vertex of a boundary was ever reached.
        const bool arrived = t.length > e.length - options_.stretch_limit * source_.samples.spacing;
        c = {version_, arrived, t.end, t.length, t.direction};
        return c;
    }

    bool predict(int u, SurfacePoint& point, Complex& rotation) {
        seen_.clear();
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (const int index : source_.near_of[u]) {
            const int v = source_.near[index].other(u);
            if (!map_.mapped[v]) continue;
            const Carried& c = carried(index, v);
            if (!c.arrived) continue;
            seen_.emplace_back(index, &c);
            mean += position(target_, c.end);
        }
        if (seen_.empty()) return false;
        mean /= static_cast<double>(seen_.size());
        const Carried* start = nullptr;
        double nearest = 0.0;
        for (const auto& [index, c] : seen_) {
            const double d = (position(target_, c->end) - mean).squaredNorm();
            if (start == nullptr || d < nearest) {
                start = c;
                nearest = d;
            }
        }
        const Complex step = flatten(target_, start->end.face, mean - position(target_, start->end));
        point = std::abs(step) > 1e-12 * source_.samples.spacing ? trace(target_, start->end, step, std::abs(step)).end
                                                                 : start->end;
        const Eigen::Vector3d x = position(target_, point);
        Complex turn(0.0, 0.0);
        for (const auto& [index, c] : seen_) {
            const SampleEdge& e = source_.near[index];
            const Complex arrived = unit(carry(target_, c->end.face, point.face, c->direction));
            const Complex miss = flatten(target_, point.face, x - position(target_, c->end));
            const double reached = std::hypot(c->length + dot(arrived, miss), cross(arrived, miss));
            if (std::abs(reached - e.length) > options_.stretch_limit * source_.samples.spacing) return false;
            turn -= arrived * std::conj(u == e.u ? e.at_u : e.at_v);
        }
        rotation = unit(turn);
        return true;
    }

    // Eq. 5 seen from T: what lies within e0 of the image has to come from N1, or it is nearer on T than on S by more
    // than nu. Shots follow the source's paths and would not notice that a map winds round a limb twice.
    [[nodiscard]] bool covered(int u, const SurfacePoint& point) const {
        const Eigen::Vector3d x = position(target_, point);
        const double radius = source_.samples.spacing;
        const int home = nearest_corner(target_, point);
        const auto hit = [&](int t) {
            return std::any_of(over_[t].begin(), over_[t].end(), [&](int other) {
                if ((map_.position[other] - x).squaredNorm() >= radius * radius) return false;
                const auto& near = source_.near_of[u];
                return std::none_of(near.begin(), near.end(), [&](int e) { return source_.near[e].other(u) == other; });
            });
        };
        if (hit(home)) return true;
        for (int i = target_.vertex_face_begin[home]; i < target_.vertex_face_begin[home + 1]; ++i) {
            for (const int t : target_.face[target_.vertex_face[i]]) {
                if (t != home && hit(t)) return true;
            }
        }
        return false;
    }

    // Seed distances again, now that all of U is known.
    void measure_way() {
        constexpr float far_away = 1e9F;
        std::fill(map_.seed_distance.begin(), map_.seed_distance.end(), far_away);
        std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
        map_.seed_distance[map_.seed] = 0.0F;
        queue.emplace(0.0F, map_.seed);
        while (!queue.empty()) {
            const auto [distance, u] = queue.top();
            queue.pop();
            if (distance > map_.seed_distance[u]) continue;
            for (const int index : source_.near_of[u]) {
                const SampleEdge& e = source_.near[index];
                const int v = e.other(u);
                const float d = distance + static_cast<float>(e.length);
                if (!map_.mapped[v] || d >= map_.seed_distance[v]) continue;
                map_.seed_distance[v] = d;
                queue.emplace(d, v);
            }
        }
    }

    const VertexLevels& source_;
    const TriangleMesh& target_;
    const FloodOptions& options_;
    PartialMap map_;
    double area_ = 0.0;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> queue_;
    std::vector<Carried> carried_;
    int version_ = 0;
    std::vector<std::pair<int, const Carried*>> seen_;
    /// Per target vertex the mapped vertices whose image is nearest to it.
    std::vector<std::vector<int>> over_;
};

double area_of(const Samples& samples, const PartialMap& map) {
    double area = 0.0;
    for (int s = 0; s < samples.count(); ++s) area += map.mapped[s] ? samples.area[s] : 0.0;
    return area;
}

// Small maps agree with each other wherever they lie, since two images in a small region are never far apart; many of
// them would be the densest cluster of all.
double least_area(const VertexLevels& source) {
    const Samples& samples = source.samples;
    const int top = *std::max_element(samples.level.begin(), samples.level.end());
    const double cell = M_PI / 4.0 * source.spacing(top) * source.spacing(top);
    return std::min(cell, least_share * std::accumulate(samples.area.begin(), samples.area.end(), 0.0));
}

bool explained(const VertexLevels& source, const TriangleMesh& target, const std::vector<PartialMap>& maps,
               const OrientedMatch& match) {
    const Eigen::Vector3d x = position(target, match.point);
    return std::any_of(maps.begin(), maps.end(), [&](const PartialMap& map) {
        if (!map.mapped[match.sample]) return false;
        if ((map.position[match.sample] - x).norm() > source.spacing(1)) return false;
        const Complex turn = carry(target, map.image[match.sample].face, match.point.face, map.rotation[match.sample]);
        return std::abs(std::arg(turn * std::conj(match.rotation))) < same_angle;
    });
}

}  // namespace

PartialMap flood(const VertexLevels& source, const TriangleMesh& target, const OrientedMatch& match,
                 const FloodOptions& options, Monitor& monitor) {
    return Flood(source, target, options).run(match, monitor);
}

Floods flood_all(const VertexLevels& source, const TriangleMesh& target, const std::vector<OrientedMatch>& matches,
                 int most, const FloodOptions& options, int threads, Monitor& monitor, double from, double to) {
    Floods result;
    // Those that wait, by the order of their scores: of redundant matches the surest come before what no cluster holds.
    std::vector<OrientedMatch> waiting;
    std::size_t next = 0, clustered = 0;
    const double least = least_area(source);
    while (clustered < matches.size() && std::isfinite(matches[clustered].score)) ++clustered;
    const auto grow = [&](const std::vector<OrientedMatch>& chosen) {
        const double begin = from + (to - from) * result.tried / most;
        result.tried += static_cast<int>(chosen.size());
        std::vector<PartialMap> grown(chosen.size());
        parallel_for(
            static_cast<int>(chosen.size()), threads,
            [&](int i, int /*worker*/) { grown[i] = flood(source, target, chosen[i], options, monitor); }, monitor,
            "growth", begin, from + (to - from) * result.tried / most);
        for (PartialMap& map : grown) {
            if (area_of(source.samples, map) >= least) result.maps.push_back(std::move(map));
        }
    };
    const auto room = [&] { return static_cast<std::size_t>(std::min(batch, most - result.tried)); };
    for (const std::size_t end : {clustered, matches.size()}) {
        while (next < end && result.tried < most) {
            std::vector<OrientedMatch> chosen;
            for (; next < end && chosen.size() < room(); ++next) {
                const bool known = explained(source, target, result.maps, matches[next]);
                (known ? waiting : chosen).push_back(matches[next]);
            }
            grow(chosen);
        }
        result.redundant += static_cast<int>(waiting.size());
        for (std::size_t again = 0; again < waiting.size() && result.tried < most;) {
            std::vector<OrientedMatch> chosen;
            for (; again < waiting.size() && chosen.size() < room(); ++again) chosen.push_back(waiting[again]);
            grow(chosen);
        }
        waiting.clear();
    }
    return result;
}

}  // namespace isograft
