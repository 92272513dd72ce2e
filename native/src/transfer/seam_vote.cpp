// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/seam_vote.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include <Eigen/Geometry>

#include "transfer/seams.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

// Corners beyond an island are extrapolated by each polygon for itself: they differ by less than this share of what
// the values vary over the polygon, and a seam by more.
constexpr double same_branch = 0.1;
// A change has to gain more than rounding: else two equal costs could take turns.
constexpr double least_gain = 1e-9;

// One way of reading a polygon.
struct Choice {
    std::vector<Place> places;
    int root = -1;
    // Distances of the polygon's samples from the patch.
    std::vector<double> off;
    // Share of the samples that lie in no other patch rather.
    double share = 0.0;
};

struct Candidate {
    int polygon;
    PolygonCorners corners;
    std::vector<Choice> choices;
    int chosen = 0;
};

// The centres of the parts of every triangle's image, divided into four and those again.
std::vector<Vector3d> samples(const ReceiverImages& receiver, int p) {
    std::vector<Vector3d> points;
    const std::function<void(const Vector3d&, const Vector3d&, const Vector3d&, int)> divide =
        [&](const Vector3d& a, const Vector3d& b, const Vector3d& c, int times) {
            if (times == 0) {
                points.emplace_back((a + b + c) / 3.0);
                return;
            }
            const Vector3d ab = 0.5 * (a + b), bc = 0.5 * (b + c), ca = 0.5 * (c + a);
            divide(a, ab, ca, times - 1);
            divide(ab, b, bc, times - 1);
            divide(ca, bc, c, times - 1);
            divide(bc, ca, ab, times - 1);
        };
    const Polygons& polygons = receiver.polygons;
    const int from = polygons.first[p], to = polygons.first[p + 1];
    // A polygon of several triangles has enough parts as it is.
    const int times = to - from < 4 ? 2 : 1;
    for (int i = from; i < to; ++i) {
        const int f = polygons.triangle[i];
        divide(receiver.corner(f, 0).point, receiver.corner(f, 1).point, receiver.corner(f, 2).point, times);
    }
    return points;
}

void set_shares(std::vector<Choice>& choices, double same_point) {
    for (std::size_t i = 0; i < choices[0].off.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Choice& choice : choices) nearest = std::min(nearest, choice.off[i]);
        for (Choice& choice : choices) {
            if (choice.off[i] <= nearest + same_point) choice.share += 1.0 / static_cast<double>(choice.off.size());
        }
    }
}

class Vote {
  public:
    Vote(const ReceiverImages& receiver, const DonorView& donor, std::vector<Place>& places, std::vector<int>& root)
        : receiver_(receiver),
          donor_(donor),
          places_(places),
          root_(root),
          welded_(weld(receiver.receiver.vertices, receiver.receiver.faces)),
          next_(build_seam_graph(welded_, no_corner_values(welded_), 0.0).next),
          polygon_of_(welded_.rows(), -1) {
        for (int p = 0; p < receiver.polygons.count(); ++p) {
            for (int i = receiver.polygons.first[p]; i < receiver.polygons.first[p + 1]; ++i) {
                polygon_of_[receiver.polygons.triangle[i]] = p;
            }
        }
    }

    // Every patch that a corner lies in and the patch under the centre does not reach.
    Candidate candidate(int p, PatchReader& reader) const {
        Candidate found{p, polygon_corners(receiver_, p), {}};
        const auto& images = found.corners.images;
        const std::vector<Vector3d> points = samples(receiver_, p);
        std::vector<char> covered(images.size(), 0);
        const auto read = [&](int root) {
            Choice choice;
            if (!reader.read(images, found.corners.centre, choice.places, root)) return;
            choice.root = reader.root();
            for (const Vector3d& point : points) choice.off.push_back(reader.distance(point));
            for (std::size_t i = 0; i < images.size(); ++i) covered[i] |= reader.reaches(images[i].face) ? 1 : 0;
            found.choices.push_back(std::move(choice));
        };
        read(-1);
        for (std::size_t i = 0; i < images.size() && !found.choices.empty(); ++i) {
            if (covered[i]) continue;
            read(images[i].face);
            covered[i] = 1;
        }
        if (!found.choices.empty()) set_shares(found.choices, donor_.same_point);
        return found;
    }

    // Returns true if another choice costs less.
    bool ask(Candidate& candidate) {
        int chosen = candidate.chosen;
        std::vector<double> costs;
        for (const Choice& choice : candidate.choices) costs.push_back(cost(candidate, choice));
        double best = costs[candidate.chosen];
        for (int k = 0; k < static_cast<int>(costs.size()); ++k) {
            if (costs[k] >= best - least_gain * perimeter(candidate.polygon)) continue;
            best = costs[k];
            chosen = k;
        }
        if (chosen == candidate.chosen) return false;
        candidate.chosen = chosen;
        write(candidate);
        return true;
    }

  private:
    template <class Function>
    void for_each_border(int p, const Function& function) const {
        const Polygons& polygons = receiver_.polygons;
        for (int i = polygons.first[p]; i < polygons.first[p + 1]; ++i) {
            const int f = polygons.triangle[i];
            for (int h = 3 * f; h < 3 * f + 3; ++h) {
                if (next_[h] == h || polygon_of_[next_[h] / 3] != p) function(h);
            }
        }
    }

