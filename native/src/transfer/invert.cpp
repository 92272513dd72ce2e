// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/invert.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/closest.h"
#include "transfer/donor_view.h"
#include "transfer/neighbourhood.h"
#include "transfer/receiver_images.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
// Triangles within this many radii of a source triangle's image are looked at: surfaces bulge out of the ball.
constexpr double reach = 1.5;
// A flat triangle stays this close to the surface it spans, in its longest edge: across a right-angled ridge it is 0.5.
constexpr double farthest = 0.75;
// What lies beyond the end of the image by more than this, in the longest edge, is not covered.
constexpr double beyond = 1e-6;
// A weight below this is on the edge.
constexpr double on_edge = 1e-12;
constexpr int triangles_a_task = 256;

// For every target vertex the nearest source triangle so far, whether it covers the vertex or ends before it. The order
// is total, so the result does not depend on who found what first.
struct Nearest {
    explicit Nearest(Eigen::Index count) : distance(count, infinity), face(count, -1) {}

    void offer(int v, double d, int f) {
        if (d > distance[v] || (d == distance[v] && face[v] >= 0 && face[v] <= f)) return;
        distance[v] = d;
        face[v] = f;
    }

    std::vector<double> distance;
    std::vector<int> face;
};

Points vertex_normals(const DonorView& target) {
    Points normals = Points::Zero(target.vertices.rows(), 3);
    for (int f = 0; f < target.faces.rows(); ++f) {
        for (int c = 0; c < 3; ++c) normals.row(target.faces(f, c)) += target.normal.row(f);
    }
    return normals;
}

class Inverter {
  public:
    Inverter(const DonorView& target, const ReceiverImages& source)
        : target_(target), source_(source), normal_(vertex_normals(target)) {
        find_borders();
    }

    // Offer source triangle f to the target's vertices under its image.
    void visit(int f, Neighbourhood& around, Nearest& nearest) const {
        if (!usable(f)) return;
        const Image* corner[3] = {&source_.corner(f, 0), &source_.corner(f, 1), &source_.corner(f, 2)};
        const Vector3d centre = (corner[0]->point + corner[1]->point + corner[2]->point) / 3.0;
        double radius = 0.0;
        Vector3d facing = Vector3d::Zero();
        int seeds[3];
        for (int c = 0; c < 3; ++c) {
            radius = std::max(radius, (corner[c]->point - centre).norm());
            facing += target_.normal.row(corner[c]->face).transpose();
            seeds[c] = corner[c]->face;
        }
        for (const int g : around.gather(seeds, 3, centre, reach * radius + target_.same_point)) {
            for (int c = 0; c < 3; ++c) {
                const int v = target_.faces(g, c);
                if (normal_.row(v).dot(facing) < 0.0) continue;
                nearest.offer(v, offset(f, v, weights(f, v)).norm(), f);
            }
        }
    }

    [[nodiscard]] Vector3d weights(int f, int v) const {
        return closest_weights(target_.vertices.row(v).transpose(), source_.corner(f, 0).point,
                               source_.corner(f, 1).point, source_.corner(f, 2).point);
    }

    // False where the image of the source ends at f before it comes to target vertex v.
    [[nodiscard]] bool covers(int f, int v) const {
        const Vector3d w = weights(f, v);
        const Vector3d off = offset(f, v, w);
        const double extent = source_.extent[f];
        const double end = beyond * extent + target_.same_point;
        if (off.norm() <= end) return true;
        if (off.norm() > farthest * extent) return false;
        for (int c = 0; c < 3; ++c) {
            if (w[c] >= 1.0 - on_edge && rim_[source_.receiver.faces(f, c)] != 0) return false;
            // The edge across from corner (c + 2) % 3.
            if (w[(c + 2) % 3] > on_edge || border_[3 * f + c] == 0) continue;
            const Vector3d a = source_.corner(f, c).point, b = source_.corner(f, (c + 1) % 3).point;
            const Vector3d inward = source_.corner(f, (c + 2) % 3).point - a;
            const Vector3d along = (b - a).stableNormalized();
            const Vector3d out = (inward.dot(along) * along - inward).stableNormalized();
            if (off.dot(out) > end) return false;
        }
        return true;
    }

  private:
    [[nodiscard]] bool usable(int f) const { return source_.extent[f] < infinity; }

    // From the point of the image of f to target vertex v.
    [[nodiscard]] Vector3d offset(int f, int v, const Vector3d& w) const {
        return target_.vertices.row(v).transpose() - w[0] * source_.corner(f, 0).point -
               w[1] * source_.corner(f, 1).point - w[2] * source_.corner(f, 2).point;
    }

