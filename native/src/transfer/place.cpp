// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "isograft/transfer.h"
#include "transfer/checks.h"
#include "transfer/patch.h"
#include "transfer/receiver_images.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Polygons a task: enough that handing out tasks costs nothing.
constexpr int polygons_a_task = 64;

// What every polygon's placement needs, and the slots it fills.
struct Placement {
    const ReceiverMesh& receiver;
    const DonorView& donor;
    const ReceiverImages on_donor;
    CornerPlacement result{};

    // Read all corners of polygon p as one, if all of them are matched and not torn.
    void place(int p, PatchReader& reader) {
        const Polygons& polygons = on_donor.polygons;
        const std::vector<Image>& images = on_donor.images;
        if (on_donor.extent[p] == infinity) return;
        const int from = polygons.first[p], to = polygons.first[p + 1];
        double area = 0.0;
        Vector3d moment = Vector3d::Zero(), sum = Vector3d::Zero();
        std::vector<int> corners;
        for (int i = from; i < to; ++i) {
            Vector3d at[3];
            for (int c = 0; c < 3; ++c) {
                corners.push_back(receiver.faces(polygons.triangle[i], c));
                at[c] = images[corners.back()].point;
            }
            const double share = (at[1] - at[0]).cross(at[2] - at[0]).norm();
            moment += share * (at[0] + at[1] + at[2]) / 3.0;
            sum += (at[0] + at[1] + at[2]) / 3.0;
            area += share;
        }
        const bool one = to - from == 1;
        const Vector3d centre = one || area <= 0.0 ? Vector3d(sum / (to - from)) : Vector3d(moment / area);
        std::sort(corners.begin(), corners.end());
        corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
        std::vector<Image> own;
        for (const int v : corners) own.push_back(images[v]);
        std::vector<Place> places;
        if (!reader.read(own, centre, places)) return;
        for (int i = from; i < to; ++i) {
            const int f = polygons.triangle[i];
            for (int c = 0; c < 3; ++c) {
                const auto at = std::lower_bound(corners.begin(), corners.end(), receiver.faces(f, c));
                const Place& place = places[at - corners.begin()];
                result.triangle[3 * f + c] = place.face;
                result.weights.row(3 * f + c) = place.weights.transpose();
            }
            result.island[f] = donor.graph.island[places[0].face];
            result.mask[f] = true;
        }
    }
};

}  // namespace

CornerPlacement place_corners(const Correspondence& correspondence, const ReceiverMesh& receiver,
                              const DonorMesh& donor, const CornerValues& donor_values,
                              const CornerTransferOptions& options, Monitor* monitor) {
    options.validate();
    check_placement(correspondence, receiver, donor, donor_values);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.check();
    const DonorView view(donor, donor_values, options.tolerance);
    Placement placement{receiver, view, ReceiverImages(correspondence, receiver, view)};
    const Eigen::Index count = receiver.faces.rows();
    placement.result.triangle = Eigen::VectorXi::Constant(3 * count, -1);
    placement.result.weights = Points::Zero(3 * count, 3);
    placement.result.island = Eigen::VectorXi::Constant(count, -1);
    placement.result.mask = Mask::Constant(count, false);

    const int polygons = placement.on_donor.polygons.count();
    const int tasks = (polygons + polygons_a_task - 1) / polygons_a_task;
    std::vector<std::unique_ptr<PatchReader>> readers(worker_count(options.threads));
    const auto task = [&](int index, int worker) {
        if (!readers[worker]) readers[worker] = std::make_unique<PatchReader>(view, options.extrapolation);
        const int end = std::min(polygons, (index + 1) * polygons_a_task);
        for (int p = index * polygons_a_task; p < end; ++p) {
            placement.place(p, *readers[worker]);
        }
    };
    parallel_for(tasks, options.threads, task, watched, "transfer", 0.0, 1.0);
    return std::move(placement.result);
}

}  // namespace isograft
