// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/grow.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geodesic/trace.h"
#include "isograft/errors.h"

namespace isograft {

void GrowthOptions::validate() const {
    const auto require = [](bool holds, const std::string& what) {
        if (!holds) throw InvalidInput("growth." + what);
    };
    require(stretch_limit > 0.0 && stretch_limit <= 10.0, "stretch_limit must be in (0, 10]");
    require(rotation_weight >= 0.0 && std::isfinite(rotation_weight), "rotation_weight must not be negative");
    require(min_neighbours >= 1 && min_neighbours <= 8, "min_neighbours must be in [1, 8]");
    require(collision_radius >= 0.0 && collision_radius <= 1.0, "collision_radius must be in [0, 1]");
    require(huber > 0.0 && std::isfinite(huber), "huber must be positive");
    require(max_step > 0.0 && max_step <= 10.0, "max_step must be in (0, 10]");
    require(iterations >= 1 && iterations <= 100, "iterations must be in [1, 100]");
}

namespace {
// A map of so few samples has no choice of neighbours yet.
constexpr int infancy = 6;
// A sample that least squares threw out this often is left out.
constexpr int max_trims = 2;
}  // namespace

Grower::Grower(const Samples& source, const SampledMesh& target, const GrowthOptions& options)
    : source_(source),
      target_(target.mesh),
      target_samples_(target.samples),
      options_(options),
      carried_(2 * source.edges.size()),
      predicted_(source.count()),
      stamp_(source.count(), 0),
      trimmed_(source.count(), 0),
      cell_(target.samples.count() + 1) {}

void Grower::begin(const PartialMap& map) {
    ++version_;
    std::fill(trimmed_.begin(), trimmed_.end(), 0);
    queue_.clear();
    occupy(map);
}

void Grower::occupy(const PartialMap& map) {
    for (auto& cell : cell_) cell.clear();
    for (int s = 0; s < source_.count(); ++s) {
        if (map.mapped[s]) cell_[target_samples_.nearest(target_, map.image[s]) + 1].push_back(s);
    }
}

// A mapped neighbour's view of where the other end of an edge goes; kept until least squares moves the neighbour.
const Grower::Carried& Grower::carried(const PartialMap& map, int edge, int from) {
    const SampleEdge& e = source_.edges[edge];
    Carried& c = carried_[2 * edge + (from == e.u ? 0 : 1)];
    if (c.version == version_) return c;
    c.version = version_;
    const Trace t = trace(target_, map.image[from], (from == e.u ? e.at_u : e.at_v) * map.rotation[from], e.length);
    c.ok = t.complete;
    c.end = t.end;
    c.position = position(target_, t.end);
    c.direction = t.direction;
    return c;
}

bool Grower::predict(const PartialMap& map, int sample, Prediction& prediction) {
    from_.clear();
    from_edge_.clear();
    from_source_.clear();
    for (const int index : source_.base_edges_of[sample]) {
        const SampleEdge& e = source_.edges[index];
        const int neighbour = e.other(sample);
        if (!map.mapped[neighbour]) continue;
        const Carried& c = carried(map, index, neighbour);
        if (!c.ok) continue;
        from_.push_back(&c);
        from_edge_.push_back(&e);
        from_source_.push_back(sample == e.u ? e.at_u : e.at_v);
    }
    const int n = static_cast<int>(from_.size());
    prediction.neighbours = n;
    if (n == 0) return false;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (int i = 0; i < n; ++i) {
        const double w = 1.0 / from_edge_[i]->length;
        mean += w * from_[i]->position;
        total += w;
    }
    mean /= total;
    // Two rounds of reweighting keep one neighbour that went astray from pulling the mean.
    for (int round = 0; round < 2 && n > 2; ++round) {
        Eigen::Vector3d next = Eigen::Vector3d::Zero();
        double sum = 0.0;
        for (int i = 0; i < n; ++i) {
            const double length = from_edge_[i]->length;
            const double r = (from_[i]->position - mean).norm() / (0.15 * length);
            const double w = 1.0 / (length * (1.0 + r * r));
            next += w * from_[i]->position;
            sum += w;
        }
        mean = next / sum;
    }
    int nearest = 0;
    for (int i = 1; i < n; ++i) {
        if ((from_[i]->position - mean).squaredNorm() < (from_[nearest]->position - mean).squaredNorm()) nearest = i;
    }
    const Carried& start = *from_[nearest];
    const Complex step = flatten(target_, start.end.face, mean - start.position);
    prediction.point = modulus(step) > 1e-12 ? trace(target_, start.end, step, modulus(step)).end : start.end;
    const Eigen::Vector3d point = position(target_, prediction.point);
    Complex turn(0.0, 0.0);
    double worst = 0.0;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
        const Carried& c = *from_[i];
        const Complex arrived = carry(target_, c.end.face, prediction.point.face, c.direction);
        const double length = from_edge_[i]->length;
        turn += -unit(arrived) * std::conj(from_source_[i]) / length;
        const Complex miss = flatten(target_, prediction.point.face, point - c.position);
        const double reached = modulus({length + dot(arrived, miss), cross(arrived, miss)});
        const double stretch = std::abs(reached - length);
        worst = std::max(worst, stretch);
        sum += stretch;
    }
    prediction.rotation = unit(turn);
    prediction.concord = modulus(turn) / total;
    prediction.stretch = 0.5 * worst + 0.5 * sum / n;
    return true;
}

