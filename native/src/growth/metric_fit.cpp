// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/metric_fit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "geodesic/shoot.h"

namespace isograft {

namespace {

constexpr ShootOptions accuracy{.max_traces = 4, .tolerance = 0.01};
// One that gains less than this share is the last; those that gain nothing are tried again with more damping.
constexpr double enough = 1e-3;
constexpr std::size_t check_every = 4096;

struct Link {
    const SampleEdge* edge;
    int u, v;  // numbers of unknowns
    Shot shot;
};

struct Points2 {
    std::vector<SurfacePoint> point;
    std::vector<Complex> rotation;
};

double energy(const std::vector<Link>& links) {
    double sum = 0.0;
    for (const Link& l : links) sum += (l.shot.length - l.edge->length) * (l.shot.length - l.edge->length);
    return sum;
}

// Which unknowns meet does not change from one iteration to the next, so the elimination's order is found once.
class DirectEquations {
  public:
    explicit DirectEquations(int points) : unknowns_(2 * points), matrix_(unknowns_, unknowns_) {}

    Eigen::VectorXd step(const std::vector<Link>& links, double damping) {
        entries_.clear();
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns_);
        for (const Link& l : links) {
            // First variation of arc length: minus the departure at one end, the arrival at the other.
            const double r = l.shot.length - l.edge->length;
            const int index[4] = {2 * l.u, 2 * l.u + 1, 2 * l.v, 2 * l.v + 1};
            const double j[4] = {-l.shot.departure.real(), -l.shot.departure.imag(), l.shot.arrival.real(),
                                 l.shot.arrival.imag()};
            for (int a = 0; a < 4; ++a) {
                gradient[index[a]] += j[a] * r;
                for (int b = 0; b < 4; ++b) {
                    if (index[a] >= index[b]) entries_.emplace_back(index[a], index[b], j[a] * j[b]);
                }
            }
        }
        for (int i = 0; i < unknowns_; ++i) entries_.emplace_back(i, i, damping);
        matrix_.setFromTriplets(entries_.begin(), entries_.end());
        if (!ordered_) factor_.analyzePattern(matrix_);
        ordered_ = true;
        factor_.factorize(matrix_);
        if (factor_.info() != Eigen::Success) return Eigen::VectorXd::Zero(unknowns_);
        return factor_.solve(-gradient);
    }

  private:
    int unknowns_;
    bool ordered_ = false;
    std::vector<Eigen::Triplet<double>> entries_;
    Eigen::SparseMatrix<double> matrix_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

// Move every point by its step; directions turn with it.
Points2 moved(const TriangleMesh& target, const Points2& from, const Eigen::VectorXd& step, double longest,
              std::vector<Complex>& turn) {
    Points2 to = from;
    for (std::size_t i = 0; i < from.point.size(); ++i) {
        Complex d(step[2 * static_cast<Eigen::Index>(i)], step[2 * static_cast<Eigen::Index>(i) + 1]);
        turn[i] = Complex(1.0, 0.0);
        double length = std::abs(d);
        if (!(length > 1e-12 * longest)) continue;  // also where the solve gave no number
        d /= length;
        length = std::min(length, longest);
        const Trace t = trace(target, from.point[i], d, length);
        to.point[i] = t.end;
        turn[i] = t.direction * std::conj(d);
        to.rotation[i] = from.rotation[i] * turn[i];
    }
    return to;
}

std::vector<Link> reshot(const TriangleMesh& target, const std::vector<Link>& links, const Points2& points,
                         const std::vector<Complex>& turn, Monitor& monitor) {
    std::vector<Link> result = links;
    for (std::size_t i = 0; i < result.size(); ++i) {
        if (i % check_every == 0) monitor.check();
        Link& l = result[i];
        const Complex guess = l.shot.departure * turn[l.u];
        if (const auto shot = shoot(target, points.point[l.u], points.point[l.v], guess, l.shot.length, accuracy)) {
            l.shot = *shot;
        } else {
            // No geodesic there: the length stays, which makes the step look useless but does no harm.
            l.shot.departure = guess;
            l.shot.arrival *= turn[l.v];
        }
    }
    return result;
}

}  // namespace

void fit_metric(const Samples& source, const TriangleMesh& target, const MetricFitOptions& options, PartialMap& map,
                Monitor& monitor) {
    std::vector<int> number(source.count(), -1), sample;
    Points2 points;
    for (int s = 0; s < source.count(); ++s) {
        if (!map.mapped[s]) continue;
        number[s] = static_cast<int>(sample.size());
        sample.push_back(s);
        points.point.push_back(map.image[s]);
        points.rotation.push_back(map.rotation[s]);
    }
    std::vector<Link> links;
    std::size_t looked_at = 0;
    for (const SampleEdge& e : source.edges) {
        if (looked_at++ % check_every == 0) monitor.check();
        if (!is_active(e, map)) continue;
        const int u = number[e.u], v = number[e.v];
        const auto shot =
            shoot(target, points.point[u], points.point[v], e.at_u * points.rotation[u], e.length, accuracy);
        if (shot) links.push_back({&e, u, v, *shot});
    }
    const int unknowns = static_cast<int>(sample.size());
    std::vector<Complex> turn(unknowns);
    DirectEquations equations(unknowns);
    double now = energy(links);
    double damping = 1e-2;
    for (int iteration = 0; iteration < options.iterations && !links.empty(); ++iteration) {
        const Eigen::VectorXd step = equations.step(links, damping);
        Points2 tried = moved(target, points, step, options.max_step * source.spacing, turn);
        std::vector<Link> seen = reshot(target, links, tried, turn, monitor);
        const double then = energy(seen);
        if (!(then < now)) {
            damping *= 30.0;
            continue;
        }
        const bool last = now - then < enough * now;
        points = std::move(tried);
        links = std::move(seen);
        now = then;
        damping = std::max(1e-4, 0.3 * damping);
        if (last) break;
    }
    std::vector<Complex> mean(unknowns, Complex(0.0, 0.0));
    for (const Link& l : links) {
        if (l.edge->level > 1) continue;
        mean[l.u] += l.edge->length * l.shot.departure * std::conj(l.edge->at_u);
        mean[l.v] += l.edge->length * -l.shot.arrival * std::conj(l.edge->at_v);
    }
    for (int i = 0; i < unknowns; ++i) {
        const bool known = std::abs(mean[i]) > 1e-12 * source.spacing;
        map.put(target, sample[i], points.point[i], known ? unit(mean[i]) : points.rotation[i]);
    }
    map.stress = links.empty() ? 0.0 : std::sqrt(now / static_cast<double>(links.size())) / source.spacing;
}

}  // namespace isograft
