// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/patch.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <Eigen/Geometry>

#include "transfer/closest.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Triangles within this many radii of the polygon's image are looked at: surfaces bulge out of the ball of the images.
constexpr double reach = 1.5;
// A triangle is seen past a seam's end if the way around costs no more than this against the way across.
constexpr double detour = 1.5;
// Paths cross edges in this middle part, so that they cannot slip around a vertex at no cost.
constexpr double edge_margin = 0.2;
// A corner this close to 0 in barycentric coordinates may belong to the neighbour as well.
constexpr double on_edge = 1e-9;
// Triangles thinner than this (height over longest edge) are extended in the plane of the one behind them: the
// splinters that polygons leave where three of their corners are in line may have values in line, which say nothing
// about beyond.
constexpr double thick = 0.1;
// Splinters behind one another that are looked behind.
constexpr int most_splinters = 4;
// Triangles thinner than this are not extended at all: their plane is noise.
constexpr double thinnest = 1e-3;

}  // namespace

PatchReader::PatchReader(const DonorView& donor, double extrapolation)
    : donor_(donor), extrapolation_(extrapolation), stamp_(donor.faces.rows(), 0), slot_(donor.faces.rows(), 0) {}

bool PatchReader::read(const std::vector<Image>& images, const Vector3d& centre, std::vector<Place>& places, int root) {
    root_ = images[0].face;
    parted_ = false;
    places.resize(images.size());
    for (std::size_t i = 0; i < images.size(); ++i) places[i] = {images[i].face, images[i].weights};
    const auto alone = [&](const Image& image) { return image.face == images[0].face; };
    if (std::all_of(images.begin(), images.end(), alone)) return true;

    double radius = 0.0;
    for (const Image& image : images) radius = std::max(radius, (image.point - centre).norm());
    gather(images, centre, reach * radius + donor_.same_point);
    if (!seams_near_ && parts_ == 1) return true;

    const int start = root < 0 ? choose_root(images, radius) : slot_[root];
    root_ = nodes_[start].face;
    measure_paths(start, centre, true);
    measure_paths(start, centre, false);
    for (std::size_t i = 0; i < images.size(); ++i) {
        const Node& own = nodes_[slot_[images[i].face]];
        parted_ = parted_ || !visible(own);
        if (visible(own) && images[i].weights.minCoeff() > on_edge) continue;
        const Reading reading = nearest(images[i].point);
        const double gap = donor_.longest_edge[nodes_[reading.node].face];
        if (own.any_path == infinity && reading.distance > gap) return false;
        places[i] = place(images[i], reading);
    }
    return true;
}

bool PatchReader::visible(const Node& node) const {
    return node.seam_free_path <= detour * node.any_path + donor_.same_point && node.seam_free_path < infinity;
}

void PatchReader::gather(const std::vector<Image>& images, const Vector3d& centre, double radius) {
    ++run_;
    seams_near_ = false;
    parts_ = 0;
    nodes_.clear();
    for (const Image& image : images) {
        if (seen(image.face)) continue;
        ++parts_;
        spread(image.face, centre, radius);
    }
}

void PatchReader::spread(int from, const Vector3d& centre, double radius) {
    const auto add = [&](int f) {
        if (seen(f)) return;
        stamp_[f] = run_;
        const double distance = (donor_.point(f, donor_.closest(f, centre)) - centre).norm();
        // Looked at and left out: no image lies outside the ball.
        slot_[f] = distance <= radius ? static_cast<int>(nodes_.size()) : -1;
        if (slot_[f] < 0) return;
        nodes_.push_back({f, distance, infinity, infinity});
        seams_near_ = seams_near_ || donor_.graph.has_seam[f] != 0;
    };
    std::size_t at = nodes_.size();
    add(from);
    for (; at < nodes_.size(); ++at) {
        const int f = nodes_[at].face;
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
            for (int g = donor_.graph.next[h]; g != h; g = donor_.graph.next[g]) add(g / 3);
        }
    }
}

