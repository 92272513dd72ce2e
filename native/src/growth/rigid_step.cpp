// SPDX-License-Identifier: GPL-3.0-or-later
#include "growth/rigid_step.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "base/rotation.h"

namespace isograft {

namespace {
// Of one step.
constexpr double most_turn = 0.5;
}  // namespace

RigidMotion motion_of(const PartialMap& map, const Samples& source, const std::vector<int>& samples,
                      const std::vector<double>& weight) {
    Eigen::Vector3d from = Eigen::Vector3d::Zero(), onto = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        from += weight[i] * source.position[samples[i]];
        onto += weight[i] * map.position[samples[i]];
        total += weight[i];
    }
    from /= total;
    onto /= total;
    Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < samples.size(); ++i) {
        product += weight[i] * (source.position[samples[i]] - from) * (map.position[samples[i]] - onto).transpose();
    }
    const Eigen::Matrix3d turn = rotation_of(product);
    return {turn, onto - turn * from};
}

double falloff(double squared_distance, double width) { return std::exp(-0.5 * squared_distance / (width * width)); }

void RigidStep::add(const Eigen::Vector3d& x, const Eigen::Vector3d& plane, double height, double weight) {
    Vector row;
    row << (x - pivot_).cross(plane) / width_, plane;
    matrix_ += weight * row * row.transpose();
    right_ += weight * height * row;
    weight_ += weight;
    squares_ += weight * height * height;
    ++points_;
}

bool RigidStep::apply(RigidMotion& motion) const {
    Matrix damped = matrix_;
    damped.diagonal().array() += rigid_damping * weight_;
    const Vector by = damped.ldlt().solve(right_);
    const Eigen::Vector3d spin = by.head<3>() / width_;
    const double angle = spin.norm();
    // Nor one that is no number.
    if (!(angle <= most_turn)) return false;
    const Eigen::Vector3d axis = angle > 1e-12 ? Eigen::Vector3d(spin / angle) : Eigen::Vector3d::UnitX();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    motion.turn = turn * motion.turn;
    motion.shift = turn * (motion.shift - pivot_) + pivot_ + by.tail<3>();
    return true;
}

std::vector<std::vector<int>> vertices_of(const SampledMesh& surface) {
    std::vector<std::vector<int>> result(surface.samples.count());
    for (int v = 0; v < surface.mesh.vertex_count(); ++v) {
        if (surface.samples.owner[v] >= 0) result[surface.samples.owner[v]].push_back(v);
    }
    return result;
}

}  // namespace isograft
