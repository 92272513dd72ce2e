// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/clean.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <sstream>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "base/sorting.h"
#include "isograft/errors.h"
#include "surface/edges.h"

namespace isograft {

namespace {

// Beyond these the squares of areas leave the range of double.
constexpr double smallest_extent = 1e-50;
constexpr double largest_extent = 1e50;
// Height over longest edge below which a triangle has no usable direction.
constexpr double flat = 1e-10;

std::string counted(Eigen::Index n, const char* one, const char* many) {
    return std::to_string(n) + " " + (n == 1 ? one : many);
}

class DisjointSets {
  public:
    explicit DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

    int root(int i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // The lowest member is the root, whatever the order of joining.
    void join(int a, int b) {
        a = root(a);
        b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<int> parent_;
};

bool has_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const double largest = std::max({a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff(), c.cwiseAbs().maxCoeff()});
    const double resolved = 8.0 * std::numeric_limits<double>::epsilon() * largest;
    return (b - a).cross(c - a).norm() > longest * std::max(flat * longest, resolved);
}

bool same_turn(const Corners& a, const Corners& b) {
    const int k = static_cast<int>(std::find(b.begin(), b.end(), a[0]) - b.begin());
    return a[1] == b[(k + 1) % 3];
}

// At the same three places two triangles are one drawn twice, unless they are walls of two bodies that touch: those
// have vertices of their own, joined to the rest of their body, and opposite winding.
void drop_repeated(Soup& soup, const std::vector<int>& place, Monitor& monitor) {
    const int count = static_cast<int>(soup.face.size());
    std::vector<int> uses(soup.position.size(), 0);
    monitor.check();
    for (const Corners& face : soup.face) {
        for (const int v : face) ++uses[v];
    }
    monitor.check();
    struct Item {
        Corners key;
        bool loose;
        int face;
    };
    std::vector<Item> items;
    fill_watched(items, count, monitor);
    const auto placed = [&](int f) {
        const Corners& face = soup.face[f];
        return Corners{place[face[0]], place[face[1]], place[face[2]]};
    };
    for (int f = 0; f < count; ++f) {
        if (f % often == 0) monitor.check();
        Corners key = placed(f);
        std::sort(key.begin(), key.end());
        const auto& face = soup.face[f];
        items[f] = {key, std::all_of(face.begin(), face.end(), [&](int v) { return uses[v] == 1; }), f};
    }
    // Of a loose triangle and one that hangs in the surface the latter is kept.
    items = sort_by_buckets(
        std::move(items), static_cast<int>(place.size()), [](const Item& item) { return item.key[0]; },
        [](const Item& a, const Item& b) {
            return std::tie(a.key, a.loose, a.face) < std::tie(b.key, b.loose, b.face);
        },
        monitor);
    std::vector<char> repeated(count, 0);
    for (int i = 0, first = 0; i < count; ++i) {
        if (i % often == 0) monitor.check();
        if (items[i].key != items[first].key) first = i;
        for (int k = first; k < i && !repeated[items[i].face]; ++k) {
            const int f = items[i].face, g = items[k].face;
            if (repeated[g]) continue;
            Corners a = soup.face[f], b = soup.face[g];
            std::sort(a.begin(), a.end());
            std::sort(b.begin(), b.end());
            repeated[f] = items[i].loose || a == b || same_turn(placed(f), placed(g));
        }
    }
    int kept = 0;
    for (int f = 0; f < count; ++f) {
        if (repeated[f]) continue;
        soup.face[kept] = soup.face[f];
        soup.input_face[kept++] = soup.input_face[f];
    }
    soup.face.resize(kept);
    soup.input_face.resize(kept);
    warn(soup.warnings, count - kept, "triangle was left out because it repeats another.",
         "triangles were left out because they repeat others.");
}

// Two triangles, and only two, have this edge in space, but not by their indices: a seam.
void weld_seams(const Soup& soup, const std::vector<int>& place, DisjointSets& sets, Monitor& monitor) {
    std::vector<Corners> placed;
    copy_watched(placed, soup.face, monitor);
    for (Corners& face : placed) {
        for (int& v : face) v = place[v];
    }
    const Edges edges = collect_edges(placed, monitor);
    const auto corner = [](const std::vector<Corners>& face, int h) { return face[h / 3][h % 3]; };
    for (const EdgeGroup& group : edges.group) {
        if (group.begin % often == 0) monitor.check();
        if (group.end - group.begin != 2) continue;
        const int g = edges.item[group.begin].halfedge, h = edges.item[group.begin + 1].halfedge;
        const bool along = corner(placed, g) == corner(placed, h);
        sets.join(corner(soup.face, g), corner(soup.face, along ? h : following(h)));
        sets.join(corner(soup.face, following(g)), corner(soup.face, along ? following(h) : h));
    }
}

}  // namespace

void check_size(Eigen::Index vertices, Eigen::Index triangles) {
    constexpr Eigen::Index most_vertices = Eigen::Index{1} << 30;
    constexpr Eigen::Index most_triangles = std::numeric_limits<int>::max() / 3;
    if (vertices > most_vertices) {
        throw ResourceLimit("the mesh has " + std::to_string(vertices) + " vertices, the limit is " +
                            std::to_string(most_vertices) + "; simplify it first");
    }
    if (triangles > most_triangles) {
        throw ResourceLimit("the mesh has " + std::to_string(triangles) + " triangles, the limit is " +
                            std::to_string(most_triangles) + "; simplify it first");
    }
}

std::vector<int> find_places(const std::vector<Eigen::Vector3d>& position, Monitor& monitor) {
    // The first coordinate beside the index: most comparisons look no further.
    struct Item {
        double x;
        int vertex;
    };
    std::vector<Item> order;
    fill_watched(order, position.size(), monitor);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = {position[i][0], static_cast<int>(i)};
    const auto compare = [&](const Item& a, const Item& b) {
        if (a.x != b.x) return a.x < b.x;
        for (int k = 1; k < 3; ++k) {
            const double p = position[a.vertex][k], q = position[b.vertex][k];
            if (p != q) return p < q;
        }
        return a.vertex < b.vertex;
    };
    sort_watched(order.begin(), order.end(), compare, monitor);
    std::vector<int> place(position.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i % often == 0) monitor.check();
        const int v = order[i].vertex;
        const bool same = i > 0 && position[v] == position[order[i - 1].vertex];
        place[v] = same ? place[order[i - 1].vertex] : v;
    }
    return place;
}

void check_coordinates(const Points& vertices) {
    Eigen::Index first = -1, bad = 0;
    for (Eigen::Index v = vertices.rows(); v-- > 0;) {
        if (vertices.row(v).array().isFinite().all()) continue;
        first = v;
        ++bad;
    }
    if (bad > 0) {
        throw InvalidInput("`vertices` holds NaN or infinity in " + counted(bad, "row", "rows") +
                           ", the first is row " + std::to_string(first) +
                           "; give those vertices finite coordinates or remove them");
    }
    // Halved, so that the difference of two numbers near the ends of the range stays finite.
    const double extent = 2.0 * (0.5 * vertices.colwise().maxCoeff() - 0.5 * vertices.colwise().minCoeff()).maxCoeff();
    if (extent > largest_extent || (extent > 0.0 && extent < smallest_extent)) {
        std::ostringstream text;
        text << "the extent of the " << vertices.rows() << " vertices is " << extent << ", outside " << smallest_extent
             << " to " << largest_extent << "; multiply the coordinates by a common factor";
        throw InvalidInput(text.str());
    }
}

void check_arrays(const Points& vertices, const Triangles& faces) {
    if (vertices.rows() == 0) throw InvalidInput("`vertices` is empty: 0 rows; pass at least three vertices");
    if (faces.rows() == 0) throw InvalidInput("`faces` is empty: 0 rows; pass at least one triangle");
    check_size(vertices.rows(), faces.rows());
    check_coordinates(vertices);
    Eigen::Index first = -1, bad = 0;
    for (Eigen::Index f = faces.rows(); f-- > 0;) {
        if (faces.row(f).minCoeff() >= 0 && faces.row(f).maxCoeff() < vertices.rows()) continue;
        first = f;
        ++bad;
    }
    if (bad > 0) {
        std::ostringstream text;
        text << "`faces` holds indices out of range in " << counted(bad, "triangle", "triangles")
             << ", the first is triangle " << first << " (" << faces(first, 0) << ", " << faces(first, 1) << ", "
             << faces(first, 2) << "); indices must be 0 to " << vertices.rows() - 1
             << ", the rows of `vertices`, counted from 0";
        throw InvalidInput(text.str());
    }
}

Soup clean(const Points& vertices, const Triangles& faces, Piece progress) {
    Monitor& monitor = progress.monitor();
    Soup soup;
    soup.position.resize(vertices.rows());
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) soup.position[v] = vertices.row(v);
    const std::vector<int> place = find_places(soup.position, monitor);
    progress.reach(0.4);
    DisjointSets sets(static_cast<int>(vertices.rows()));
    std::vector<char> used(vertices.rows(), 0);
    int repeated_corner = 0, without_area = 0;
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
        if (f % often == 0) monitor.check();
        const Corners face{faces(f, 0), faces(f, 1), faces(f, 2)};
        for (const int v : face) used[v] = 1;
        if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) {
            ++repeated_corner;
        } else if (!has_area(soup.position[face[0]], soup.position[face[1]], soup.position[face[2]])) {
            ++without_area;
            // The triangles on both sides of a needle meet once its short edge is one vertex.
            for (int k = 0; k < 3; ++k) {
                const int a = face[k], b = face[(k + 1) % 3];
                if (place[a] == place[b]) sets.join(a, b);
            }
        } else {
            soup.face.push_back(face);
            soup.input_face.push_back(f);
        }
    }
    warn(soup.warnings, std::count(used.begin(), used.end(), 0), "vertex belongs to no triangle and stays unmatched.",
         "vertices belong to no triangle and stay unmatched.");
    warn(soup.warnings, repeated_corner, "triangle was left out because a corner is repeated.",
         "triangles were left out because a corner is repeated.");
    warn(soup.warnings, without_area, "triangle was left out because it has no area.",
         "triangles were left out because they have no area.");
    progress.reach(0.5);
    drop_repeated(soup, place, monitor);
    progress.reach(0.7);
    if (soup.face.empty()) {
        throw InvalidInput("none of the " + counted(faces.rows(), "triangle", "triangles") +
                           " in `faces` has an area: their corners coincide or lie on a line; check that the "
                           "coordinates and the indices belong together");
    }
    weld_seams(soup, place, sets, monitor);
    progress.reach(0.95);
    int welded = 0;
    for (int v = 0; v < static_cast<int>(used.size()); ++v) welded += used[v] && sets.root(v) != v;
    for (auto& face : soup.face) {
        for (int& v : face) v = sets.root(v);
    }
    warn(soup.warnings, welded, "vertex was welded to another at the same place, where the surface was in pieces.",
         "vertices were welded to others at the same place, where the surface was in pieces.");
    soup.input_order.assign(soup.face.size(), 0);
    return soup;
}

