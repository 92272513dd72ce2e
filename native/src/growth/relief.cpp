// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/relief.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/rotation.h"

namespace isograft {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

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
// Strength of staying where it is, per unit weight.
constexpr double damping = 1e-2;
// A registration that turns farther in one step has lost its way.
constexpr double most_turn = 0.5;
// How far a sample is drawn at once, in spacings.
constexpr double longest_draw = 1.5;

struct Motion {
    Matrix3d turn;
    Vector3d shift;

    [[nodiscard]] Vector3d operator()(const Vector3d& x) const { return turn * x + shift; }
    void then(const Matrix3d& by, const Vector3d& pivot, const Vector3d& step) {
        turn = by * turn;
        shift = by * (shift - pivot) + pivot + step;
    }
};

/// Normal equations of a rigid step: three angles, in units that move a point one width away by one unit length, and
/// three shifts.
struct RigidStep {
    Matrix6d matrix = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    double weight = 0.0, squares = 0.0;
    int points = 0;
};

Vector3d normal_at(const TriangleMesh& mesh, const SurfacePoint& p) {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) sum += p.weight[k] * mesh.vertex_normal[mesh.face[p.face][k]];
    const double length = sum.norm();
    return length > 1e-9 ? Vector3d(sum / length) : mesh.normal[p.face];
}

double falloff(double squared_distance, double width) { return std::exp(-0.5 * squared_distance / (width * width)); }

// The rigid motion nearest to the map.
Motion motion_of(const PartialMap& map, const Samples& source, const std::vector<int>& samples,
                 const std::vector<double>& weight) {
    Vector3d from = Vector3d::Zero(), onto = Vector3d::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        from += weight[i] * source.position[samples[i]];
        onto += weight[i] * map.position[samples[i]];
        total += weight[i];
    }
    from /= total;
    onto /= total;
    Matrix3d product = Matrix3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        product += weight[i] * (source.position[samples[i]] - from) * (map.position[samples[i]] - onto).transpose();
    }
    const Matrix3d turn = rotation_of(product);
    return {turn, onto - turn * from};
}

// What is left of the energy for a shift along the surface once turn and height have had theirs.
Eigen::Matrix2d strength_along(const TriangleMesh& mesh, int face, const RigidStep& step) {
    Matrix6d energy = step.matrix / step.weight;
    energy.diagonal().array() += damping;
    Matrix6d basis = Matrix6d::Zero();
    basis.topLeftCorner<3, 3>().setIdentity();
    basis.block<3, 1>(3, 3) = mesh.normal[face];
    basis.block<3, 1>(3, 4) = mesh.axis_x[face];
    basis.block<3, 1>(3, 5) = mesh.axis_y[face];
    energy = basis.transpose() * energy * basis;
    const Eigen::Matrix4d inner = energy.topLeftCorner<4, 4>();
    const Eigen::Matrix<double, 4, 2> mixed = energy.topRightCorner<4, 2>();
    const Eigen::Matrix2d left = energy.bottomRightCorner<2, 2>() - mixed.transpose() * inner.ldlt().solve(mixed);
    const double fit = soft_fit * soft_fit / (soft_fit * soft_fit + step.squares / step.weight);
    return fit * (left - damping * Eigen::Matrix2d::Identity());
}

}  // namespace

Relief::Relief(const Pair& pair) : pair_(pair), owned_(pair.source.samples.count()) {
    const Samples& source = pair.source.samples;
    sample_normal_.reserve(source.point.size());
    for (const SurfacePoint& p : source.point) sample_normal_.push_back(normal_at(pair.source.mesh, p));
    for (int v = 0; v < pair.source.mesh.vertex_count(); ++v) {
        if (source.owner[v] >= 0) owned_[source.owner[v]].push_back(v);
    }
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

// Over edges between mapped samples only, so that they are one piece; few enough for a linear search.
std::vector<int> Relief::samples_around(const PartialMap& map, int sample, double reach) const {
    const Samples& source = pair_.source.samples;
    std::vector<int> found{sample};
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (const int e : source.base_edges_of[found[i]]) {
            const int other = source.edges[e].other(found[i]);
            if (!map.mapped[other]) continue;
            if ((source.position[other] - source.position[sample]).squaredNorm() > reach * reach) continue;
            if (sample_normal_[other].dot(sample_normal_[sample]) < surrounding_side) continue;
            if (std::find(found.begin(), found.end(), other) == found.end()) found.push_back(other);
        }
    }
    return found;
}

