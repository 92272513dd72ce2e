// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "isograft/errors.h"
#include "surface/cloud_graph.h"
#include "surface/cloud_input.h"
#include "surface/cloud_normals.h"
#include "surface/cloud_thin.h"
#include "surface/edges.h"
#include "surface/local_delaunay.h"
#include "surface/rimls.h"
#include "surface/triangulate.h"

namespace isograft {

namespace {

// More points than this tell no more at the resolution that maps are computed at.
constexpr int most_base = 60000;
constexpr int most_sites = 20000;
// In local spacings: distance of points that have lost the surface, and the smallest group that is kept.
constexpr double outlier_reach = 3.0;
constexpr int outlier_group = 20;
// Distance of sites, the radius of circles without points that are filled, and that of those that are holes.
constexpr double site_distance = 0.75;
constexpr double gap = 0.95;
constexpr double hole = 2.0;
constexpr double surroundings = 4.5;
// Parts of fewer triangles are debris.
constexpr int fewest_triangles = 16;
constexpr double ambiguous_share = 0.05;

struct Base {
    std::vector<Eigen::Vector3d> position, normal, given;
    std::vector<double> spacing;
    CloudSides sides;
};

std::string percent(int part, int whole) {
    const int tenths = static_cast<int>(std::lround(1000.0 * part / whole));
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " %";
}

template <class T>
std::vector<T> chosen(const std::vector<T>& items, const std::vector<char>& left_out) {
    std::vector<T> kept;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (!left_out[i]) kept.push_back(items[i]);
    }
    return kept;
}

// Points without outliers, with oriented normals.
Base make_base(const CloudInput& input, std::vector<std::string>& warnings, Monitor& monitor) {
    Base base;
    base.position = input.position;
    base.given = input.normal;
    if (static_cast<int>(base.position.size()) > most_base) average_in_cells(base.position, base.given, most_base);
    int outliers = 0;
    // Twice: among many outliers those of the first round make others look well joined.
    for (int round = 0; round < 2; ++round) {
        const KdTree tree(base.position);
        const CloudGraph graph = neighbour_graph(tree, graph_neighbours, monitor);
        const std::vector<char> out = find_outliers(tree, graph, outlier_reach, outlier_group);
        outliers += static_cast<int>(std::count(out.begin(), out.end(), 1));
        base.position = chosen(base.position, out);
        if (!base.given.empty()) base.given = chosen(base.given, out);
    }
    warn(warnings, outliers, "point lies apart from all others and was left out as an outlier.",
         "points lie apart from the others and were left out as outliers.");
    if (static_cast<int>(base.position.size()) < fewest_points) {
        throw InvalidInput("only " + std::to_string(base.position.size()) + " of " +
                           std::to_string(input.position.size()) +
                           " points lie on a surface, the others are scattered; at least " +
                           std::to_string(fewest_points) + " are needed");
    }
    const KdTree tree(base.position);
    CloudGraph graph = neighbour_graph(tree, graph_neighbours, monitor);
    base.normal = base.given.empty() ? fit_normals(tree, graph, monitor) : base.given;
    base.sides = orient_normals(tree, graph, base.given, base.normal, monitor);
    if (base.given.empty()) {
        refit_normals(tree, graph, base.normal, monitor);
        base.sides = orient_normals(tree, graph, base.given, base.normal, monitor);
    }
    base.spacing = std::move(graph.spacing);
    return base;
}

void warn_of_sides(const Base& base, std::vector<std::string>& warnings) {
    const int count = static_cast<int>(base.position.size());
    const int turned = base.sides.turned;
    if (turned > 0) {
        warnings.push_back("the normals of " + std::to_string(turned) + " points (" + percent(turned, count) +
                           ") contradicted their neighbours or the shape and were turned over.");
    }
    const auto doubtful = static_cast<int>(std::count(base.sides.doubtful.begin(), base.sides.doubtful.end(), 1));
    if (doubtful > 0) {
        warnings.push_back("the side of the normals is doubtful at " + std::to_string(doubtful) + " points (" +
                           percent(doubtful, count) + "): they contradict more than a third of their neighbours.");
    }
}

// Everything onto the smoothed surface, then evenly spread.
SurfaceSites make_sites(const Base& base, const Rimls& surface, Monitor& monitor) {
    std::vector<Eigen::Vector3d> position, normal;
    std::vector<double> spacing;
    for (std::size_t i = 0; i < base.position.size(); ++i) {
        if (i % 256 == 0) monitor.check();
        const Rimls::Projection p = surface.project(base.position[i], base.normal[i]);
        if (!p.converged || (p.position - base.position[i]).norm() > 1.5 * base.spacing[i]) continue;
        if (p.normal.dot(base.normal[i]) < 0.3) continue;
        position.push_back(p.position);
        normal.push_back(p.normal);
        spacing.push_back(base.spacing[i]);
    }
    double area = 0.0;
    for (const double s : spacing) area += s * s;
    const double least = std::sqrt(0.72 * area / most_sites);
    SurfaceSites sites;
    for (const int i : pick_evenly(position, normal, spacing, site_distance, least, monitor)) {
        sites.position.push_back(position[i]);
        sites.normal.push_back(normal[i]);
        sites.spacing.push_back(std::max(spacing[i], least / site_distance));
    }
    return sites;
}

// Sites where circles without any are large, but not yet holes.
int fill_gaps(SurfaceSites& sites, const Rimls& surface, const std::vector<SeenTriangle>& seen, Monitor& monitor) {
    std::vector<const SeenTriangle*> gaps;
    for (const SeenTriangle& t : seen) {
        if (t.votes >= 2 && t.radius > gap * sites.spacing[t.corner[0]]) gaps.push_back(&t);
    }
    std::stable_sort(gaps.begin(), gaps.end(),
                     [](const SeenTriangle* a, const SeenTriangle* b) { return a->radius > b->radius; });
    const KdTree tree(sites.position);
    std::vector<KdTree::Found> found;
    const std::size_t old = sites.position.size();
    for (const SeenTriangle* t : gaps) {
        monitor.check();
        Eigen::Vector3d side = Eigen::Vector3d::Zero();
        double spacing = 0.0;
        for (const int v : t->corner) {
            side += sites.normal[v];
            spacing += sites.spacing[v] / 3.0;
        }
        const Rimls::Projection p = surface.project(t->centre, side.normalized());
        if (!p.converged || (p.position - t->centre).norm() > t->radius) continue;
        const double least = site_distance * spacing;
        const auto crowds = [&](std::size_t i) {
            return sites.normal[i].dot(p.normal) > 0.0 && (sites.position[i] - p.position).norm() < least;
        };
        tree.within(p.position, least, found);
        bool free = std::none_of(found.begin(), found.end(), [&](const KdTree::Found& f) { return crowds(f.index); });
        for (std::size_t i = old; i < sites.position.size() && free; ++i) free = !crowds(i);
        if (!free) continue;
        sites.position.push_back(p.position);
        sites.normal.push_back(p.normal);
        sites.spacing.push_back(spacing);
    }
    return static_cast<int>(sites.position.size() - old);
}

std::vector<Corners> without_debris(const std::vector<Corners>& faces, const SurfaceSites& sites, int& dropped) {
    const std::vector<int> none(faces.size(), 0);
    const TriangleMesh mesh = build_mesh(sites.position, faces, none, std::vector<char>(faces.size(), 0));
    std::vector<int> size(mesh.component_count, 0);
    for (const int c : mesh.component) ++size[c];
    std::vector<Corners> kept;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (size[mesh.component[f]] >= fewest_triangles) kept.push_back(faces[f]);
    }
    dropped = static_cast<int>(faces.size() - kept.size());
    return kept;
}

