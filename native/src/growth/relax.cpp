// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/relax.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "base/parallel.h"
#include "geodesic/shoot.h"
#include "growth/normal_equations.h"

namespace isograft {

namespace {

struct ActiveEdge {
    const SampleEdge* edge;
    int u, v;  // indices of unknowns
    Shot shot;
};

/// The state of the least squares: where each unknown is now, and the geodesic of every edge there.
class State {
  public:
    State(const Samples& source, const TriangleMesh& target, const PartialMap& map, int threads)
        : source_(source), target_(target), threads_(threads) {
        index_.assign(source.count(), -1);
        for (int s = 0; s < source.count(); ++s) {
            if (!map.mapped[s]) continue;
            index_[s] = static_cast<int>(sample.size());
            sample.push_back(s);
        }
        base_.resize(sample.size());
        turn_.assign(sample.size(), Complex(1.0, 0.0));
        x.assign(2 * sample.size(), 0.0);
        evaluated_ = x;
        for (std::size_t i = 0; i < sample.size(); ++i) base_[i] = map.image[sample[i]];
        now_ = base_;
        rotation_.resize(sample.size());
        for (std::size_t i = 0; i < sample.size(); ++i) rotation_[i] = map.rotation[sample[i]];
        find_edges(map);
    }

    /// Bring points and geodesics to the unknowns `x`.
    void evaluate() {
        if (x == evaluated_) return;
        evaluated_ = x;
        std::vector<Complex> before = turn_;
        for (std::size_t i = 0; i < sample.size(); ++i) move(i);
        for_each(edges.size(), [&](std::size_t i) {
            ActiveEdge& a = edges[i];
            // The last direction, carried along with the start point, is nearly right.
            const Complex guess = a.shot.departure * turn_[a.u] * std::conj(before[a.u]);
            if (const auto s = shoot(target_, now_[a.u], now_[a.v], guess, a.shot.length, accuracy)) {
                a.shot = *s;
            } else {
                // No geodesic there: keep the length, which makes the step look useless but does no harm.
                a.shot.departure = guess;
                a.shot.arrival = a.shot.arrival * turn_[a.v] * std::conj(before[a.v]);
            }
        });
    }

    /// Derivatives of an edge's length by its two unknowns, in the frames of their base points.
    [[nodiscard]] Complex by_u(const ActiveEdge& a) const { return -a.shot.departure * std::conj(turn_[a.u]); }
    [[nodiscard]] Complex by_v(const ActiveEdge& a) const { return a.shot.arrival * std::conj(turn_[a.v]); }

    /// Make the present points the base points; the unknowns are zero again.
    void settle() {
        for (std::size_t i = 0; i < sample.size(); ++i) {
            rotation_[i] *= turn_[i];
            turn_[i] = Complex(1.0, 0.0);
        }
        base_ = now_;
        std::fill(x.begin(), x.end(), 0.0);
        evaluated_ = x;
    }

    void cap_steps(double longest) {
        for (std::size_t i = 0; i < sample.size(); ++i) {
            const double length = modulus({x[2 * i], x[2 * i + 1]});
            if (length <= longest) continue;
            x[2 * i] *= longest / length;
            x[2 * i + 1] *= longest / length;
        }
    }

    [[nodiscard]] const SurfacePoint& point(std::size_t i) const { return now_[i]; }
    [[nodiscard]] Complex rotation(std::size_t i) const { return rotation_[i] * turn_[i]; }

    std::vector<int> sample;
    std::vector<double> x;
    std::vector<ActiveEdge> edges;
    /// Level-0 edges no geodesic was found for, as pairs of unknowns.
    std::vector<std::pair<int, int>> broken;

  private:
    static constexpr ShootOptions accuracy{.max_traces = 4, .tolerance = 0.03};

    // Edges to a task: threads that fetch every edge on its own would wait for each other.
    static constexpr std::size_t batch = 256;

    template <class Task>
    void for_each(std::size_t count, Task&& task) {
        const auto run = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) task(i);
        };
        if (threads_ == 1 || count < 4 * batch) return run(0, count);
        Monitor silent;
        parallel_for(
            static_cast<int>((count + batch - 1) / batch), threads_,
            [&](int i, int /*worker*/) {
                const std::size_t begin = static_cast<std::size_t>(i) * batch;
                run(begin, std::min(count, begin + batch));
            },
            silent);
    }

