// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "base/parallel.h"
#include "isograft/transfer.h"
#include "transfer/checks.h"
#include "transfer/patch.h"
#include "transfer/receiver_images.h"
#include "transfer/seam_vote.h"

namespace isograft {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// Polygons a task: enough that handing out tasks costs nothing.
constexpr int polygons_a_task = 64;
constexpr double share_of_reading = 0.9;

// What every polygon's placement needs, and the slots it fills.
struct Placement {
    const ReceiverImages on_donor;
    // 3 #F.
    std::vector<Place> places;
    // By polygon: a triangle of the patch it is read in, -1 where unmatched; and whether a seam runs through it.
    std::vector<int> root;
    std::vector<char> parted;

    // Read all corners of polygon p as one, if all of them are matched and not torn.
    void place(int p, PatchReader& reader) {
        if (on_donor.extent[p] == infinity) return;
        const PolygonCorners own = polygon_corners(on_donor, p);
        std::vector<Place> found;
        if (!reader.read(own.images, own.centre, found)) return;
        write_places(on_donor, p, own, found, places);
        root[p] = reader.root();
        parted[p] = reader.parted() ? 1 : 0;
    }
};

CornerPlacement as_arrays(const Placement& placement, const Eigen::VectorXi& islands) {
    const auto count = static_cast<Eigen::Index>(placement.places.size());
    CornerPlacement result;
    result.triangle.resize(count);
    result.weights = Points::Zero(count, 3);
    result.island = Eigen::VectorXi::Constant(count / 3, -1);
    result.mask = Mask::Constant(count / 3, false);
    for (Eigen::Index i = 0; i < count; ++i) {
        const Place& place = placement.places[i];
        result.triangle[i] = place.face;
        if (place.face >= 0) result.weights.row(i) = place.weights.transpose();
    }
    const Polygons& polygons = placement.on_donor.polygons;
    for (int p = 0; p < polygons.count(); ++p) {
        if (placement.root[p] < 0) continue;
        for (int i = polygons.first[p]; i < polygons.first[p + 1]; ++i) {
            result.island[polygons.triangle[i]] = islands[placement.root[p]];
            result.mask[polygons.triangle[i]] = true;
        }
    }
    return result;
}

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
    const auto corners = static_cast<std::size_t>(3 * receiver.faces.rows());
    Placement placement{ReceiverImages(correspondence, receiver, view), std::vector<Place>(corners), {}, {}};
    const int polygons = placement.on_donor.polygons.count();
    placement.root.assign(polygons, -1);
    placement.parted.assign(polygons, 0);
    const int tasks = (polygons + polygons_a_task - 1) / polygons_a_task;
    std::vector<std::unique_ptr<PatchReader>> readers(worker_count(options.threads));
    const auto task = [&](int index, int worker) {
        if (!readers[worker]) readers[worker] = std::make_unique<PatchReader>(view, options.extrapolation);
        const int end = std::min(polygons, (index + 1) * polygons_a_task);
        for (int p = index * polygons_a_task; p < end; ++p) placement.place(p, *readers[worker]);
    };
    parallel_for(tasks, options.threads, task, watched, "transfer", 0.0, share_of_reading);

    std::vector<int> asked;
    for (int p = 0; p < polygons; ++p) {
        if (placement.parted[p] != 0) asked.push_back(p);
    }
    PatchReader reader(view, options.extrapolation);
    vote_on_seams(placement.on_donor, view, asked, reader, placement.places, placement.root, watched);
    watched.report("transfer", 1.0);
    return as_arrays(placement, view.graph.island);
}

}  // namespace isograft
