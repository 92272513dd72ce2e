// SPDX-License-Identifier: GPL-3.0-or-later
#include "gate.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "isograft/errors.h"
#include "surface/clean.h"

namespace isograft {

Surface gate(const shapes::Shape& shape) { return Surface::from_mesh(shape.vertices, shape.faces); }

bool warns(const Surface& surface, const std::string& text) {
    const auto& w = surface.warnings();
    return std::any_of(w.begin(), w.end(), [&](const std::string& s) { return s.find(text) != std::string::npos; });
}

std::string refusal(const shapes::Shape& shape) {
    try {
        gate(shape);
    } catch (const InvalidInput& e) {
        return e.what();
    }
    return "";
}

double volume(const TriangleMesh& mesh) {
    double sum = 0.0;
    for (const auto& [a, b, c] : mesh.face) {
        sum += mesh.position[a].dot(mesh.position[b].cross(mesh.position[c])) / 6.0;
    }
    return sum;
}

void expect_manifold(const TriangleMesh& mesh) {
    for (int h = 0; h < 3 * mesh.face_count(); ++h) {
        const int g = mesh.twin[h];
        if (g < 0) continue;
        EXPECT_EQ(mesh.twin[g], h);
        EXPECT_EQ(mesh.from(g), mesh.to(h));
        EXPECT_EQ(mesh.to(g), mesh.from(h));
    }
    for (int v = 0; v < mesh.vertex_count(); ++v) {
        const int begin = mesh.vertex_face_begin[v], end = mesh.vertex_face_begin[v + 1];
        ASSERT_GT(end, begin);
        int fan = 1;
        const auto out = [&](int f) {
            return 3 * f +
                   static_cast<int>(std::find(mesh.face[f].begin(), mesh.face[f].end(), v) - mesh.face[f].begin());
        };
        const int first = out(mesh.vertex_face[begin]);
        int h = first;
        for (int g; (g = mesh.twin[h / 3 * 3 + (h % 3 + 2) % 3]) >= 0 && g != first; h = g) ++fan;
        if (mesh.twin[h / 3 * 3 + (h % 3 + 2) % 3] < 0) {
            for (h = first; mesh.twin[h] >= 0; ++fan) h = mesh.twin[h] / 3 * 3 + (mesh.twin[h] % 3 + 1) % 3;
        }
        EXPECT_EQ(fan, end - begin) << "vertex " << v << " has triangles outside its fan";
    }
}

void expect_indexed_by_input(const Surface& surface) {
    const TriangleMesh& mesh = surface.mesh();
    const auto working = working_vertices(surface);
    ASSERT_EQ(working.size(), static_cast<std::size_t>(surface.vertices().rows()));
    for (int f = 0; f < mesh.face_count(); ++f) {
        for (int k = 0; k < 3; ++k) {
            const int v = surface.faces()(mesh.input_face[f], mesh.input_corner(f, k));
            EXPECT_EQ(mesh.position[mesh.face[f][k]], surface.vertices().row(v).transpose());
            ASSERT_GE(working[v], 0);
            EXPECT_EQ(mesh.position[working[v]], surface.vertices().row(v).transpose());
        }
    }
}

}  // namespace isograft
