// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/donor_view.h"

#include <algorithm>

#include <Eigen/Geometry>

#include "transfer/closest.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

// Turn normals so that neighbours across edges of two triangles are wound alike.
void unify(Points& normal, const Triangles& faces, const std::vector<int>& next) {
    std::vector<signed char> sign(faces.rows(), 0);
    std::vector<int> front;
    for (int first = 0; first < faces.rows(); ++first) {
        if (sign[first] != 0) continue;
        sign[first] = 1;
        front.assign(1, first);
        while (!front.empty()) {
            const int f = front.back();
            front.pop_back();
            for (int h = 3 * f; h < 3 * f + 3; ++h) {
                const int g = next[h];
                if (g == h || next[g] != h || sign[g / 3] != 0) continue;
                const bool alike = faces(f, h % 3) != faces(g / 3, g % 3);
                sign[g / 3] = static_cast<signed char>(alike ? sign[f] : -sign[f]);
                front.push_back(g / 3);
            }
        }
    }
    for (int f = 0; f < faces.rows(); ++f) normal.row(f) *= sign[f];
}

}  // namespace

DonorView::DonorView(const DonorMesh& donor, const CornerValues& corner_values, double same_value)
    : vertices(donor.vertices), faces(donor.faces), values(corner_values), tolerance(same_value) {
    const Triangles welded = weld(vertices, faces);
    graph = build_seam_graph(welded, values, tolerance);
    normal.resize(faces.rows(), 3);
    longest_edge.resize(faces.rows());
    for (int f = 0; f < faces.rows(); ++f) {
        const Vector3d a = corner(f, 0), b = corner(f, 1), c = corner(f, 2);
        normal.row(f) = (b - a).cross(c - a).stableNormalized().transpose();
        area += 0.5 * (b - a).cross(c - a).norm();
        longest_edge[f] = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    }
    unify(normal, welded, graph.next);
    same_point =
        vertices.rows() > 0 ? 1e-9 * (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).norm() : 0.0;
}

Vector3d DonorView::closest(int f, const Vector3d& p) const {
    return closest_weights(p, corner(f, 0), corner(f, 1), corner(f, 2));
}

Eigen::RowVectorXd DonorView::value(int f, const Vector3d& weights) const {
    return weights.transpose() * values.middleRows(3 * f, 3);
}

std::vector<Image> images_of(const Correspondence& correspondence, const DonorView& donor) {
    std::vector<Image> images(correspondence.face.rows());
    for (int v = 0; v < correspondence.face.rows(); ++v) {
        Image& image = images[v];
        image.face = correspondence.face[v];
        if (image.face < 0) continue;
        image.weights = correspondence.barycentric.row(v).transpose().cwiseMax(0.0);
        image.weights /= image.weights.sum();
        image.point = donor.point(image.face, image.weights);
    }
    return images;
}

}  // namespace isograft