    void find_edges(const PartialMap& map) {
        std::vector<const SampleEdge*> active;
        for (const SampleEdge& e : source_.edges) {
            if (is_active(e, map)) active.push_back(&e);
        }
        std::vector<std::optional<Shot>> shots(active.size());
        for_each(active.size(), [&](std::size_t i) {
            const SampleEdge& e = *active[i];
            const int u = index_[e.u];
            shots[i] = shoot(target_, base_[u], base_[index_[e.v]], e.at_u * rotation_[u], e.length, accuracy);
        });
        for (std::size_t i = 0; i < active.size(); ++i) {
            const int u = index_[active[i]->u];
            const int v = index_[active[i]->v];
            if (shots[i]) {
                edges.push_back({active[i], u, v, *shots[i]});
            } else if (active[i]->level == 0) {
                broken.emplace_back(u, v);
            }
        }
    }

    void move(std::size_t i) {
        const Complex step(x[2 * i], x[2 * i + 1]);
        const double length = modulus(step);
        if (length < 1e-12 * source_.spacing) {
            now_[i] = base_[i];
            turn_[i] = Complex(1.0, 0.0);
            return;
        }
        const Trace t = trace(target_, base_[i], step, length);
        now_[i] = t.end;
        turn_[i] = t.direction * std::conj(step / length);
    }

    const Samples& source_;
    const TriangleMesh& target_;
    int threads_;
    std::vector<int> index_;
    std::vector<SurfacePoint> base_, now_;
    std::vector<Complex> turn_, rotation_;
    std::vector<double> evaluated_;
};

// Up to a constant; see SampleTerm.
double term_cost(const SampleTerm& t, double x, double y) {
    return t.gx * x + t.gy * y + 0.5 * (t.hxx * x * x + 2.0 * t.hxy * x * y + t.hyy * y * y);
}

double relative_stretch(const ActiveEdge& a) { return (a.shot.length - a.edge->length) / a.edge->length; }

// Huber's loss of a squared residual, weighted with the length: weight 1 / d on the stretch is d on the relative one.
double edge_cost(const ActiveEdge& a, double huber) {
    const double r = std::abs(relative_stretch(a));
    return 0.5 * a.edge->length * (r <= huber ? r * r : huber * (2.0 * r - huber));
}

double total_cost(const State& state, double huber, const std::vector<SampleTerm>& terms, double term_weight) {
    double cost = 0.0;
    for (const ActiveEdge& a : state.edges) cost += edge_cost(a, huber);
    for (std::size_t i = 0; i < terms.size(); ++i)
        cost += term_weight * term_cost(terms[i], state.x[2 * i], state.x[2 * i + 1]);
    return cost;
}

void linearise(const State& state, double huber, const std::vector<SampleTerm>& terms, double term_weight,
               NormalEquations& system) {
    system.clear();
    for (std::size_t i = 0; i < state.edges.size(); ++i) {
        const ActiveEdge& a = state.edges[i];
        const double r = relative_stretch(a);
        const double share = std::abs(r) <= huber ? 1.0 : huber / std::abs(r);
        const double scale = 1.0 / a.edge->length;
        system.add_pair(static_cast<int>(i), a.edge->length * share, r, state.by_u(a) * scale, state.by_v(a) * scale);
    }
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const SampleTerm& t = terms[i];
        Eigen::Matrix2d h;
        h << t.hxx, t.hxy, t.hxy, t.hyy;
        const Eigen::Vector2d x(state.x[2 * i], state.x[2 * i + 1]);
        const Eigen::Vector2d g = h * x + Eigen::Vector2d(t.gx, t.gy);
        system.add_point(static_cast<int>(i), term_weight * g, term_weight * h);
    }
}

// Levenberg and Marquardt's method as Ceres has it: the same damping, the same tests of a step.
void solve(State& state, const GrowthOptions& options, const std::vector<SampleTerm>& terms, double term_weight,
           int iterations) {
    constexpr double function_tolerance = 1e-4, least_decrease = 1e-3, linear_tolerance = 1e-4;
    double radius = 1e3, shrink = 2.0;
    std::vector<std::array<int, 2>> pairs;
    for (const ActiveEdge& a : state.edges) pairs.push_back({a.u, a.v});
    NormalEquations system(static_cast<int>(state.sample.size()), pairs);
    double cost = total_cost(state, options.huber, terms, term_weight);
    linearise(state, options.huber, terms, term_weight, system);
    for (int i = 0; i < iterations; ++i) {
        const std::vector<double> before = state.x;
        const Eigen::VectorXd step = system.solve(radius, linear_tolerance);
        const double predicted = system.predicted_fall(step);
        double fall = 0.0;
        if (predicted > 0.0) {
            for (std::size_t k = 0; k < before.size(); ++k) state.x[k] += step[static_cast<Eigen::Index>(k)];
            state.evaluate();
            fall = cost - total_cost(state, options.huber, terms, term_weight);
        }
        const bool settled = predicted > 0.0 && std::abs(fall) <= function_tolerance * cost;
        if (!settled && predicted > 0.0 && fall > least_decrease * predicted) {
            radius /= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * fall / predicted - 1.0, 3));
            shrink = 2.0;
            cost -= fall;
            if (i + 1 < iterations) linearise(state, options.huber, terms, term_weight, system);
            continue;
        }
        state.x = before;
        if (settled) break;
        radius /= shrink;
        shrink *= 2.0;
    }
    state.evaluate();
}