// Nearest vertex of the mesh for every input point, of those that look the same way if the point's side is known.
void place_points(const CloudInput& input, const Base& base, const Rimls& surface, Cloud& cloud, Monitor& monitor) {
    const KdTree base_tree(base.position);
    const KdTree mesh_tree(cloud.mesh.position);
    std::vector<KdTree::Found> found;
    std::vector<int> vertex(input.position.size(), -1);
    std::vector<Eigen::Vector3d> normal(input.position.size(),
                                        Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (std::size_t i = 0; i < input.position.size(); ++i) {
        if (i % 256 == 0) monitor.check();
        const Eigen::Vector3d& x = input.position[i];
        base_tree.nearest(x, 1, found);
        const int nearest = found.front().index;
        const double reach = 2.0 * base.spacing[nearest];
        if (found.front().squared_distance > reach * reach) continue;
        const Rimls::Projection p = surface.project(x, base.normal[nearest]);
        const Eigen::Vector3d& at = p.converged ? p.position : x;
        const Eigen::Vector3d& side = p.converged ? p.normal : base.normal[nearest];
        mesh_tree.nearest(at, 12, found);
        for (const KdTree::Found& f : found) {
            if (cloud.mesh.vertex_normal[f.index].dot(side) <= 0.0) continue;
            if (f.squared_distance > 4.0 * reach * reach) break;
            vertex[i] = f.index;
            normal[i] = side;
            break;
        }
    }
    cloud.normals.resize(static_cast<Eigen::Index>(normal.size()), 3);
    for (std::size_t i = 0; i < normal.size(); ++i) cloud.normals.row(static_cast<Eigen::Index>(i)) = normal[i];
    cloud.vertex = std::move(vertex);
}

// The side of open parts is unknown; that of closed ones with holes is not.
bool has_open_part(const Base& base) {
    std::vector<double> area(base.sides.closedness.size(), 0.0);
    for (std::size_t i = 0; i < base.position.size(); ++i)
        area[base.sides.part[i]] += base.spacing[i] * base.spacing[i];
    const double whole = std::accumulate(area.begin(), area.end(), 0.0);
    for (std::size_t part = 0; part < area.size(); ++part) {
        if (base.sides.closedness[part] < closed_enough && area[part] > ambiguous_share * whole) return true;
    }
    return false;
}

}  // namespace

