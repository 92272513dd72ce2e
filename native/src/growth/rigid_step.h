// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

#include "growth/partial_map.h"

namespace isograft {

/// A rigid motion of space.
struct RigidMotion {
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();

    Eigen::Vector3d operator()(const Eigen::Vector3d& x) const { return turn * x + shift; }
};

/// The rigid motion nearest to a map on some of the samples it holds. \param weight one for each of these.
RigidMotion motion_of(const PartialMap& map, const Samples& source, const std::vector<int>& samples,
                      const std::vector<double>& weight);

/// Weight of a point at some squared distance from the middle of a piece `width` wide.
double falloff(double squared_distance, double width);

/// Strength of staying where it is, per unit weight.
constexpr double rigid_damping = 1e-2;

/// One step of iterated closest points to tangent planes (Chen and Medioni 1992). Normal equations of a rigid motion:
/// three angles about `pivot`, in units that move a point one width away by one unit length, and three shifts.
class RigidStep {
  public:
    using Matrix = Eigen::Matrix<double, 6, 6>;
    using Vector = Eigen::Matrix<double, 6, 1>;

    RigidStep() = default;
    RigidStep(const Eigen::Vector3d& pivot, double width) : pivot_(pivot), width_(width) {}

    /// A point at `x` wants to move by `height` along the unit vector `plane`.
    void add(const Eigen::Vector3d& x, const Eigen::Vector3d& plane, double height, double weight);
    /// Move on by the step. \return false, and nothing is moved, where it turns so far that it has lost its way.
    [[nodiscard]] bool apply(RigidMotion& motion) const;

    [[nodiscard]] int points() const { return points_; }
    /// Per unit weight: the matrix, and the squared heights. Of at least one point.
    [[nodiscard]] Matrix mean_matrix() const { return matrix_ / weight_; }
    [[nodiscard]] double mean_square() const { return squares_ / weight_; }

  private:
    Eigen::Vector3d pivot_ = Eigen::Vector3d::Zero();
    double width_ = 1.0;
    Matrix matrix_ = Matrix::Zero();
    Vector right_ = Vector::Zero();
    double weight_ = 0.0, squares_ = 0.0;
    int points_ = 0;
};

/// Samples that level-0 edges lead to from `sample`, over samples alone that are within `reach` of it in space and
/// that `accept` takes; itself first. Few, so that a linear search does.
template <class Accept>
std::vector<int> samples_around(const Samples& source, int sample, double reach, Accept&& accept) {
    std::vector<int> found{sample};
    for (std::size_t i = 0; i < found.size(); ++i) {
        for (const int e : source.base_edges_of[found[i]]) {
            const int other = source.edges[e].other(found[i]);
            if ((source.position[other] - source.position[sample]).squaredNorm() > reach * reach) continue;
            if (!accept(other)) continue;
            if (std::find(found.begin(), found.end(), other) == found.end()) found.push_back(other);
        }
    }
    return found;
}

/// Per sample the mesh vertices nearest to it.
std::vector<std::vector<int>> vertices_of(const SampledMesh& surface);

/// Call `take(i, vertex)` with every so many of the vertices that belong to `samples[i]` as there is room for.
template <class Take>
void spread_vertices(const std::vector<std::vector<int>>& vertices, const std::vector<int>& samples, double room,
                     Take&& take) {
    std::size_t all = 0;
    for (const int s : samples) all += vertices[s].size();
    const double share = all > 0 ? std::min(1.0, room / static_cast<double>(all)) : 0.0;
    double due = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        for (const int v : vertices[samples[i]]) {
            due += share;
            if (due < 1.0) continue;
            due -= 1.0;
            take(i, v);
        }
    }
}

}  // namespace isograft