    // Edges of usable triangles with no other usable triangle on them.
    void find_borders() {
        const Triangles& faces = source_.receiver.faces;
        const SeamGraph graph = build_seam_graph(weld(source_.receiver.vertices, faces), no_corner_values(faces), 0.0);
        border_.assign(3 * faces.rows(), 1);
        for (int h = 0; h < static_cast<int>(border_.size()); ++h) {
            for (int g = graph.next[h]; g != h; g = graph.next[g]) {
                if (usable(g / 3)) border_[h] = 0;
            }
        }
        rim_.assign(source_.receiver.vertices.rows(), 0);
        for (int h = 0; h < static_cast<int>(border_.size()); ++h) {
            if (border_[h] == 0 || !usable(h / 3)) continue;
            rim_[faces(h / 3, h % 3)] = 1;
            rim_[faces(h / 3, (h + 1) % 3)] = 1;
        }
    }

    const DonorView& target_;
    const ReceiverImages& source_;
    Points normal_;
    // Per half-edge and per vertex: at the end of the image.
    std::vector<char> border_, rim_;
};

void check_has_triangles(const Correspondence& correspondence) {
    const auto lone = [&](Eigen::Index i) { return correspondence.face[i] < 0 && correspondence.vertex[i] >= 0; };
    Eigen::Index count = 0;
    for (Eigen::Index i = 0; i < correspondence.face.rows(); ++i) count += lone(i) ? 1 : 0;
    if (count == 0) return;
    throw InvalidInput("the correspondence leads to vertices without a triangle in " + std::to_string(count) +
                       " rows (a point cloud): only a map to a mesh can be inverted");
}

Correspondence unmatched(Eigen::Index count) {
    Correspondence inverse;
    inverse.face = Eigen::VectorXi::Constant(count, -1);
    inverse.barycentric = Points::Constant(count, 3, not_a_number);
    inverse.points = inverse.barycentric;
    inverse.vertex = inverse.face;
    inverse.confidence = Eigen::VectorXd::Zero(count);
    inverse.stretch = Eigen::VectorXd::Constant(count, not_a_number);
    inverse.region = inverse.face;
    return inverse;
}

void fill_row(Correspondence& inverse, int v, int f, const Vector3d& w, const Correspondence& forward,
              const ReceiverMesh& source) {
    const Eigen::RowVector3i corner = source.faces.row(f);
    int heaviest = 0;
    w.maxCoeff(&heaviest);
    inverse.face[v] = f;
    inverse.barycentric.row(v) = w.transpose();
    inverse.points.row(v).setZero();
    double confidence = 1.0, stretch = 0.0;
    for (int c = 0; c < 3; ++c) {
        inverse.points.row(v) += w[c] * source.vertices.row(corner[c]);
        if (forward.confidence.rows() > 0) confidence = std::min(confidence, forward.confidence[corner[c]]);
        if (forward.stretch.rows() > 0) stretch += w[c] * forward.stretch[corner[c]];
    }
    inverse.vertex[v] = corner[heaviest];
    inverse.confidence[v] = confidence;
    inverse.stretch[v] = stretch;
    inverse.region[v] = forward.region.rows() > 0 ? forward.region[corner[heaviest]] : 0;
}

}  // namespace

Correspondence invert(const Correspondence& correspondence, const ReceiverMesh& source, const DonorMesh& target,
                      int threads, Monitor* monitor) {
    const Eigen::VectorXi no_polygons;
    const ReceiverMesh alone{source.vertices, source.faces, no_polygons};
    const CornerValues no_values = no_corner_values(target.faces);
    check_placement(correspondence, alone, target, no_values);
    check_has_triangles(correspondence);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();
    const DonorView view(target, no_values, 0.0);
    const ReceiverImages images(correspondence, alone, view);
    const Inverter inverter(view, images);

    const int count = static_cast<int>(source.faces.rows());
    const int tasks = (count + triangles_a_task - 1) / triangles_a_task;
    std::vector<std::unique_ptr<Neighbourhood>> around(worker_count(threads));
    std::vector<std::unique_ptr<Nearest>> nearest(around.size());
    const auto task = [&](int index, int worker) {
        if (!around[worker]) {
            around[worker] = std::make_unique<Neighbourhood>(view);
            nearest[worker] = std::make_unique<Nearest>(target.vertices.rows());
        }
        const int end = std::min(count, (index + 1) * triangles_a_task);
        for (int f = index * triangles_a_task; f < end; ++f) inverter.visit(f, *around[worker], *nearest[worker]);
    };
    parallel_for(tasks, threads, task, watched, "invert", 0.0, 1.0);

    Correspondence inverse = unmatched(target.vertices.rows());
    for (int v = 0; v < target.vertices.rows(); ++v) {
        Nearest best(1);
        for (const auto& found : nearest) {
            if (found && found->face[v] >= 0) best.offer(0, found->distance[v], found->face[v]);
        }
        const int face = best.face[0];
        if (face < 0 || !inverter.covers(face, v)) continue;
        fill_row(inverse, v, face, inverter.weights(face, v), correspondence, source);
    }
    return inverse;
}

}  // namespace isograft
