// SPDX-License-Identifier: GPL-3.0-or-later
#include "geodesic/window.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>

#include "isograft/errors.h"
#include "isograft/geodesic.h"
#include "surface/clean.h"

namespace isograft {

namespace {

// The position, below an edge laid along the real axis, of the source that explains the distances of its ends.
Complex virtual_source(double edge, double from_distance, double to_distance) {
    const double x = (edge * edge + from_distance * from_distance - to_distance * to_distance) / (2.0 * edge);
    const double y2 = from_distance * from_distance - x * x;
    return {x, y2 > 0.0 ? -std::sqrt(y2) : 0.0};
}

// How a path reaches a point beyond an edge that is laid along the real axis.
struct Unfolded {
    double distance = 0.0;
    /// The straight path crosses the edge; otherwise it runs over one of its ends.
    bool straight = false;
    bool over_from = false;
    Complex source;
};

Unfolded unfold(double edge, Complex far, double from_distance, double to_distance) {
    Unfolded result;
    const Complex source = virtual_source(edge, from_distance, to_distance);
    result.source = source;
    const double drop = far.imag() - source.imag();
    const double crossing =
        drop > 1e-12 * edge ? source.real() - (far.real() - source.real()) * source.imag() / drop : source.real();
    if (crossing >= 0.0 && crossing <= edge && source.imag() < 0.0) {
        result.distance = modulus(far - source);
        result.straight = true;
        return result;
    }
    const double over_from = from_distance + modulus(far);
    const double over_to = to_distance + modulus(far - Complex(edge, 0.0));
    result.over_from = over_from <= over_to;
    result.distance = result.over_from ? over_from : over_to;
    return result;
}

double unfolded_angle(const Unfolded& u, double edge, Complex far, double from_angle, double to_angle) {
    if (!u.straight) return u.over_from ? from_angle : to_angle;
    const Complex from = -u.source;
    const Complex to = Complex(edge, 0.0) - u.source;
    const Complex there = far - u.source;
    const double whole = std::atan2(cross(from, to), dot(from, to));
    const double part = std::atan2(cross(from, there), dot(from, there));
    const double share = std::abs(whole) > 1e-9 ? part / whole : 0.5;
    return from_angle + share * wrap_angle(to_angle - from_angle);
}

// A vertex of a good mesh is corrected twice or so, one beside slivers a hundred times.
constexpr int most_offers = 5000;
static_assert(most_offers < std::numeric_limits<std::uint16_t>::max());

}  // namespace

Window::Window(const TriangleMesh& mesh) : mesh_(&mesh), place_(mesh.vertex_count()) {
    if (!mesh.has_paths()) throw std::logic_error("a window needs a mesh with paths");
}

bool Window::improves(int vertex, double distance) const {
    // A gain beyond rounding counts: were it larger, the order of the triangles would decide between near ties. Round
    // slivers gains can chase each other downward without end, so a vertex is corrected only so often.
    const Place& known = place_[vertex];
    return !has(vertex) || (distance < known.distance * (1.0 - 1e-13) && known.offers < most_offers);
}

void Window::settle(int vertex, double distance, double angle, bool bent) {
    const bool first = !has(vertex);
    if (first) reached_.push_back(vertex);
    Place& place = place_[vertex];
    place = {distance, angle, run_, static_cast<std::uint16_t>(first ? 1 : place.offers + 1), bent};
    heap_.emplace_back(distance, vertex);
    std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
}

// From the ends of a half-edge to the corner beyond it.
void Window::relax_across(int halfedge, int from, int to, int apex) {
    const HalfedgeView& view = mesh_->view[halfedge];
    const Place &at_from = place_[from], &at_to = place_[to], &known = place_[apex];
    // No point of the edge is nearer than half of this, and beyond it there is still the height of the triangle.
    const double ends = at_from.distance + at_to.distance - view.length;
    if (has(apex) && known.distance < 0.5 * ends + view.apex.imag()) return;
    const Unfolded u = unfold(view.length, view.apex, at_from.distance, at_to.distance);
    // Most offers are no better than what is known: their angle is not asked for.
    if (!improves(apex, u.distance)) return;
    bool bent = false;
    if (u.straight) {
        bent = at_from.bent && at_to.bent;
    } else {
        const int over = u.over_from ? from : to;
        bent = place_[over].bent || mesh_->on_boundary[over] != 0;
    }
    settle(apex, u.distance, unfolded_angle(u, view.length, view.apex, at_from.angle, at_to.angle), bent);
}

void Window::relax_from(int vertex) {
    for (int i = mesh_->vertex_face_begin[vertex]; i < mesh_->vertex_face_begin[vertex + 1]; ++i) {
        const int f = mesh_->vertex_face[i];
        const auto& vertices = mesh_->face[f];
        const int k = vertices[0] == vertex ? 0 : vertices[1] == vertex ? 1 : 2;
        const int next = (k + 1) % 3;
        const int last = (k + 2) % 3;
        if (has(vertices[next])) relax_across(3 * f + k, vertex, vertices[next], vertices[last]);
        if (has(vertices[last])) relax_across(3 * f + last, vertices[last], vertex, vertices[next]);
    }
}

void Window::run(const SurfacePoint& centre, double radius) {
    if (++run_ == 0) {  // the stamps have come full circle
        for (Place& place : place_) place.run = 0;
        run_ = 1;
    }
    reached_.clear();
    heap_.clear();
    centre_ = centre;
    centre_planar_ = planar(*mesh_, centre);
    for (int k = 0; k < 3; ++k) {
        const Complex d = mesh_->corner[centre.face][k] - centre_planar_;
        settle(mesh_->face[centre.face][k], modulus(d), std::arg(d), false);
    }
    while (!heap_.empty()) {
        const auto [distance, vertex] = heap_.front();
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
        heap_.pop_back();
        if (distance > place_[vertex].distance) continue;
        if (distance > radius) break;
        relax_from(vertex);
    }
}

bool Window::bent_at(const SurfacePoint& point) const {
    const auto& corners = mesh_->face[point.face];
    return std::count_if(corners.begin(), corners.end(), [&](int v) { return has(v) && bent(v); }) >= 2;
}

std::optional<Polar> Window::query(const SurfacePoint& point) const {
    const Complex x = planar(*mesh_, point);
    if (point.face == centre_.face) {
        const Complex d = x - centre_planar_;
        return Polar{modulus(d), std::arg(d), -unit(d)};
    }
    const auto& vertices = mesh_->face[point.face];
    const auto& corner = mesh_->corner[point.face];
    std::optional<Unfolded> best;
    Complex best_far;
    int best_corner = -1;
    for (int k = 0; k < 3; ++k) {
        const int from = vertices[k];
        const int to = vertices[(k + 1) % 3];
        if (!has(from) || !has(to)) continue;
        const int h = 3 * point.face + k;
        const Complex far = (x - corner[k]) * std::conj(mesh_->direction[h]);
        const Unfolded u = unfold(mesh_->view[h].length, far, place_[from].distance, place_[to].distance);
        if (best && u.distance >= best->distance) continue;
        best = u;
        best_far = far;
        best_corner = k;
    }
    if (!best) return std::nullopt;
    const int next = (best_corner + 1) % 3;
    const int h = 3 * point.face + best_corner;
    const double angle = unfolded_angle(*best, mesh_->view[h].length, best_far, place_[vertices[best_corner]].angle,
                                        place_[vertices[next]].angle);
    const Complex back = best->straight ? (best->source - best_far) * mesh_->direction[h]
                                        : (best->over_from ? corner[best_corner] : corner[next]) - x;
    return Polar{best->distance, wrap_angle(angle), unit(back)};
}

Eigen::VectorXd geodesic_distances(const Surface& surface, int face, const Eigen::Vector3d& barycentric,
                                   double radius) {
    if (!(radius > 0.0)) throw InvalidInput("radius must be positive, not " + std::to_string(radius));
    const std::vector<int>& input_face = surface.mesh().input_face;
    const auto found = std::find(input_face.begin(), input_face.end(), face);
    if (face < 0 || face >= surface.faces().rows() || found == input_face.end()) {
        throw InvalidInput("face " + std::to_string(face) +
                           " is out of range or was left out as repeated or without area; choose another");
    }
    const TriangleMesh& mesh = surface.mesh_with_paths();
    SurfacePoint centre;
    centre.face = static_cast<int>(found - input_face.begin());
    for (int k = 0; k < 3; ++k) centre.weight[k] = barycentric[mesh.input_corner(centre.face, k)];
    Window window(mesh);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    window.run(point_at(mesh, centre.face, planar(mesh, centre)), radius);
    Eigen::VectorXd result = Eigen::VectorXd::Constant(surface.vertices().rows(), infinity);
    for (const int v : window.reached()) {
        double& d = result[mesh.input_vertex[v]];
        if (window.distance(v) <= radius) d = std::min(d, window.distance(v));
    }
    // Vertices that were welded are at one place, and at one distance.
    const std::vector<int> working = working_vertices(surface);
    for (Eigen::Index v = 0; v < result.size(); ++v) {
        if (working[v] >= 0) result[v] = std::min(result[v], result[mesh.input_vertex[working[v]]]);
    }
    return result;
}

}  // namespace isograft
