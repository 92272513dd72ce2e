// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/relief.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "base/parallel.h"
#include "growth/rigid_step.h"

namespace isograft {

namespace {

using Eigen::Vector3d;

// Weight of the term beside the stretch. Much less lets drift stay; more hardly matters, since slides cost no stretch.
constexpr double weight_beside_stretch = 3000.0;
// Fewer say nothing.
constexpr int fewest_samples = 4, fewest_points = 12;
// A point this many widths from the target has no counterpart there.
constexpr double far_widths = 0.5;
// A distance at which a point has lost half its weight, in unit lengths.
constexpr double soft = 0.02;
// Root of the mean squared distance at which a whole piece has lost half its strength: one that bends, at a joint, fits
// no rigid motion and should yield to its neighbours.
constexpr double soft_fit = 0.002;
// Cosine between normals of one side of a thin part, and between those of the surroundings.
constexpr double same_side = 0.5, surrounding_side = -0.2;
// How far a sample is drawn at once, in spacings.
constexpr double longest_draw = 1.5;

Vector3d normal_at(const TriangleMesh& mesh, const SurfacePoint& p) {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) sum += p.weight[k] * mesh.vertex_normal[mesh.face[p.face][k]];
    const double length = sum.norm();
    return length > 1e-9 ? Vector3d(sum / length) : mesh.normal[p.face];
}

// What is left of the energy for a shift along the surface once turn and height have had theirs.
Eigen::Matrix2d strength_along(const TriangleMesh& mesh, int face, const RigidStep& step) {
    RigidStep::Matrix energy = step.mean_matrix();
    energy.diagonal().array() += rigid_damping;
    RigidStep::Matrix basis = RigidStep::Matrix::Zero();
    basis.topLeftCorner<3, 3>().setIdentity();
    basis.block<3, 1>(3, 3) = mesh.normal[face];
    basis.block<3, 1>(3, 4) = mesh.axis_x[face];
    basis.block<3, 1>(3, 5) = mesh.axis_y[face];
    energy = basis.transpose() * energy * basis;
    const Eigen::Matrix4d inner = energy.topLeftCorner<4, 4>();
    const Eigen::Matrix<double, 4, 2> mixed = energy.topRightCorner<4, 2>();
    const Eigen::Matrix2d left = energy.bottomRightCorner<2, 2>() - mixed.transpose() * inner.ldlt().solve(mixed);
    const double fit = soft_fit * soft_fit / (soft_fit * soft_fit + step.mean_square());
    return fit * (left - rigid_damping * Eigen::Matrix2d::Identity());
}

}  // namespace

Relief::Relief(const Pair& pair) : pair_(pair), owned_(vertices_of(pair.source)) {
    const Samples& source = pair.source.samples;
    sample_normal_.reserve(source.point.size());
    for (const SurfacePoint& p : source.point) sample_normal_.push_back(normal_at(pair.source.mesh, p));
}

// From vertex to vertex for as long as that leads nearer to x: the surface is smooth, and x near the start.
int Relief::descend(int vertex, const Vector3d& x) const {
    const TriangleMesh& mesh = pair_.target.mesh;
    double least = (mesh.position[vertex] - x).squaredNorm();
    for (int last = -1; last != vertex;) {
        last = vertex;
        for (int i = mesh.vertex_face_begin[last]; i < mesh.vertex_face_begin[last + 1]; ++i) {
            for (const int v : mesh.face[mesh.vertex_face[i]]) {
                const double d = (mesh.position[v] - x).squaredNorm();
                if (d >= least) continue;
                least = d;
                vertex = v;
            }
        }
    }
    return vertex;
}

Relief::Surroundings Relief::surroundings(const PartialMap& map, int sample, const ReliefScale& scale) const {
    const Samples& source = pair_.source.samples;
    const TriangleMesh& mesh = pair_.source.mesh;
    Surroundings result;
    // Over mapped samples only, so that they are one piece.
    result.samples = samples_around(source, sample, 2.0 * scale.width, [&](int other) {
        return map.mapped[other] != 0 && sample_normal_[other].dot(sample_normal_[sample]) >= surrounding_side;
    });
    const auto add = [&](const Vector3d& x, const Vector3d& n, int near) {
        result.point.push_back(x);
        result.normal.push_back(n);
        result.near.push_back(near);
        result.weight.push_back(falloff((x - source.position[sample]).squaredNorm(), scale.width));
    };
    // The samples come first; vertices follow as there is room.
    for (const int s : result.samples) {
        add(source.position[s], sample_normal_[s], nearest_corner(pair_.target.mesh, map.image[s]));
    }
    const double room = std::max(0.0, static_cast<double>(scale.points) - static_cast<double>(result.samples.size()));
    spread_vertices(owned_, result.samples, room,
                    [&](std::size_t i, int v) { add(mesh.position[v], mesh.vertex_normal[v], result.near[i]); });
    return result;
}

std::optional<SampleTerm> Relief::term(const PartialMap& map, int sample, const ReliefScale& scale) const {
    const Samples& source = pair_.source.samples;
    const TriangleMesh& mesh = pair_.target.mesh;
    Surroundings around = surroundings(map, sample, scale);
    if (around.samples.size() < fewest_samples || around.point.size() < fewest_points) return std::nullopt;
    RigidMotion motion = motion_of(map, source, around.samples, around.weight);
    const double far = far_widths * scale.width;
    RigidStep step;
    for (int k = 0; k < scale.steps; ++k) {
        const Vector3d pivot = motion(source.position[sample]);
        step = RigidStep(pivot, scale.width);
        for (std::size_t i = 0; i < around.point.size(); ++i) {
            const Vector3d x = motion(around.point[i]);
            const int near = around.near[i] = descend(around.near[i], x);
            const Vector3d& plane = mesh.vertex_normal[near];
            const Vector3d gap = mesh.position[near] - x;
            if (gap.squaredNorm() > far * far || plane.dot(motion.turn * around.normal[i]) < same_side) continue;
            const double height = gap.dot(plane);
            const double w = around.weight[i] / (1.0 + height * height / (soft * soft));
            step.add(x, plane, height, w);
        }
        if (step.points() < fewest_points || !step.apply(motion)) return std::nullopt;
    }
    const int face = map.image[sample].face;
    Complex draw = flatten(mesh, face, motion(source.position[sample]) - map.position[sample]);
    const double longest = longest_draw * source.spacing;
    if (modulus(draw) > longest) draw *= longest / modulus(draw);
    const Eigen::Matrix2d strength = strength_along(mesh, face, step);
    const Eigen::Vector2d gradient = -strength * Eigen::Vector2d(draw.real(), draw.imag());
    return SampleTerm{gradient[0], gradient[1], strength(0, 0), strength(0, 1), strength(1, 1)};
}

void Relief::relax(PartialMap& map, const GrowthOptions& options, const ReliefScale& scale, int iterations, int threads,
                   Monitor& monitor) const {
    if (iterations == 0 || map.count == 0) return;
    RelaxSettings settings;
    settings.iterations = iterations;
    settings.threads = threads;
    settings.term_weight = weight_beside_stretch;
    settings.term = [&](const PartialMap& now, std::vector<SampleTerm>& terms) {
        parallel_for(
            static_cast<int>(terms.size()), threads,
            [&](int s, int /*worker*/) {
                if (!now.mapped[s]) return;
                if (const auto known = term(now, s, scale)) terms[s] = *known;
            },
            monitor);
    };
    isograft::relax(pair_.source.samples, pair_.target.mesh, options, settings, map);
}

}  // namespace isograft