int PatchReader::choose_root(const std::vector<Image>& images, double radius) const {
    Vector3d normal = Vector3d::Zero();
    for (const Image& image : images) normal += donor_.normal.row(image.face).transpose();
    const auto votes = [&](int island) {
        return std::count_if(images.begin(), images.end(),
                             [&](const Image& image) { return donor_.graph.island[image.face] == island; });
    };
    int root = -1;
    double best = infinity;
    for (int i = 0; i < static_cast<int>(nodes_.size()); ++i) {
        const Node& node = nodes_[i];
        // Two sides of a thin sheet are equally near: the side of the images has it.
        const bool back = donor_.normal.row(node.face).dot(normal) < 0.0;
        const double cost = node.distance + (back ? 0.5 * radius : 0.0);
        if (cost > best + donor_.same_point) continue;
        if (root >= 0 && cost > best - donor_.same_point) {
            const auto more = votes(donor_.graph.island[node.face]);
            const auto had = votes(donor_.graph.island[nodes_[root].face]);
            if (more < had || (more == had && node.face > nodes_[root].face)) continue;
        }
        root = i;
        best = std::min(best, cost);
    }
    return root;
}

// Dijkstra over the gathered triangles; a path enters a triangle at the point of the shared edge nearest to where it
// entered the one before. Both kinds of path are measured alike, so that their ratio is fair.
void PatchReader::measure_paths(int root, const Vector3d& centre, bool cross_seams) {
    const auto length = [&](Node& node) -> double& { return cross_seams ? node.any_path : node.seam_free_path; };
    const auto& graph = donor_.graph;
    entry_.resize(nodes_.size());
    entry_[root] = donor_.point(nodes_[root].face, donor_.closest(nodes_[root].face, centre));
    length(nodes_[root]) = 0.0;
    heap_.assign(1, {0.0, root});
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
        const auto [done, i] = heap_.back();
        heap_.pop_back();
        if (done > length(nodes_[i])) continue;
        const int f = nodes_[i].face;
        for (int h = 3 * f; h < 3 * f + 3; ++h) {
            if (graph.next[h] == h) continue;
            const Vector3d a = donor_.corner(f, h % 3);
            const Vector3d b = donor_.corner(f, (h + 1) % 3);
            const double t = std::clamp(closest_parameter(entry_[i], a, b), edge_margin, 1.0 - edge_margin);
            const Vector3d crossing = a + t * (b - a);
            const double longer = done + (crossing - entry_[i]).norm();
            for (int g = graph.next[h]; g != h; g = graph.next[g]) {
                if (!cross_seams && graph.side[g] != graph.side[h]) continue;
                if (!seen(g / 3) || slot_[g / 3] < 0 || longer >= length(nodes_[slot_[g / 3]])) continue;
                const int j = slot_[g / 3];
                length(nodes_[j]) = longer;
                entry_[j] = crossing;
                heap_.emplace_back(longer, j);
                std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
            }
        }
    }
}

PatchReader::Reading PatchReader::nearest(const Vector3d& p) const {
    Reading best;
    best.distance = infinity;
    for (int i = 0; i < static_cast<int>(nodes_.size()); ++i) {
        if (!visible(nodes_[i])) continue;
        Reading reading;
        reading.node = i;
        reading.weights = donor_.closest(nodes_[i].face, p);
        const Vector3d offset = p - donor_.point(nodes_[i].face, reading.weights);
        reading.distance = offset.norm();
        if (reading.distance > best.distance + donor_.same_point) continue;
        find_hinge(reading, offset);
        if (best.node >= 0 && reading.distance > best.distance - donor_.same_point) {
            // On the patch, what is nearest to the root along the patch counts: at a seam's end both sides are in it.
            // Beyond it, the border that lies squarest before the point.
            const bool beyond = best.distance > donor_.same_point;
            if (beyond && reading.slide > best.slide + donor_.same_point) continue;
            const bool even = !beyond || reading.slide >= best.slide - donor_.same_point;
            if (even && nodes_[i].seam_free_path >= nodes_[best.node].seam_free_path) continue;
        }
        best = reading;
    }
    return best;
}

