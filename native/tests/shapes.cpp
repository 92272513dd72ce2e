// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>

#include "base/random.h"

namespace isograft::shapes {

namespace {

Shape shape_of(const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces) {
    Shape shape{Points(vertices.size(), 3), Triangles(faces.size(), 3)};
    for (std::size_t v = 0; v < vertices.size(); ++v) shape.vertices.row(v) = vertices[v].transpose();
    for (std::size_t f = 0; f < faces.size(); ++f) shape.faces.row(f) << faces[f][0], faces[f][1], faces[f][2];
    return shape;
}

// Two triangles per cell of rows by columns; `wrap` joins the last column to the first.
void add_cells(std::vector<std::array<int, 3>>& faces, int rows, int columns, int stride, int first, bool wrap_columns,
               bool wrap_rows = false) {
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const int next_i = wrap_columns ? (i + 1) % columns : i + 1;
            const int next_j = wrap_rows ? (j + 1) % rows : j + 1;
            const int a = first + j * stride + i;
            const int b = first + j * stride + next_i;
            const int c = first + next_j * stride + next_i;
            const int d = first + next_j * stride + i;
            faces.push_back({a, b, c});
            faces.push_back({a, c, d});
        }
    }
}

}  // namespace

Shape grid(int nx, int ny, double dx, double dy, double shear) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 3>> faces;
    for (int j = 0; j <= ny; ++j) {
        for (int i = 0; i <= nx; ++i) vertices.emplace_back(i * dx + shear * j * dy, j * dy, 0.0);
    }
    add_cells(faces, ny, nx, nx + 1, 0, false);
    return shape_of(vertices, faces);
}

Shape sphere(int levels, double radius) {
    const double g = 0.5 * (1.0 + std::sqrt(5.0));
    std::vector<Eigen::Vector3d> vertices{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                          {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<int, 3>> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                          {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                          {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                          {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (auto& v : vertices) v *= radius / v.norm();
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<int, int>, int> middle;
        const auto between = [&](int a, int b) {
            const auto [found, added] = middle.try_emplace(std::minmax(a, b), static_cast<int>(vertices.size()));
            if (added) vertices.push_back(radius * (vertices[a] + vertices[b]).normalized());
            return found->second;
        };
        std::vector<std::array<int, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const int ab = between(a, b), bc = between(b, c), ca = between(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    return shape_of(vertices, faces);
}

Shape cylinder(int around, int along, double radius, double height) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 3>> faces;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i < around; ++i) {
            const double a = 2.0 * M_PI * i / around;
            vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), height * j / along);
        }
    }
    add_cells(faces, along, around, around, 0, true);
    return shape_of(vertices, faces);
}

Shape cone(int around, int along, double angle) {
    // The chord of a flat sector at slant radius 1 is also the chord of the ring in space.
    const double chord = 2.0 * std::sin(0.5 * angle / around);
    const double ring = 0.5 * chord / std::sin(M_PI / around);
    const double drop = std::sqrt(1.0 - ring * ring);
    std::vector<Eigen::Vector3d> vertices{{0.0, 0.0, 0.0}};
    std::vector<std::array<int, 3>> faces;
    for (int j = 1; j <= along; ++j) {
        for (int i = 0; i < around; ++i) {
            const double a = 2.0 * M_PI * i / around;
            const double s = static_cast<double>(j) / along;
            vertices.emplace_back(s * ring * std::cos(a), s * ring * std::sin(a), -s * drop);
        }
    }
    for (int i = 0; i < around; ++i) faces.push_back({0, 1 + i, 1 + (i + 1) % around});
    const auto inner = faces.size();
    add_cells(faces, along - 1, around, around, 1, true);
    // Rings run outward here, downward in space: the other winding has its normals outside.
    for (std::size_t f = inner; f < faces.size(); ++f) std::swap(faces[f][1], faces[f][2]);
    return shape_of(vertices, faces);
}

Shape torus(int around, int across, double radius, double tube) {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 3>> faces;
    for (int j = 0; j < across; ++j) {
        for (int i = 0; i < around; ++i) {
            const double u = 2.0 * M_PI * i / around, v = 2.0 * M_PI * j / across;
            const double r = radius + tube * std::cos(v);
            vertices.emplace_back(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
        }
    }
    add_cells(faces, across, around, around, 0, true, true);
    return shape_of(vertices, faces);
}

Shape blob(int levels) {
    Shape shape = sphere(levels);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        const Eigen::Vector3d p = shape.vertices.row(v);
        const double bump = 0.16 * std::sin(2.0 * p.x() + 0.4) + 0.12 * std::sin(3.0 * p.y() - 1.0 + p.x()) +
                            0.10 * std::cos(4.0 * p.z() + 2.0 * p.x() + 0.7) +
                            0.07 * std::sin(5.0 * p.y() * p.z() + 2.0);
        shape.vertices.row(v) = (1.0 + bump) * Eigen::Vector3d(p.x(), 0.8 * p.y(), 1.25 * p.z()).transpose();
    }
    return shape;
}

Eigen::Matrix3d some_rotation() {
    return Eigen::AngleAxisd(2.2, Eigen::Vector3d(0.3, -0.7, 0.9).normalized()).toRotationMatrix();
}

Shape bumped() {
    Shape shape = blob(4);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        const Eigen::Vector3d p = shape.vertices.row(v);
        shape.vertices.row(v) *= 1.0 + 0.012 * std::sin(7.0 * p.x() + 1.0) * std::cos(6.0 * p.z());
    }
    return shape;
}