// Mean relative stretch per unknown over level-0 edges; a broken edge counts as stretched by 100 %.
std::vector<double> mean_stretch(const State& state) {
    std::vector<double> sum(state.sample.size(), 0.0);
    std::vector<int> count(state.sample.size(), 0);
    const auto add = [&](int u, int v, double stretch) {
        for (const int i : {u, v}) {
            sum[i] += stretch;
            ++count[i];
        }
    };
    for (const ActiveEdge& a : state.edges) {
        if (a.edge->level == 0) add(a.u, a.v, std::abs(a.shot.length / a.edge->length - 1.0));
    }
    for (const auto& [u, v] : state.broken) add(u, v, 1.0);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1, count[i]);
    return sum;
}

double root_mean_square(const State& state, double huber) {
    double sum = 0.0;
    double weight = 0.0;
    for (const ActiveEdge& a : state.edges) {
        const double relative = std::abs(a.shot.length / a.edge->length - 1.0);
        const double w = a.edge->length * (relative > huber ? huber / relative : 1.0);
        sum += w * relative * relative;
        weight += a.edge->length;
    }
    return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

std::vector<Complex> mean_rotations(const State& state) {
    std::vector<Complex> turn(state.sample.size(), Complex(0.0, 0.0));
    for (const ActiveEdge& a : state.edges) {
        // Angles over long edges tell less: curvature on the way enters them.
        const double w = (a.edge->level <= 1 ? 1.0 : 0.3) * a.edge->length;
        turn[a.u] += w * a.shot.departure * std::conj(a.edge->at_u);
        turn[a.v] += w * -a.shot.arrival * std::conj(a.edge->at_v);
    }
    for (std::size_t i = 0; i < turn.size(); ++i) {
        turn[i] = modulus(turn[i]) > 1e-12 ? unit(turn[i]) : state.rotation(i);
    }
    return turn;
}

}  // namespace

std::vector<double> relax(const Samples& source, const TriangleMesh& target, const GrowthOptions& options,
                          const RelaxSettings& settings, PartialMap& map) {
    State state(source, target, map, settings.threads);
    const auto write_back = [&] {
        const auto turns = mean_rotations(state);
        for (std::size_t i = 0; i < state.sample.size(); ++i) {
            map.put(target, state.sample[i], state.point(i), turns[i]);
        }
    };
    const bool with_term = settings.term && settings.term_weight > 0.0;
    for (int round = 0; round < (with_term ? settings.iterations : std::min(settings.iterations, 1)); ++round) {
        std::vector<SampleTerm> terms;
        if (with_term) {
            write_back();
            std::vector<SampleTerm> all(source.count());
            settings.term(map, all);
            for (const int s : state.sample) terms.push_back(all[s]);
        }
        solve(state, options, terms, settings.term_weight, with_term ? 1 : settings.iterations);
        state.cap_steps(options.max_step * source.spacing);
        state.evaluate();
        state.settle();
    }
    write_back();
    map.stress = root_mean_square(state, options.huber);
    const auto stretch = mean_stretch(state);
    std::vector<double> result(source.count(), 0.0);
    for (std::size_t i = 0; i < state.sample.size(); ++i) {
        result[state.sample[i]] = stretch[i];
        if (settings.trim > 0.0 && stretch[i] > settings.trim) map.drop(state.sample[i]);
    }
    return result;
}

StretchDerivative stretch_derivative(const TriangleMesh& target, const SurfacePoint& u, const SurfacePoint& v,
                                     Complex direction, double length) {
    const auto shot = shoot(target, u, v, direction, length, {.max_traces = 12, .tolerance = 1e-9});
    if (!shot) return {};
    return {shot->length - length, -shot->departure, shot->arrival};
}

}  // namespace isograft