Cloud make_cloud(const Points& vertices, const Points& normals, Piece progress) {
    Monitor& monitor = progress.monitor();
    CloudInput input = check_cloud(vertices, normals, monitor);
    Cloud cloud;
    // In the unit box nothing overflows, whatever the units, and nothing is lost far from the origin.
    const Eigen::Vector3d low = vertices.colwise().minCoeff().transpose();
    const double extent = (vertices.colwise().maxCoeff().transpose() - low).maxCoeff();
    for (Eigen::Vector3d& x : input.position) x = (x - low) / extent;
    const Base base = make_base(input, cloud.warnings, monitor);
    warn_of_sides(base, cloud.warnings);
    progress.reach(0.3);
    const KdTree tree(base.position);
    const Rimls surface(tree, base.normal, base.spacing);
    SurfaceSites sites = make_sites(base, surface, monitor);
    progress.reach(0.5);
    std::vector<SeenTriangle> seen;
    for (int round = 0; round < 3; ++round) {
        seen = local_delaunay(sites, KdTree(sites.position), surroundings, hole, monitor);
        if (round == 2 || fill_gaps(sites, surface, seen, monitor) == 0) break;
    }
    progress.reach(0.7);
    int debris = 0;
    const std::vector<Corners> faces =
        without_debris(triangulate(sites, std::move(seen), hole, monitor), sites, debris);
    if (faces.empty()) {
        throw InvalidInput("the " + std::to_string(vertices.rows()) +
                           " points show no surface at their own spacing; pass more points, or triangles");
    }
    for (Eigen::Vector3d& x : sites.position) x = x * extent;
    std::vector<int> own(faces.size());
    std::iota(own.begin(), own.end(), 0);
    cloud.mesh = build_mesh(sites.position, faces, own, std::vector<char>(faces.size(), 0));
    for (Eigen::Vector3d& x : cloud.mesh.position) x /= extent;
    progress.reach(0.8);
    place_points(input, base, surface, cloud, monitor);
    progress.reach(1.0);
    for (Eigen::Vector3d& x : cloud.mesh.position) x = x * extent + low;
    cloud.ambiguous = has_open_part(base);
    const auto off = std::count(cloud.vertex.begin(), cloud.vertex.end(), -1);
    warn(cloud.warnings, off, "point belongs to no part of the surface and gets no result.",
         "points belong to no part of the surface and get no result.");
    return cloud;
}

}  // namespace isograft