Place PatchReader::place(const Image& image, const Reading& reading) const {
    const int face = nodes_[reading.node].face;
    if (reading.distance > donor_.same_point) return extend(reading, image.point);
    if (!visible(nodes_[slot_[image.face]])) return {face, reading.weights};
    // One place for every polygon that shares the corner, wherever the branch is the same.
    const Eigen::RowVectorXd here = donor_.value(face, reading.weights);
    const Eigen::RowVectorXd own = donor_.value(image.face, image.weights);
    const bool same = here.size() == 0 || (here - own).cwiseAbs().maxCoeff() <= donor_.tolerance;
    return same ? Place{image.face, image.weights} : Place{face, reading.weights};
}

bool PatchReader::is_border(int half_edge) const {
    const auto& graph = donor_.graph;
    for (int g = graph.next[half_edge]; g != half_edge; g = graph.next[g]) {
        if (graph.side[g] == graph.side[half_edge]) return false;
    }
    return true;
}

void PatchReader::find_hinge(Reading& reading, const Vector3d& offset) const {
    const int face = nodes_[reading.node].face;
    reading.slide = infinity;
    for (int c = 0; c < 3; ++c) {
        if (reading.weights[(c + 2) % 3] > on_edge || !is_border(3 * face + c)) continue;
        const Vector3d along = donor_.corner(face, (c + 1) % 3) - donor_.corner(face, c);
        const double slide = std::abs(offset.dot(along.stableNormalized()));
        if (slide >= reading.slide) continue;
        reading.slide = slide;
        reading.hinge = c;
    }
}

double PatchReader::thickness(int face) const {
    const Vector3d a = donor_.corner(face, 0), b = donor_.corner(face, 1), c = donor_.corner(face, 2);
    const double longest = donor_.longest_edge[face];
    return longest > 0.0 ? (b - a).cross(c - a).norm() / (longest * longest) : 0.0;
}

int PatchReader::behind(int face, int hinge) const {
    const auto& graph = donor_.graph;
    for (int step = 0; step < most_splinters; ++step) {
        int across = -1;
        double longest = 0.0;
        for (int c = 0; c < 3; ++c) {
            const double length = (donor_.corner(face, (c + 1) % 3) - donor_.corner(face, c)).norm();
            if (c == hinge || length <= longest || is_border(3 * face + c)) continue;
            across = 3 * face + c;
            longest = length;
        }
        if (across < 0) return -1;
        int other = graph.next[across];
        while (graph.side[other] != graph.side[across]) other = graph.next[other];
        face = other / 3;
        hinge = other % 3;
        if (thickness(face) >= thick) return other;
    }
    return -1;
}

Place PatchReader::extend(const Reading& reading, const Vector3d& p) const {
    int face = nodes_[reading.node].face, hinge = reading.hinge;
    Vector3d weights = reading.weights;
    if (extrapolation_ <= 0.0) return {face, weights};
    if (thickness(face) < thick) {
        if (const int other = behind(face, hinge); other >= 0) {
            face = other / 3;
            hinge = other % 3;
            weights = donor_.closest(face, p);
        } else if (thickness(face) < thinnest) {
            return {face, weights};
        }
    }
    const Vector3d a = donor_.corner(face, 0), b = donor_.corner(face, 1), c = donor_.corner(face, 2);
    const Vector3d normal = donor_.normal.row(face).transpose();
    const Vector3d from = donor_.point(face, weights);
    const Vector3d offset = p - from;
    Vector3d move = offset - offset.dot(normal) * normal;
    if (hinge >= 0) {
        // As if what lies behind the border were folded flat about it.
        const Vector3d start = donor_.corner(face, hinge);
        const Vector3d along = (donor_.corner(face, (hinge + 1) % 3) - start).normalized();
        const Vector3d inward = donor_.corner(face, (hinge + 2) % 3) - start;
        const Vector3d out = (inward.dot(along) * along - inward).normalized();
        const double slide = offset.dot(along);
        move = slide * along + (offset - slide * along).norm() * out;
    } else if (move.norm() < 0.2 * offset.norm()) {
        return {face, weights};
    }
    const double step = std::min(offset.norm(), extrapolation_ * donor_.longest_edge[face]);
    return {face, plane_weights(from + step * move.stableNormalized(), a, b, c)};
}

}  // namespace isograft
