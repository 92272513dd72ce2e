// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/mesh.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "base/sorting.h"
#include "surface/edges.h"

namespace isograft {

namespace {

// Of a mesh along its last axis.
constexpr int slices = 1 << 14;

void connect(TriangleMesh& mesh, Monitor& monitor) {
    const Edges edges = collect_edges(mesh.face, monitor);
    fill_watched(mesh.twin, 3 * mesh.face.size(), -1, monitor);
    int looked = 0;
    for (const EdgeGroup& group : edges.group) {
        if (looked++ % often == 0) monitor.check();
        if (group.end - group.begin != 2) continue;
        const int g = edges.item[group.begin].halfedge, h = edges.item[group.begin + 1].halfedge;
        // Only an edge of exactly two triangles that run along it in opposite ways can be walked across.
        if (mesh.from(g) != mesh.to(h)) continue;
        mesh.twin[g] = h;
        mesh.twin[h] = g;
    }
}

int find_root(std::vector<int>& parent, int i) {
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

// Corners that are joined across an edge are one vertex; every further fan of a vertex gets a copy of it.
void split_fans(TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& position, Monitor& monitor) {
    const int corners = 3 * mesh.face_count();
    std::vector<int> parent;
    fill_watched(parent, corners, monitor);
    std::iota(parent.begin(), parent.end(), 0);
    for (int h = 0; h < corners; ++h) {
        const int g = mesh.twin[h];
        if (h % often == 0) monitor.check();
        if (g < h) continue;
        const auto join = [&](int a, int b) {
            a = find_root(parent, a);
            b = find_root(parent, b);
            parent[std::max(a, b)] = std::min(a, b);
        };
        join(h, following(g));
        join(following(h), g);
    }
    const auto old_vertex = [&](int c) { return mesh.face[c / 3][c % 3]; };
    // New vertices in the order of the old ones keep neighbours near each other in memory.
    std::vector<int> roots;
    for (int c = 0; c < corners; ++c) {
        if (c % often == 0) monitor.check();
        if (find_root(parent, c) == c) roots.push_back(c);
    }
    roots = sort_by_buckets(std::move(roots), static_cast<int>(position.size()), old_vertex, std::less<int>(), monitor);
    std::vector<int> index;
    fill_watched(index, corners, -1, monitor);
    mesh.position.reserve(roots.size());
    mesh.input_vertex.reserve(roots.size());
    for (std::size_t i = 0; i < roots.size(); ++i) {
        if (i % often == 0) monitor.check();
        index[roots[i]] = static_cast<int>(i);
        mesh.position.push_back(position[old_vertex(roots[i])]);
        mesh.input_vertex.push_back(old_vertex(roots[i]));
    }
    for (int c = 0; c < corners; ++c) {
        if (c % often == 0) monitor.check();
        mesh.face[c / 3][c % 3] = index[find_root(parent, c)];
    }
}

void collect_fans(TriangleMesh& mesh, Monitor& monitor) {
    mesh.vertex_face_begin.assign(mesh.vertex_count() + 1, 0);
    for (const auto& f : mesh.face) {
        for (const int v : f) ++mesh.vertex_face_begin[v + 1];
    }
    monitor.check();
    std::partial_sum(mesh.vertex_face_begin.begin(), mesh.vertex_face_begin.end(), mesh.vertex_face_begin.begin());
    fill_watched(mesh.vertex_face, 3 * mesh.face.size(), monitor);
    std::vector<int> next(mesh.vertex_face_begin.begin(), mesh.vertex_face_begin.end() - 1);
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (f % often == 0) monitor.check();
        for (const int v : mesh.face[f]) mesh.vertex_face[next[v]++] = f;
    }
}

void measure(TriangleMesh& mesh, Monitor& monitor) {
    const int faces = mesh.face_count();
    fill_watched(mesh.corner, faces, monitor);
    for (auto* of_face : {&mesh.axis_x, &mesh.axis_y, &mesh.normal}) {
        fill_watched(*of_face, faces, Eigen::Vector3d(Eigen::Vector3d::Zero()), monitor);
    }
    fill_watched(mesh.vertex_area, mesh.vertex_count(), 0.0, monitor);
    fill_watched(mesh.vertex_normal, mesh.vertex_count(), Eigen::Vector3d(Eigen::Vector3d::Zero()), monitor);
    fill_watched(mesh.on_boundary, mesh.vertex_count(), char{0}, monitor);
    mesh.area = 0.0;
    double edges = 0.0;
    for (int f = 0; f < faces; ++f) {
        if (f % often == 0) monitor.check();
        const auto& [a, b, c] = mesh.face[f];
        const Eigen::Vector3d ab = mesh.position[b] - mesh.position[a];
        const Eigen::Vector3d ac = mesh.position[c] - mesh.position[a];
        const Eigen::Vector3d cross = ab.cross(ac);
        const double area = 0.5 * cross.norm();
        mesh.area += area;
        mesh.normal[f] = cross.normalized();
        mesh.axis_x[f] = ab.normalized();
        mesh.axis_y[f] = mesh.normal[f].cross(mesh.axis_x[f]);
        mesh.corner[f] = {Complex(0.0, 0.0), Complex(ab.norm(), 0.0),
                          Complex(ac.dot(mesh.axis_x[f]), ac.dot(mesh.axis_y[f]))};
        for (int k = 0; k < 3; ++k) {
            edges += std::abs(mesh.edge(3 * f + k));
            mesh.vertex_area[mesh.face[f][k]] += area / 3.0;
            mesh.vertex_normal[mesh.face[f][k]] += cross;
        }
    }
    mesh.mean_edge = edges / (3.0 * faces);
    for (auto& n : mesh.vertex_normal) n.normalize();
    for (int h = 0; h < 3 * faces; ++h) {
        if (h % often == 0) monitor.check();
        if (mesh.twin[h] >= 0) continue;
        mesh.on_boundary[mesh.from(h)] = 1;
        mesh.on_boundary[mesh.to(h)] = 1;
    }
}

double face_area(const TriangleMesh& mesh, int f) { return 0.5 * mesh.corner[f][1].real() * mesh.corner[f][2].imag(); }

void label_components(TriangleMesh& mesh, Monitor& monitor) {
    const int faces = mesh.face_count();
    mesh.component.assign(faces, -1);
    std::vector<double> areas;
    std::vector<int> stack;
    int labelled = 0;
    for (int seed = 0; seed < faces; ++seed) {
        if (mesh.component[seed] >= 0) continue;
        const int label = static_cast<int>(areas.size());
        areas.push_back(0.0);
        stack.assign(1, seed);
        mesh.component[seed] = label;
        while (!stack.empty()) {
            if (labelled++ % often == 0) monitor.check();
            const int f = stack.back();
            stack.pop_back();
            areas[label] += face_area(mesh, f);
            for (int k = 0; k < 3; ++k) {
                const int g = mesh.twin[3 * f + k];
                if (g < 0 || mesh.component[g / 3] >= 0) continue;
                mesh.component[g / 3] = label;
                stack.push_back(g / 3);
            }
        }
    }
    std::vector<int> order(areas.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return areas[a] > areas[b]; });
    std::vector<int> rank(areas.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);
    for (int& c : mesh.component) c = rank[c];
    mesh.component_count = static_cast<int>(areas.size());
}

}  // namespace

