// SPDX-License-Identifier: GPL-3.0-or-later
#include "blend/centroid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "geodesic/trace.h"
#include "geodesic/window.h"

namespace isograft {

namespace {

constexpr int rounds = 4;

struct Vote {
    const PartialMap* map;
    double weight;
};

class Centroid {
  public:
    Centroid(const TriangleMesh& target, double e0) : target_(target), e0_(e0), window_(target) {}

    /// The centre of the images of vertex `s`, its rotation, and how far the images lie from it.
    void find(int s, const std::vector<Vote>& votes, SurfacePoint& point, Complex& rotation, double& spread) {
        const Vote* surest = &votes.front();
        for (const Vote& v : votes) {
            if (v.weight > surest->weight) surest = &v;
        }
        point = surest->map->image[s];
        rotation = surest->map->rotation[s];
        spread = 0.0;
        if (votes.size() == 1) return;
        for (int round = 0; round < rounds; ++round) {
            look(s, votes, point);
            Complex mean(0.0, 0.0);
            double total = 0.0;
            for (std::size_t i = 0; i < votes.size(); ++i) {
                if (!seen_[i]) continue;
                mean += votes[i].weight * way_[i];
                total += votes[i].weight;
            }
            mean /= total;
            if (std::abs(mean) < 1e-6 * e0_) break;
            const Trace t = trace(target_, point, mean, std::abs(mean));
            rotation *= t.direction * std::conj(unit(mean));
            point = t.end;
        }
        look(s, votes, point);
        Complex turn(0.0, 0.0);
        double total = 0.0;
        for (std::size_t i = 0; i < votes.size(); ++i) {
            if (!seen_[i]) continue;
            spread += votes[i].weight * std::abs(way_[i]);
            total += votes[i].weight;
            // Frames of images nearby can be compared; those far away have been turned on the way.
            if (std::abs(way_[i]) < 4.0 * e0_) {
                const PartialMap& map = *votes[i].map;
                turn += votes[i].weight * carry(target_, map.image[s].face, point.face, map.rotation[s]);
            }
        }
        spread = total > 0.0 ? spread / (total * e0_) : 0.0;
        if (std::abs(turn) > 1e-12) rotation = unit(turn);
    }

  private:
    // The logarithm of every image at `centre`: straight where all are near, else from a window.
    void look(int s, const std::vector<Vote>& votes, const SurfacePoint& centre) {
        const Eigen::Vector3d x = position(target_, centre);
        double farthest = 0.0;
        for (const Vote& v : votes) farthest = std::max(farthest, (v.map->position[s] - x).norm());
        way_.assign(votes.size(), Complex(0.0, 0.0));
        seen_.assign(votes.size(), 1);
        const bool near = farthest < 3.0 * e0_;
        if (!near) window_.run(centre, 3.0 * farthest + 2.0 * e0_);
        for (std::size_t i = 0; i < votes.size(); ++i) {
            if (near) {
                const Eigen::Vector3d miss = votes[i].map->position[s] - x;
                way_[i] = unit(flatten(target_, centre.face, miss)) * miss.norm();
                continue;
            }
            const auto polar = window_.query(votes[i].map->image[s]);
            if (polar) {
                way_[i] = std::polar(polar->distance, polar->angle);
            } else {
                seen_[i] = 0;
            }
        }
    }

    const TriangleMesh& target_;
    double e0_;
    Window window_;
    std::vector<Complex> way_;
    std::vector<char> seen_;
};

}  // namespace

MergedMap merge_by_centroid(const VertexLevels& source, const TriangleMesh& target,
                            const std::vector<const PartialMap*>& maps, double decay, int threads, Monitor& monitor,
                            double from, double to) {
    const int n = source.samples.count();
    MergedMap merged{PartialMap(n), std::vector<double>(n, 0.0)};
    std::vector<char> found(n, 0);
    std::vector<SurfacePoint> point(n);
    std::vector<Complex> rotation(n);
    std::vector<Centroid> centroid(worker_count(threads), Centroid(target, source.samples.spacing));
    std::vector<std::vector<Vote>> votes(worker_count(threads));
    parallel_for(
        n, threads,
        [&](int s, int worker) {
            std::vector<Vote>& mine = votes[worker];
            mine.clear();
            // Relative to the nearest seed, so that far from all of them weights do not vanish together.
            float nearest = std::numeric_limits<float>::max();
            for (const PartialMap* map : maps) {
                if (map->mapped[s]) nearest = std::min(nearest, map->seed_distance[s]);
            }
            for (const PartialMap* map : maps) {
                if (map->mapped[s]) mine.push_back({map, std::exp((nearest - map->seed_distance[s]) / decay)});
            }
            if (mine.empty()) return;
            found[s] = 1;
            centroid[worker].find(s, mine, point[s], rotation[s], merged.spread[s]);
        },
        monitor, "merge", from, to);
    for (int s = 0; s < n; ++s) {
        if (found[s]) merged.map.put(target, s, point[s], rotation[s]);
    }
    return merged;
}

}  // namespace isograft
