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

constexpr int rounds = 3;
// In e0: a step that is not worth another look, and one that is none.
constexpr double near_enough = 1.0;
constexpr double no_step = 0.01;

struct Vote {
    const PartialMap* map;
    double weight;
};

class Centroid {
  public:
    Centroid(const TriangleMesh& target, double e0) : target_(target), e0_(e0), window_(target) {}

    /// The centre of the images of vertex `s`, its rotation, and how far the images lie from it.
    void find(int s, const std::vector<Vote>& votes, SurfacePoint& point, Complex& rotation, double& spread) {
        const PartialMap& start = *most_central(s, votes).map;
        point = start.image[s];
        rotation = start.rotation[s];
        spread = 0.0;
        if (votes.size() == 1) return;
        for (int round = 0; round < rounds; ++round) {
            look(s, votes, point);
            const Complex step = median(votes);
            const double length = std::abs(step);
            for (Complex& way : way_) way -= step;
            if (length < no_step * e0_) break;
            const Trace t = trace(target_, point, step, length);
            rotation *= t.direction * std::conj(unit(step));
            point = t.end;
            if (length < near_enough * e0_) break;
        }
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
    // Of the images themselves the one with the least sum of eq. 10, straight through space.
    static const Vote& most_central(int s, const std::vector<Vote>& votes) {
        const Vote* best = nullptr;
        double least = std::numeric_limits<double>::infinity();
        for (const Vote& v : votes) {
            double sum = 0.0;
            for (const Vote& other : votes) {
                sum += other.weight * (other.map->position[s] - v.map->position[s]).norm();
            }
            if (sum >= least) continue;
            least = sum;
            best = &v;
        }
        return *best;
    }

    // Where eq. 10 is least in the tangent plane, by Weiszfeld's iteration from the mean.
    [[nodiscard]] Complex median(const std::vector<Vote>& votes) const {
        constexpr int most = 60;
        const double tolerance = 1e-3 * e0_;
        Complex centre(0.0, 0.0);
        for (int i = 0; i <= most; ++i) {
            Complex sum(0.0, 0.0);
            double total = 0.0;
            for (std::size_t k = 0; k < votes.size(); ++k) {
                if (!seen_[k]) continue;
                const double weight = votes[k].weight / (i > 0 ? std::max(std::abs(way_[k] - centre), tolerance) : 1.0);
                sum += weight * way_[k];
                total += weight;
            }
            if (total <= 0.0) break;
            const Complex next = sum / total;
            const bool done = i > 0 && std::abs(next - centre) < 0.1 * tolerance;
            centre = next;
            if (done) break;
        }
        return centre;
    }

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