    [[nodiscard]] double length(int h) const {
        const auto& mesh = receiver_.receiver;
        const int a = mesh.faces(h / 3, h % 3), b = mesh.faces(h / 3, (h + 1) % 3);
        return (mesh.vertices.row(a) - mesh.vertices.row(b)).norm();
    }

    [[nodiscard]] double perimeter(int p) const {
        double sum = 0.0;
        for_each_border(p, [&](int h) { sum += length(h); });
        return sum;
    }

    [[nodiscard]] const Place& at(const Candidate& candidate, const Choice& choice, int corner) const {
        const int v = receiver_.receiver.faces(corner / 3, corner % 3);
        return choice.places[candidate.corners.index_of(v)];
    }

    [[nodiscard]] double cost(const Candidate& candidate, const Choice& choice) const {
        Eigen::RowVectorXd low, high;
        for (const Place& place : choice.places) {
            const Eigen::RowVectorXd value = donor_.value(place.face, place.weights);
            low = low.size() == 0 ? value : Eigen::RowVectorXd(low.cwiseMin(value));
            high = high.size() == 0 ? value : Eigen::RowVectorXd(high.cwiseMax(value));
        }
        const double tolerance = donor_.tolerance + same_branch * (high - low).maxCoeff();
        double parted = 0.0, around = 0.0;
        for_each_border(candidate.polygon, [&](int h) {
            around += length(h);
            const int g = next_[h];
            // Where three meet, or none, nobody is asked.
            if (g == h || next_[g] != h || places_[g].face < 0) return;
            const int ahead = h - h % 3 + (h + 1) % 3, beyond = g - g % 3 + (g + 1) % 3;
            const bool against = welded_(h / 3, h % 3) == welded_(g / 3, (g + 1) % 3);
            const std::array<std::array<int, 2>, 2> ends{{{h, against ? beyond : g}, {ahead, against ? g : beyond}}};
            for (const auto& [mine, theirs] : ends) {
                const Place& here = at(candidate, choice, mine);
                const Place& there = places_[theirs];
                const Eigen::RowVectorXd jump =
                    donor_.value(here.face, here.weights) - donor_.value(there.face, there.weights);
                if (jump.cwiseAbs().maxCoeff() <= tolerance) continue;
                parted += length(h);
                return;
            }
        });
        return parted + around * (1.0 - choice.share);
    }

    void write(const Candidate& candidate) {
        const Choice& choice = candidate.choices[candidate.chosen];
        root_[candidate.polygon] = choice.root;
        write_places(receiver_, candidate.polygon, candidate.corners, choice.places, places_);
    }

    const ReceiverImages& receiver_;
    const DonorView& donor_;
    std::vector<Place>& places_;
    std::vector<int>& root_;
    Triangles welded_;
    std::vector<int> next_;
    std::vector<int> polygon_of_;
};

}  // namespace

PolygonCorners polygon_corners(const ReceiverImages& receiver, int p) {
    const Polygons& polygons = receiver.polygons;
    const auto& faces = receiver.receiver.faces;
    const int from = polygons.first[p], to = polygons.first[p + 1];
    PolygonCorners result;
    double area = 0.0;
    Vector3d moment = Vector3d::Zero(), sum = Vector3d::Zero();
    for (int i = from; i < to; ++i) {
        Vector3d at[3];
        for (int c = 0; c < 3; ++c) {
            result.vertices.push_back(faces(polygons.triangle[i], c));
            at[c] = receiver.images[result.vertices.back()].point;
        }
        const double share = (at[1] - at[0]).cross(at[2] - at[0]).norm();
        moment += share * (at[0] + at[1] + at[2]) / 3.0;
        sum += (at[0] + at[1] + at[2]) / 3.0;
        area += share;
    }
    const bool one = to - from == 1;
    result.centre = one || area <= 0.0 ? Vector3d(sum / (to - from)) : Vector3d(moment / area);
    auto& corners = result.vertices;
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    for (const int v : corners) result.images.push_back(receiver.images[v]);
    return result;
}

void write_places(const ReceiverImages& receiver, int p, const PolygonCorners& corners, const std::vector<Place>& found,
                  std::vector<Place>& places) {
    const Polygons& polygons = receiver.polygons;
    for (int i = polygons.first[p]; i < polygons.first[p + 1]; ++i) {
        const int f = polygons.triangle[i];
        for (int c = 0; c < 3; ++c) places[3 * f + c] = found[corners.index_of(receiver.receiver.faces(f, c))];
    }
}

void vote_on_seams(const ReceiverImages& receiver, const DonorView& donor, const std::vector<int>& asked,
                   PatchReader& reader, std::vector<Place>& places, std::vector<int>& root, Monitor& monitor,
                   int sweeps) {
    if (asked.empty() || donor.values.cols() == 0) return;
    Vote vote(receiver, donor, places, root);
    std::vector<Candidate> candidates;
    for (const int p : asked) {
        monitor.check();
        candidates.push_back(vote.candidate(p, reader));
        if (candidates.back().choices.size() < 2) candidates.pop_back();
    }
    bool changed = true;
    for (int sweep = 0; sweep < sweeps && changed; ++sweep) {
        changed = false;
        for (Candidate& candidate : candidates) {
            monitor.check();
            changed = vote.ask(candidate) || changed;
        }
    }
}

}  // namespace isograft