void Grower::evaluate(const PartialMap& map, const GrowthRun& run, double limit, int sample) {
    Prediction& p = predicted_[sample];
    if (!predict(map, sample, p)) return;
    ++stamp_[sample];  // whatever was queued for this sample is out of date
    const bool grown = map.count > infancy;
    if (grown && p.neighbours < options_.min_neighbours) return;
    double key =
        p.stretch / source_.spacing + options_.rotation_weight * std::sqrt(std::max(0.0, 2.0 * (1.0 - p.concord)));
    if (p.neighbours < 3) key += 0.3 / p.neighbours;
    if (run.mismatch && run.mismatch_weight > 0.0) {
        key += run.mismatch_weight * std::min(run.mismatch(sample, p.point, p.rotation), 1.5);
    }
    if (grown && key > limit) return;
    if (grown && run.refuse && run.refuse(sample, p.point, p.rotation)) return;
    queue_.push_back({key, sample, stamp_[sample]});
    std::push_heap(queue_.begin(), queue_.end(), Later());
}

void Grower::evaluate_around(const PartialMap& map, const GrowthRun& run, double limit, int sample) {
    for (const int e : source_.base_edges_of[sample]) {
        const int neighbour = source_.edges[e].other(sample);
        if (!map.mapped[neighbour] && trimmed_[neighbour] <= max_trims) evaluate(map, run, limit, neighbour);
    }
}

void Grower::evaluate_all(const PartialMap& map, const GrowthRun& run, double limit) {
    queue_.clear();
    for (int s = 0; s < source_.count(); ++s) {
        if (map.mapped[s] || trimmed_[s] > max_trims) continue;
        const auto& edges = source_.base_edges_of[s];
        const bool touches =
            std::any_of(edges.begin(), edges.end(), [&](int e) { return map.mapped[source_.edges[e].other(s)] != 0; });
        if (touches) evaluate(map, run, limit, s);
    }
}

bool Grower::collides(const PartialMap& map, int sample, const SurfacePoint& point, int cell) const {
    if (options_.collision_radius <= 0.0 || cell < 0) return false;
    const Eigen::Vector3d x = position(target_, point);
    const double radius = options_.collision_radius * source_.spacing;
    const auto hit = [&](int index) {
        for (const int other : cell_[index + 1]) {
            if ((map.position[other] - x).squaredNorm() >= radius * radius) continue;
            const auto& edges = source_.base_edges_of[sample];
            const bool neighbours = std::any_of(edges.begin(), edges.end(), [&](int e) {
                return source_.edges[e].other(sample) == other && source_.edges[e].length < 1.6 * source_.spacing;
            });
            if (!neighbours) return true;
        }
        return false;
    };
    if (hit(cell)) return true;
    const auto& around = target_samples_.base_edges_of[cell];
    return std::any_of(around.begin(), around.end(), [&](int e) { return hit(target_samples_.edges[e].other(cell)); });
}

void Grower::optimise(PartialMap& map, int iterations, double trim, int threads) {
    RelaxSettings settings;
    settings.iterations = iterations;
    settings.trim = trim;
    settings.threads = threads;
    const std::vector<char> before = map.mapped;
    relax(source_, target_, options_, settings, map);
    for (int s = 0; s < source_.count(); ++s) {
        if (before[s] && !map.mapped[s]) ++trimmed_[s];
    }
    ++version_;
    occupy(map);
}

void Grower::grow(PartialMap& map, const GrowthRun& run) {
    begin(map);
    const double trim = 0.5 * options_.stretch_limit * run.slack;
    int next_relax = run.first_relax;
    for (std::size_t phase = 0; phase < run.schedule.size(); ++phase) {
        const double limit = options_.stretch_limit * run.slack * run.schedule[phase];
        std::fill(trimmed_.begin(), trimmed_.end(), 0);
        evaluate_all(map, run, limit);
        while (!queue_.empty() && map.count < run.max_samples) {
            const Queued top = queue_.front();
            std::pop_heap(queue_.begin(), queue_.end(), Later());
            queue_.pop_back();
            const int s = top.sample;
            if (map.mapped[s] || top.stamp != stamp_[s]) continue;
            const int cell = target_samples_.nearest(target_, predicted_[s].point);
            if (collides(map, s, predicted_[s].point, cell)) continue;
            map.put(target_, s, predicted_[s].point, predicted_[s].rotation);
            cell_[cell + 1].push_back(s);
            if (map.count >= next_relax) {
                optimise(map, options_.iterations, trim, run.threads);
                next_relax = std::max(next_relax + 4, 2 * std::max(next_relax, map.count));
                evaluate_all(map, run, limit);
            } else {
                evaluate_around(map, run, limit, s);
            }
        }
        const bool last = phase + 1 == run.schedule.size() || map.count >= run.max_samples;
        optimise(map, last ? run.final_iterations : options_.iterations, trim, run.threads);
        if (last) break;
    }
}

}  // namespace isograft
