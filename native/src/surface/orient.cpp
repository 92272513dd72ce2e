// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/orient.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "base/sorting.h"

namespace isograft {

namespace {

double twice_area(const Soup& soup, int f) {
    const auto& [a, b, c] = soup.face[f];
    return (soup.position[b] - soup.position[a]).cross(soup.position[c] - soup.position[a]).norm();
}

}  // namespace

std::vector<ComponentSide> component_sides(const std::vector<Eigen::Vector3d>& position,
                                           const std::vector<Corners>& face, const std::vector<int>& component,
                                           int count, Monitor& monitor) {
    std::vector<ComponentSide> sides(count);
    std::vector<int> origin(count, -1);
    std::vector<Eigen::Vector3d> centroid(count, Eigen::Vector3d::Zero());
    std::vector<Eigen::Vector3d> vector_area(count, Eigen::Vector3d::Zero());
    for (std::size_t f = 0; f < face.size(); ++f) {
        if (f % often == 0) monitor.check();
        ComponentSide& side = sides[component[f]];
        int& o = origin[component[f]];
        if (o < 0) o = face[f][0];
        const Eigen::Vector3d a = position[face[f][0]] - position[o];
        const Eigen::Vector3d b = position[face[f][1]] - position[o];
        const Eigen::Vector3d c = position[face[f][2]] - position[o];
        const Eigen::Vector3d normal = 0.5 * (b - a).cross(c - a);
        const double area = normal.norm();
        side.area += area;
        side.volume += a.dot(b.cross(c)) / 6.0;
        centroid[component[f]] += area * (a + b + c) / 3.0;
        vector_area[component[f]] += normal;
    }
    for (int i = 0; i < count; ++i) {
        sides[i].bulge = sides[i].volume - centroid[i].dot(vector_area[i]) / (3.0 * std::max(sides[i].area, 1e-300));
    }
    const Edges edges = collect_edges(face, monitor);
    std::vector<std::pair<int, int>> runs;
    for (const EdgeGroup& group : edges.group) {
        if (group.begin % often == 0) monitor.check();
        runs.clear();
        for (int i = group.begin; i < group.end; ++i) {
            const int h = edges.item[i].halfedge;
            runs.emplace_back(component[h / 3], face[h / 3][h % 3] == edges.item[i].low ? 1 : -1);
        }
        std::sort(runs.begin(), runs.end());
        for (std::size_t i = 0; i < runs.size();) {
            int sum = 0;
            const std::size_t begin = i;
            for (; i < runs.size() && runs[i].first == runs[begin].first; ++i) sum += runs[i].second;
            if (sum != 0) sides[runs[begin].first].closed = false;
        }
    }
    // A flat double sheet is closed, but has no inside.
    for (ComponentSide& side : sides) {
        side.closed = side.closed && std::abs(side.volume) > 1e-9 * std::pow(side.area, 1.5);
    }
    return sides;
}

void orient(Soup& soup, Piece progress) {
    Monitor& monitor = progress.monitor();
    const int count = static_cast<int>(soup.face.size());
    const Edges edges = collect_edges(soup.face, monitor);
    const auto from = [&](int h) { return soup.face[h / 3][h % 3]; };
    std::vector<int> mate(3 * count, -1);
    int crowded = 0;
    for (const EdgeGroup& group : edges.group) {
        crowded += group.end - group.begin > 2;
        if (group.end - group.begin != 2) continue;
        const int g = edges.item[group.begin].halfedge, h = edges.item[group.begin + 1].halfedge;
        mate[g] = h;
        mate[h] = g;
    }
    progress.reach(0.35);
    std::vector<int> component(count, -1), queue;
    std::vector<char> turned(count, 0);
    std::vector<std::array<double, 2>> area;
    for (int seed = 0; seed < count; ++seed) {
        if (component[seed] >= 0) continue;
        const int label = static_cast<int>(area.size());
        area.push_back({0.0, 0.0});
        component[seed] = label;
        queue.assign(1, seed);
        // First in, first out: a one-sided band is then cut far from the seed, not beside it.
        for (std::size_t i = 0; i < queue.size(); ++i) {
            if (i % often == 0) monitor.check();
            const int f = queue[i];
            area[label][turned[f]] += twice_area(soup, f);
            for (int h = 3 * f; h < 3 * f + 3; ++h) {
                if (mate[h] < 0 || component[mate[h] / 3] >= 0) continue;
                const int g = mate[h] / 3;
                component[g] = label;
                turned[g] = from(mate[h]) == from(h) ? !turned[f] : turned[f];
                queue.push_back(g);
            }
        }
    }
    progress.reach(0.6);
    int one_sided = 0;
    for (int h = 0; h < 3 * count; ++h) {
        if (mate[h] > h) one_sided += (from(h) == from(mate[h])) != (turned[h / 3] != turned[mate[h] / 3]);
    }
    int minority = 0;
    const auto turn = [&](int f) {
        std::swap(soup.face[f][1], soup.face[f][2]);
        soup.input_order[f] = reversed_order(soup.input_order[f]);
    };
    for (int f = 0; f < count; ++f) {
        const std::array<double, 2>& sides = area[component[f]];
        if (turned[f] == (sides[1] > sides[0] ? 1 : 0)) continue;
        turn(f);
        ++minority;
    }
    const int components = static_cast<int>(area.size());
    const std::vector<ComponentSide> sides = component_sides(soup.position, soup.face, component, components, monitor);
    progress.reach(1.0);
    int inside_out = 0;
    for (const ComponentSide& side : sides) inside_out += side.closed && side.volume < 0.0;
    for (int f = 0; f < count; ++f) {
        const ComponentSide& side = sides[component[f]];
        if (side.closed && side.volume < 0.0) turn(f);
    }
    warn(soup.warnings, crowded, "edge of more than two triangles was cut open.",
         "edges of more than two triangles were cut open.");
    warn(soup.warnings, minority, "triangle was turned over to agree with its neighbours' winding.",
         "triangles were turned over to agree with their neighbours' winding.");
    warn(soup.warnings, one_sided, "edge was cut because the surface has only one side there.",
         "edges were cut because the surface has only one side there.");
    warn(soup.warnings, inside_out, "closed component was inside out and turned outward.",
         "closed components were inside out and turned outward.");
}

}  // namespace isograft
