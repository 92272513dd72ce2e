// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "base/rotation.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/donor_view.h"
#include "transfer/moments.h"
#include "transfer/pose.h"
#include "transfer/receiver_images.h"

namespace isograft {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int vertices_a_task = 1024;
// Edges around a vertex that are summed where limbs may turn.
constexpr int few = 2;
// In one pose, fingers or a tail may still be turned: where the frames of this many edges more differ from the wide
// ones by the first angle they begin to take their place, from the second on they have it. Radians.
constexpr int few_more = 6;
constexpr double begins = 0.5;
constexpr double ends = 1.0;

// The triangles that count, and both shapes of each.
class Fit {
  public:
    Fit(const ReceiverMesh& receiver, const ReceiverImages& images) : receiver_(receiver), images_(images) {
        for (int f = 0; f < receiver.faces.rows(); ++f) {
            if (images.extent[f] < infinity) used_.push_back(f);
        }
    }

    [[nodiscard]] std::vector<Moments> moments(Monitor& monitor) const {
        std::vector<Moments> around(receiver_.vertices.rows());
        std::vector<Vector3d> here(around.size(), Vector3d::Zero()), there(around.size(), Vector3d::Zero());
        for (const int f : used_) {
            Vector3d x[3], y[3];
            for (int c = 0; c < 3; ++c) {
                x[c] = receiver_.vertices.row(receiver_.faces(f, c)).transpose();
                y[c] = images_.corner(f, c).point;
            }
            const Vector3d own = (x[1] - x[0]).cross(x[2] - x[0]), image = (y[1] - y[0]).cross(y[2] - y[0]);
            for (int c = 0; c < 3; ++c) {
                const int v = receiver_.faces(f, c);
                here[v] += own;
                there[v] += image;
                for (const int other : {(c + 1) % 3, (c + 2) % 3}) {
                    const Vector3d e = x[other] - x[c], d = y[other] - y[c];
                    around[v].product += d * e.transpose();
                    around[v].receiver += e.squaredNorm();
                    around[v].donor += d.squaredNorm();
                }
            }
        }
        monitor.check();
        for (std::size_t v = 0; v < around.size(); ++v) {
            const double weight = std::sqrt(around[v].receiver * around[v].donor);
            around[v].product += weight * there[v].stableNormalized() * here[v].stableNormalized().transpose();
        }
        return around;
    }

    // Every vertex's sums plus those of its neighbours. Neighbours in two triangles count twice, at borders once.
    [[nodiscard]] std::vector<Moments> spread(const std::vector<Moments>& moments) const {
        std::vector<Moments> wider = moments;
        for (const int f : used_) {
            for (int c = 0; c < 3; ++c) {
                wider[receiver_.faces(f, c)].add(moments[receiver_.faces(f, (c + 1) % 3)]);
                wider[receiver_.faces(f, c)].add(moments[receiver_.faces(f, (c + 2) % 3)]);
            }
        }
        return wider;
    }

    [[nodiscard]] Triangles faces() const { return receiver_.faces(used_, Eigen::all); }

  private:
    const ReceiverMesh& receiver_;
    const ReceiverImages& images_;
    std::vector<int> used_;
};

Matrix3d turned_here(const Moments& near, const Moments& middle, const Moments& wide) {
    Matrix3d rotation = rotation_of(wide.product);
    const double angle = Eigen::AngleAxisd(rotation.transpose() * rotation_of(middle.product)).angle();
    const double t = std::clamp((angle - begins) / (ends - begins), 0.0, 1.0), share = t * t * (3.0 - 2.0 * t);
    if (share == 0.0) return rotation;
    return rotation_of(share * near.product.normalized() + (1.0 - share) * wide.product.normalized());
}

}  // namespace

void FrameOptions::validate() const {
    if (smoothing && (*smoothing < 0 || *smoothing > 100)) {
        throw InvalidInput("smoothing must be from 0 to 100, got " + std::to_string(*smoothing));
    }
    if (threads < 0) throw InvalidInput("threads must be >= 0, got " + std::to_string(threads));
}

LocalFrames local_frames(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                         const FrameOptions& options, Monitor* monitor) {
    options.validate();
    const Eigen::VectorXi no_polygons;
    const ReceiverMesh alone{receiver.vertices, receiver.faces, no_polygons};
    const CornerValues no_values = no_corner_values(donor.faces);
    check_placement(correspondence, alone, donor, no_values);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();
    const DonorView view(donor, no_values, 0.0);
    watched.check();
    const ReceiverImages images(correspondence, alone, view);
    const Fit fit(alone, images);
    std::vector<Moments> moments = fit.moments(watched);
    std::optional<std::vector<Moments>> wide;
    if (!options.smoothing) wide = fit_in_one_pose(receiver.vertices, fit.faces(), moments, watched);
    const auto widen = [&](int times) {
        for (int i = 0; i < times; ++i) {
            watched.check();
            moments = fit.spread(moments);
        }
    };
    widen(options.smoothing.value_or(few));
    const std::vector<Moments> near = moments;
    if (wide) widen(few_more);

    const int count = static_cast<int>(moments.size());
    LocalFrames frames;
    frames.rotation.setZero(count, 9);
    frames.scale = Eigen::VectorXd::Zero(count);
    frames.mask = Mask::Constant(count, false);
    frames.median_scale = images.stretch > 0.0 ? 1.0 / images.stretch : 0.0;
    frames.one_pose = wide.has_value();
    const auto task = [&](int index, int /*worker*/) {
        const int end = std::min(count, (index + 1) * vertices_a_task);
        for (int v = index * vertices_a_task; v < end; ++v) {
            if (images.images[v].face < 0 || !near[v].usable()) continue;
            const Matrix3d rotation =
                wide ? turned_here(near[v], moments[v], (*wide)[v]) : rotation_of(near[v].product);
            Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(frames.rotation.row(v).data()) = rotation;
            frames.scale[v] = std::sqrt(near[v].receiver / near[v].donor);
            frames.mask[v] = true;
        }
    };
    parallel_for((count + vertices_a_task - 1) / vertices_a_task, options.threads, task, watched, "frames", 0.0, 1.0);
    return frames;
}

}  // namespace isograft