std::vector<int> working_vertices(const Surface& surface) {
    if (surface.is_cloud()) return surface.cloud_vertex();
    const TriangleMesh& mesh = surface.mesh();
    const Eigen::Index count = surface.vertices().rows();
    std::vector<int> result(count, -1);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (mesh.input_face[f] < 0) continue;
        for (int k = 0; k < 3; ++k) {
            int& vertex = result[surface.faces()(mesh.input_face[f], mesh.input_corner(f, k))];
            if (vertex < 0) vertex = mesh.face[f][k];
        }
    }
    // Vertices of triangles that were left out only: the triangle they repeat has others at the same place.
    std::vector<char> left_out(count, 0);
    for (Eigen::Index i = 0; i < surface.faces().size(); ++i) {
        const int v = surface.faces().data()[i];
        left_out[v] = result[v] < 0;
    }
    if (std::count(left_out.begin(), left_out.end(), 1) == 0) return result;
    std::vector<Eigen::Vector3d> position(count);
    for (Eigen::Index v = 0; v < count; ++v) position[v] = surface.vertices().row(v);
    Monitor silent;
    const std::vector<int> place = find_places(position, silent);
    std::vector<int> at_place(count, -1);
    for (Eigen::Index v = 0; v < count; ++v) {
        if (at_place[place[v]] < 0) at_place[place[v]] = result[v];
    }
    for (Eigen::Index v = 0; v < count; ++v) {
        if (left_out[v]) result[v] = at_place[place[v]];
    }
    return result;
}

}  // namespace isograft