Relief::Surroundings Relief::surroundings(const PartialMap& map, int sample, const ReliefScale& scale) const {
    const Samples& source = pair_.source.samples;
    const TriangleMesh& mesh = pair_.source.mesh;
    Surroundings result;
    result.samples = samples_around(map, sample, 2.0 * scale.width);
    const auto add = [&](const Vector3d& x, const Vector3d& n, int near) {
        result.point.push_back(x);
        result.normal.push_back(n);
        result.near.push_back(near);
        result.weight.push_back(falloff((x - source.position[sample]).squaredNorm(), scale.width));
    };
    // The samples come first; every so many vertices as there is room for follow.
    std::size_t vertices = 0;
    for (const int s : result.samples) {
        add(source.position[s], sample_normal_[s], nearest_corner(pair_.target.mesh, map.image[s]));
        vertices += owned_[s].size();
    }
    const double room = std::max(0.0, static_cast<double>(scale.points) - static_cast<double>(result.samples.size()));
    const double share = vertices > 0 ? std::min(1.0, room / static_cast<double>(vertices)) : 0.0;
    double due = 0.0;
    for (std::size_t i = 0; i < result.samples.size(); ++i) {
        for (const int v : owned_[result.samples[i]]) {
            due += share;
            if (due < 1.0) continue;
            due -= 1.0;
            add(mesh.position[v], mesh.vertex_normal[v], result.near[i]);
        }
    }
    return result;
}

std::optional<SampleTerm> Relief::term(const PartialMap& map, int sample, const ReliefScale& scale) const {
    const Samples& source = pair_.source.samples;
    const TriangleMesh& mesh = pair_.target.mesh;
    Surroundings around = surroundings(map, sample, scale);
    if (around.samples.size() < fewest_samples || around.point.size() < fewest_points) return std::nullopt;
    Motion motion = motion_of(map, source, around.samples, around.weight);
    const double far = far_widths * scale.width;
    RigidStep step;
    for (int k = 0; k < scale.steps; ++k) {
        const Vector3d pivot = motion(source.position[sample]);
        step = {};
        for (std::size_t i = 0; i < around.point.size(); ++i) {
            const Vector3d x = motion(around.point[i]);
            const int near = around.near[i] = descend(around.near[i], x);
            const Vector3d& plane = mesh.vertex_normal[near];
            const Vector3d gap = mesh.position[near] - x;
            if (gap.squaredNorm() > far * far || plane.dot(motion.turn * around.normal[i]) < same_side) continue;
            const double height = gap.dot(plane);
            const double w = around.weight[i] / (1.0 + height * height / (soft * soft));
            Vector6d row;
            row << (x - pivot).cross(plane) / scale.width, plane;
            step.matrix += w * row * row.transpose();
            step.right += w * height * row;
            step.weight += w;
            step.squares += w * height * height;
            ++step.points;
        }
        if (step.points < fewest_points) return std::nullopt;
        Matrix6d damped = step.matrix;
        damped.diagonal().array() += damping * step.weight;
        const Vector6d by = damped.ldlt().solve(step.right);
        const Vector3d spin = by.head<3>() / scale.width;
        const double angle = spin.norm();
        if (angle > most_turn) return std::nullopt;
        const Vector3d axis = angle > 1e-12 ? Vector3d(spin / angle) : Vector3d::UnitX();
        motion.then(Eigen::AngleAxisd(angle, axis).toRotationMatrix(), pivot, by.tail<3>());
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