TriangleMesh build_mesh(const std::vector<Eigen::Vector3d>& position, const std::vector<std::array<int, 3>>& face,
                        const std::vector<int>& input_face, const std::vector<char>& input_order, Piece progress) {
    Monitor& monitor = progress.monitor();
    TriangleMesh mesh;
    mesh.face = face;
    mesh.input_face = input_face;
    mesh.input_order = input_order;
    monitor.check();
    connect(mesh, monitor);
    progress.reach(0.4);
    split_fans(mesh, position, monitor);
    progress.reach(0.6);
    collect_fans(mesh, monitor);
    progress.reach(0.7);
    measure(mesh, monitor);
    progress.reach(0.9);
    label_components(mesh, monitor);
    progress.reach(1.0);
    return mesh;
}

TriangleMesh build_mesh(const std::vector<Eigen::Vector3d>& position, const std::vector<std::array<int, 3>>& face,
                        const std::vector<int>& input_face, const std::vector<char>& input_order) {
    Monitor silent;
    return build_mesh(position, face, input_face, input_order, Piece(silent, 0.0));
}

void measure_paths(TriangleMesh& mesh, Monitor& monitor) {
    if (mesh.has_paths()) return;
    std::vector<Complex> directions;
    std::vector<HalfedgeView> views;
    fill_watched(directions, mesh.twin.size(), monitor);
    fill_watched(views, mesh.twin.size(), monitor);
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        if (h % often == 0) monitor.check();
        const auto& corner = mesh.corner[h / 3];
        const int next = following(h), last = following(next);
        const Complex edge = mesh.edge(h);
        views[h].length = std::abs(edge);
        directions[h] = edge / views[h].length;
        views[h].apex = (corner[last % 3] - corner[h % 3]) * std::conj(directions[h]);
        views[h].beyond = {mesh.twin[next], mesh.twin[last]};
    }
    mesh.direction = std::move(directions);
    mesh.view = std::move(views);
}

TriangleMesh with_positions(const TriangleMesh& mesh, std::vector<Eigen::Vector3d> position, Monitor& monitor) {
    // All else is measured anew.
    TriangleMesh result;
    result.position = std::move(position);
    result.face = mesh.face;
    result.twin = mesh.twin;
    result.vertex_face_begin = mesh.vertex_face_begin;
    result.vertex_face = mesh.vertex_face;
    result.component = mesh.component;
    result.component_count = mesh.component_count;
    result.input_vertex = mesh.input_vertex;
    result.input_face = mesh.input_face;
    result.input_order = mesh.input_order;
    measure(result, monitor);
    return result;
}

