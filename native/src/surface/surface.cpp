// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/surface.h"

#include <cmath>
#include <mutex>
#include <utility>

#include "base/piece.h"
#include "isograft/monitor.h"
#include "surface/clean.h"
#include "surface/cloud.h"
#include "surface/denoise.h"
#include "surface/holes.h"
#include "surface/mesh.h"
#include "surface/orient.h"
#include "surface/own_frame.h"

namespace isograft {

namespace {

// Smaller open parts are too little to be worth trying both ways.
constexpr double ambiguous_share = 0.05;
// An open part that bulges outward by this much of its area to the power of 3/2 (a sphere: 0.094) shows its outer side.
constexpr double clear_bulge = 0.01;

// The repaired triangles by the indices they had before vertices were split: cut edges show there as what they are.
std::vector<Corners> input_corners(const TriangleMesh& mesh) {
    std::vector<Corners> face = mesh.face;
    for (auto& f : face) {
        for (int& v : f) v = mesh.input_vertex[v];
    }
    return face;
}

int split_vertices(const TriangleMesh& mesh) {
    // Copies of a vertex follow each other.
    int split = 0;
    for (int v = 1; v < mesh.vertex_count(); ++v) {
        const bool copy = mesh.input_vertex[v] == mesh.input_vertex[v - 1];
        const bool second = v < 2 || mesh.input_vertex[v - 1] != mesh.input_vertex[v - 2];
        split += copy && second;
    }
    return split;
}

}  // namespace

Surface Surface::from_mesh(Points vertices, Triangles faces, Monitor* monitor, double share) {
    Monitor silent;
    Monitor& watcher = monitor != nullptr ? *monitor : silent;
    Piece progress(watcher, share);
    progress.check();
    check_arrays(vertices, faces);
    Surface surface;
    Soup soup = clean(vertices, faces, progress.until(0.35));
    orient(soup, progress.until(0.55));
    TriangleMesh mesh = build_mesh(soup.position, soup.face, soup.input_face, soup.input_order, progress.until(0.9));
    surface.warnings_ = std::move(soup.warnings);
    warn(surface.warnings_, split_vertices(mesh), "vertex was split where the surface touches itself.",
         "vertices were split where the surface touches itself.");
    for (const ComponentSide& side :
         component_sides(soup.position, input_corners(mesh), mesh.component, mesh.component_count, watcher)) {
        const bool clear = side.closed || side.bulge > clear_bulge * std::pow(side.area, 1.5);
        surface.ambiguous_ = surface.ambiguous_ || (!clear && side.area > ambiguous_share * mesh.area);
        surface.closed_ = surface.closed_ && (side.closed || side.area < ambiguous_share * mesh.area);
    }
    surface.vertices_ = std::make_shared<Points>(std::move(vertices));
    surface.faces_ = std::make_shared<Triangles>(std::move(faces));
    surface.set_mesh(std::move(mesh));
    progress.reach(1.0);
    return surface;
}

Surface Surface::from_points(Points vertices, const Points& normals, Monitor* monitor, double share) {
    Monitor silent;
    Cloud cloud = make_cloud(vertices, normals, Piece(monitor != nullptr ? *monitor : silent, share));
    Surface surface;
    surface.is_cloud_ = true;
    surface.ambiguous_ = cloud.ambiguous;
    surface.warnings_ = std::move(cloud.warnings);
    surface.cloud_vertex_ = std::make_shared<std::vector<int>>(std::move(cloud.vertex));
    surface.normals_ = std::make_shared<Points>(std::move(cloud.normals));
    surface.set_mesh(std::move(cloud.mesh));
    surface.vertices_ = std::make_shared<Points>(std::move(vertices));
    return surface;
}

// Copies of a surface share it.
struct Surface::Paths {
    std::once_flag measured;
    TriangleMesh mesh;
};

void Surface::set_mesh(TriangleMesh mesh) {
    mesh_ = std::make_shared<TriangleMesh>(std::move(mesh));
    paths_ = std::make_shared<Paths>();
}

const TriangleMesh& Surface::mesh_with_paths() const {
    std::call_once(paths_->measured, [&] {
        Monitor silent;
        paths_->mesh = *mesh_;
        measure_paths(paths_->mesh, silent);
    });
    return paths_->mesh;
}

Surface Surface::with_open_parts_reversed(Monitor* monitor) const {
    Monitor silent;
    Monitor& watcher = monitor != nullptr ? *monitor : silent;
    if (is_cloud_) return reversed_cloud();
    std::vector<Eigen::Vector3d> position(vertices_->rows());
    for (Eigen::Index v = 0; v < vertices_->rows(); ++v) position[v] = vertices_->row(v);
    // The mesh may be smoother than what was given.
    for (int v = 0; v < mesh_->vertex_count(); ++v) position[mesh_->input_vertex[v]] = mesh_->position[v];
    std::vector<Corners> face = input_corners(*mesh_);
    std::vector<char> order = mesh_->input_order;
    const std::vector<ComponentSide> sides =
        component_sides(position, face, mesh_->component, mesh_->component_count, watcher);
    for (int f = 0; f < mesh_->face_count(); ++f) {
        if (sides[mesh_->component[f]].closed) continue;
        std::swap(face[f][1], face[f][2]);
        order[f] = reversed_order(order[f]);
    }
    Surface surface = *this;
    surface.set_mesh(build_mesh(position, face, mesh_->input_face, order, Piece(watcher, 0.0)));
    return surface;
}

Surface Surface::denoised(double support, Monitor& monitor) const {
    Surface surface = *this;
    if (!is_cloud_) surface.set_mesh(isograft::denoised(*mesh_, support, monitor));
    return surface;
}

Surface Surface::in_own_frame(Monitor& monitor) const {
    Surface surface = *this;
    // The mesh over a cloud hangs on how it lay, and results are points of it.
    if (is_cloud_) return surface;
    surface.set_mesh(isograft::in_own_frame(*mesh_, monitor));
    return surface;
}

Surface Surface::with_holes_closed(double longest, Monitor& monitor) const {
    Surface surface = *this;
    if (is_cloud_ || longest == 0.0) return surface;
    if (auto closed = isograft::with_holes_closed(*mesh_, longest, monitor)) {
        surface.set_mesh(std::move(*closed));
    }
    return surface;
}

std::pair<Points, Triangles> Surface::working_mesh() const {
    std::pair<Points, Triangles> arrays{Points(mesh_->vertex_count(), 3), Triangles(mesh_->face_count(), 3)};
    for (int v = 0; v < mesh_->vertex_count(); ++v) arrays.first.row(v) = mesh_->position[v];
    for (int f = 0; f < mesh_->face_count(); ++f) {
        for (int k = 0; k < 3; ++k) arrays.second(f, k) = mesh_->face[f][k];
    }
    return arrays;
}

// Small holes and gaps make nearly every part of a cloud an open one, so all are turned.
Surface Surface::reversed_cloud() const {
    std::vector<Corners> face = mesh_->face;
    for (Corners& f : face) std::swap(f[1], f[2]);
    Surface surface = *this;
    surface.set_mesh(build_mesh(mesh_->position, face, mesh_->input_face, mesh_->input_order));
    surface.normals_ = std::make_shared<Points>(-*normals_);
    return surface;
}

}  // namespace isograft