Shape moved(const Shape& shape, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& shift, double scale) {
    Shape result = shape;
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        result.vertices.row(v) = (scale * (rotation * shape.vertices.row(v).transpose()) + shift).transpose();
    }
    return result;
}

Renumbered renumbered(const Shape& shape, std::uint64_t seed) {
    Random random(seed);
    Renumbered result{shape, std::vector<int>(shape.vertices.rows()), std::vector<int>(shape.faces.rows()),
                      std::vector<int>(shape.faces.rows())};
    std::iota(result.vertex.begin(), result.vertex.end(), 0);
    std::iota(result.face.begin(), result.face.end(), 0);
    random.shuffle(result.vertex);
    random.shuffle(result.face);
    for (int& k : result.first_corner) k = random.below(3);
    for (Eigen::Index v = 0; v < shape.vertices.rows(); ++v) {
        result.shape.vertices.row(result.vertex[v]) = shape.vertices.row(v);
    }
    for (Eigen::Index f = 0; f < shape.faces.rows(); ++f) {
        for (int k = 0; k < 3; ++k) {
            result.shape.faces(result.face[f], k) = result.vertex[shape.faces(f, (k + result.first_corner[f]) % 3)];
        }
    }
    return result;
}

SurfacePoint same_point(const Renumbered& renumbered, const SurfacePoint& point) {
    SurfacePoint result;
    result.face = renumbered.face[point.face];
    for (int k = 0; k < 3; ++k) result.weight[k] = point.weight[(k + renumbered.first_corner[point.face]) % 3];
    return result;
}

Shape noisy(const Shape& shape, double amplitude, std::uint64_t seed) {
    Random random(seed);
    Shape result = shape;
    for (Eigen::Index i = 0; i < result.vertices.size(); ++i) {
        result.vertices.data()[i] += amplitude * (2.0 * random.uniform() - 1.0);
    }
    return result;
}

Shape joined(const Shape& a, const Shape& b) {
    Shape result{Points(a.vertices.rows() + b.vertices.rows(), 3), Triangles(a.faces.rows() + b.faces.rows(), 3)};
    result.vertices << a.vertices, b.vertices;
    result.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.rows())).matrix();
    return result;
}

Shape soup(const Shape& shape) {
    Shape result{Points(3 * shape.faces.rows(), 3), Triangles(shape.faces.rows(), 3)};
    for (Eigen::Index i = 0; i < shape.faces.size(); ++i) {
        result.vertices.row(i) = shape.vertices.row(shape.faces.data()[i]);
        result.faces.data()[i] = static_cast<int>(i);
    }
    return result;
}

Shape reversed(const Shape& shape) {
    Shape result = shape;
    result.faces.col(1).swap(result.faces.col(2));
    return result;
}

TriangleMesh mesh_of(const Shape& shape) {
    const Surface surface = Surface::from_mesh(shape.vertices, shape.faces);
    if (!surface.warnings().empty()) throw std::logic_error("a test shape is not clean: " + surface.warnings().front());
    return surface.mesh_with_paths();
}

SurfacePoint point_nearest(const TriangleMesh& mesh, const Eigen::Vector3d& x) {
    SurfacePoint best;
    double nearest = std::numeric_limits<double>::max();
    for (int f = 0; f < mesh.face_count(); ++f) {
        const Complex q = flatten(mesh, f, x - mesh.position[mesh.face[f][0]]);
        const SurfacePoint p = point_at(mesh, f, q);
        const double d = (position(mesh, p) - x).squaredNorm();
        if (d < nearest) {
            nearest = d;
            best = p;
        }
    }
    return best;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace isograft::shapes
