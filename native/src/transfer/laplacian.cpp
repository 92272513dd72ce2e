// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/laplacian.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double least_weight = 1e-3;
constexpr double largest_weight = 1e3;
// Share of the mean area that a vertex has at least.
constexpr double least_area = 1e-6;
// Height of a triangle over its longest edge.
constexpr double least_height = 1e-3;

// Vertices at the two ends of an edge, and that at the corner across it.
struct Corner {
    int i, j, k;
};

std::pair<Vector3d, Vector3d> edges_at(const Points& vertices, const Corner& corner) {
    return {(vertices.row(corner.i) - vertices.row(corner.k)).transpose(),
            (vertices.row(corner.j) - vertices.row(corner.k)).transpose()};
}

// \param weight of the edge across a corner.
template <class Weight>
Eigen::SparseMatrix<double> assemble(const Triangles& faces, Eigen::Index vertex_count, const Weight& weight) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * static_cast<std::size_t>(faces.rows()));
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) {
            const int i = faces(f, (c + 1) % 3), j = faces(f, (c + 2) % 3);
            if (i == j) continue;
            const double value = weight(Corner{i, j, faces(f, c)});
            entries.emplace_back(i, j, -value);
            entries.emplace_back(j, i, -value);
            entries.emplace_back(i, i, value);
            entries.emplace_back(j, j, value);
        }
    }
    Eigen::SparseMatrix<double> matrix(vertex_count, vertex_count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

}  // namespace

Eigen::SparseMatrix<double> laplacian(const Points& vertices, const Triangles& faces) {
    return assemble(faces, vertices.rows(), [&](const Corner& corner) {
        const auto [a, b] = edges_at(vertices, corner);
        const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
        const double sine = std::max(a.cross(b).norm(), least_height * longest);
        return 0.5 * (sine > 0.0 ? a.dot(b) / sine : 1.0);
    });
}

Eigen::SparseMatrix<double> positive_laplacian(const Points& vertices, const Triangles& faces) {
    return assemble(faces, vertices.rows(), [&](const Corner& corner) {
        const auto [a, b] = edges_at(vertices, corner);
        const double sine = a.cross(b).norm();
        const double cotangent = sine > 0.0 ? a.dot(b) / sine : largest_weight;
        return std::clamp(0.5 * cotangent, least_weight, largest_weight);
    });
}

Eigen::VectorXd vertex_areas(const Points& vertices, const Triangles& faces) {
    Eigen::VectorXd areas = Eigen::VectorXd::Zero(vertices.rows());
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        const Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
        for (int k = 0; k < 3; ++k) areas[faces(f, k)] += (b - a).cross(c - a).norm() / 6.0;
    }
    const double mean = areas.rows() > 0 ? areas.mean() : 0.0;
    return areas.cwiseMax(mean > 0.0 ? least_area * mean : 1.0);
}

Eigen::VectorXi parts_of(const Triangles& faces, Eigen::Index vertex_count) {
    std::vector<int> parent(vertex_count);
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int c = 1; c < 3; ++c) {
            const int a = root(faces(f, 0)), b = root(faces(f, c));
            parent[std::max(a, b)] = std::min(a, b);
        }
    }
    Eigen::VectorXi part(vertex_count);
    int count = 0;
    for (int v = 0; v < vertex_count; ++v) part[v] = root(v) == v ? count++ : part[root(v)];
    return part;
}

Unknowns::Unknowns(const Triangles& faces, const Mask& known) : slot(known.rows(), -1) {
    const Eigen::VectorXi part = parts_of(faces, known.rows());
    std::vector<char> in_triangle(known.rows(), 0), has_known(known.rows(), 0);
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) in_triangle[faces(f, c)] = 1;
    }
    for (Eigen::Index v = 0; v < known.rows(); ++v) {
        if (known[v]) has_known[part[v]] = 1;
    }
    for (int v = 0; v < known.rows(); ++v) {
        if (known[v] || in_triangle[v] == 0 || has_known[part[v]] == 0) continue;
        slot[v] = static_cast<int>(vertex.size());
        vertex.push_back(v);
    }
}

Eigen::SparseMatrix<double> Unknowns::block(const Eigen::SparseMatrix<double>& matrix) const {
    std::vector<Eigen::Triplet<double>> entries;
    for (const int v : vertex) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(matrix, v); it; ++it) {
            const int row = slot[it.row()];
            if (row >= 0) entries.emplace_back(row, slot[v], it.value());
        }
    }
    Eigen::SparseMatrix<double> result(count(), count());
    result.setFromTriplets(entries.begin(), entries.end());
    return result;
}

CornerValues Unknowns::zeroed(const CornerValues& values) const {
    CornerValues result = values;
    for (const int v : vertex) result.row(v).setZero();
    return result;
}

std::vector<Eigen::Index> Unknowns::hole_sizes(const Eigen::SparseMatrix<double>& laplacian) const {
    std::vector<Eigen::Index> sizes(vertex.size(), 0);
    std::vector<int> hole;
    for (std::size_t start = 0; start < sizes.size(); ++start) {
        if (sizes[start] != 0) continue;
        sizes[start] = 1;
        hole.assign(1, static_cast<int>(start));
        for (std::size_t at = 0; at < hole.size(); ++at) {
            for (Eigen::SparseMatrix<double>::InnerIterator it(laplacian, vertex[hole[at]]); it; ++it) {
                const int other = slot[it.row()];
                if (other < 0 || sizes[other] != 0) continue;
                sizes[other] = 1;
                hole.push_back(other);
            }
        }
        for (const int i : hole) sizes[i] = static_cast<Eigen::Index>(hole.size());
    }
    return sizes;
}

std::vector<Eigen::Index> Unknowns::large_hole_sizes(const Eigen::SparseMatrix<double>& laplacian,
                                                     Eigen::Index large) const {
    if (count() <= large) return {};
    std::vector<Eigen::Index> sizes = hole_sizes(laplacian);
    if (*std::max_element(sizes.begin(), sizes.end()) <= large) sizes.clear();
    return sizes;
}

Mask Unknowns::mask() const {
    Mask result = Mask::Constant(static_cast<Eigen::Index>(slot.size()), false);
    for (const int v : vertex) result[v] = true;
    return result;
}

}  // namespace isograft