TriangleMesh in_order_of_place(const TriangleMesh& mesh, const std::vector<Eigen::Vector3d>& position,
                               Monitor& monitor) {
    double low = 0.0, high = 0.0;
    for (const auto& p : position) {
        low = std::min(low, p.z());
        high = std::max(high, p.z());
    }
    monitor.check();
    const auto slice = [&](int v) {
        return static_cast<int>((slices - 1) * ((position[v].z() - low) / std::max(high - low, 1e-300)));
    };
    // Copies of a vertex that was split lie in one place: the one with the lowest triangle goes first.
    const auto lowest = [&](int v) {
        std::array<double, 9> result{};
        for (int i = mesh.vertex_face_begin[v]; i < mesh.vertex_face_begin[v + 1]; ++i) {
            std::array<std::array<double, 3>, 3> corners;
            for (int k = 0; k < 3; ++k) {
                const auto& p = position[mesh.face[mesh.vertex_face[i]][k]];
                corners[k] = {p.z(), p.y(), p.x()};
            }
            std::sort(corners.begin(), corners.end());
            std::array<double, 9> key;
            for (int k = 0; k < 9; ++k) key[k] = corners[k / 3][k % 3];
            if (i == mesh.vertex_face_begin[v] || key < result) result = key;
        }
        return result;
    };
    const auto before = [&](int a, int b) {
        const auto &p = position[a], &q = position[b];
        if (p != q) return std::tie(p.z(), p.y(), p.x()) < std::tie(q.z(), q.y(), q.x());
        return a != b && std::pair(lowest(a), a) < std::pair(lowest(b), b);
    };
    std::vector<int> order(mesh.vertex_count());
    std::iota(order.begin(), order.end(), 0);
    order = sort_by_buckets(std::move(order), slices, slice, before, monitor);
    std::vector<int> index(mesh.vertex_count());
    TriangleMesh result;
    result.position.reserve(order.size());
    result.input_vertex.reserve(order.size());
    for (std::size_t v = 0; v < order.size(); ++v) {
        if (v % often == 0) monitor.check();
        index[order[v]] = static_cast<int>(v);
        result.position.push_back(position[order[v]]);
        result.input_vertex.push_back(mesh.input_vertex[order[v]]);
    }
    monitor.check();
    // Every triangle from its lowest vertex on.
    std::vector<std::array<int, 3>> face;
    fill_watched(face, mesh.face.size(), monitor);
    std::vector<int> first(mesh.face_count());
    for (int f = 0; f < mesh.face_count(); ++f) {
        if (f % often == 0) monitor.check();
        for (int k = 0; k < 3; ++k) face[f][k] = index[mesh.face[f][k]];
        first[f] = static_cast<int>(std::min_element(face[f].begin(), face[f].end()) - face[f].begin());
        std::rotate(face[f].begin(), face[f].begin() + first[f], face[f].end());
    }
    order.resize(mesh.face_count());
    std::iota(order.begin(), order.end(), 0);
    order = sort_by_buckets(
        std::move(order), mesh.vertex_count(), [&](int f) { return face[f][0]; },
        [&](int a, int b) { return std::tie(face[a], a) < std::tie(face[b], b); }, monitor);
    monitor.check();
    std::vector<int> place(mesh.face_count());
    for (std::size_t f = 0; f < order.size(); ++f) place[order[f]] = static_cast<int>(f);
    const auto halfedge = [&](int h) { return 3 * place[h / 3] + (h % 3 + 3 - first[h / 3]) % 3; };
    fill_watched(result.twin, mesh.twin.size(), monitor);
    result.face.reserve(order.size());
    result.input_face.reserve(order.size());
    result.input_order.reserve(order.size());
    for (std::size_t f = 0; f < order.size(); ++f) {
        const int old = order[f];
        if (f % often == 0) monitor.check();
        result.face.push_back(face[old]);
        result.input_face.push_back(mesh.input_face[old]);
        result.input_order.push_back(
            static_cast<char>(mesh.input_corner(old, first[old]) + (mesh.input_order[old] < 3 ? 0 : 3)));
        for (int k = 0; k < 3; ++k) {
            const int twin = mesh.twin[3 * old + k];
            result.twin[halfedge(3 * old + k)] = twin < 0 ? -1 : halfedge(twin);
        }
    }
    collect_fans(result, monitor);
    measure(result, monitor);
    label_components(result, monitor);
    return result;
}

TriangleMesh scaled(const TriangleMesh& mesh, double factor) {
    TriangleMesh result = mesh;
    for (auto& p : result.position) p *= factor;
    for (auto& c : result.corner) {
        for (auto& z : c) z *= factor;
    }
    for (auto& a : result.vertex_area) a *= factor * factor;
    result.area *= factor * factor;
    for (HalfedgeView& view : result.view) {
        view.apex *= factor;
        view.length *= factor;
    }
    result.mean_edge *= factor;
    return result;
}

}  // namespace isograft
