// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <memory>
#include <numeric>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "isograft/transfer.h"
#include "transfer/checks.h"
#include "transfer/patch.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

// A polygon longer than this many times what the pair's median stretch says was torn by the map.
constexpr double tear = 4.0;
// Polygons a task: enough that handing out tasks costs nothing.
constexpr int polygons_a_task = 256;

// The triangles of every polygon: those of polygon p are triangle[first[p]] to triangle[first[p + 1] - 1].
struct Polygons {
    std::vector<int> triangle;
    std::vector<int> first;

    [[nodiscard]] int count() const { return static_cast<int>(first.size()) - 1; }
};

Polygons group(const ReceiverMesh& receiver) {
    Polygons polygons;
    const int count = static_cast<int>(receiver.faces.rows());
    polygons.triangle.resize(count);
    std::iota(polygons.triangle.begin(), polygons.triangle.end(), 0);
    const auto& id = receiver.polygons;
    if (id.rows() > 0) {
        std::stable_sort(polygons.triangle.begin(), polygons.triangle.end(), [&](int a, int b) { return id[a] < id[b]; });
    }
    for (int i = 0; i < count; ++i) {
        const bool same = i > 0 && id.rows() > 0 && id[polygons.triangle[i]] == id[polygons.triangle[i - 1]];
        if (!same) polygons.first.push_back(i);
    }
    polygons.first.push_back(count);
    return polygons;
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

double median(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// What every polygon's placement needs, and the slots it fills.
struct Placement {
    const ReceiverMesh& receiver;
    const DonorView& donor;
    const Polygons polygons;
    const std::vector<Image> images;
    // Donor length that a receiver edge of median length is expected to have, and the expected stretch.
    double stretch = 0.0;
    double usual_length = 0.0;
    CornerPlacement result{};

    [[nodiscard]] bool matched(int f) const {
        for (int c = 0; c < 3; ++c) {
            if (images[receiver.faces(f, c)].face < 0) return false;
        }
        return true;
    }
    [[nodiscard]] double receiver_length(int f, int c) const {
        const int a = receiver.faces(f, c), b = receiver.faces(f, (c + 1) % 3);
        return (receiver.vertices.row(a) - receiver.vertices.row(b)).norm();
    }
    [[nodiscard]] double donor_length(int f, int c) const {
        return (images[receiver.faces(f, c)].point - images[receiver.faces(f, (c + 1) % 3)].point).norm();
    }

    void measure_stretch() {
        std::vector<double> ratios, lengths;
        for (int f = 0; f < receiver.faces.rows(); ++f) {
            if (!matched(f)) continue;
            for (int c = 0; c < 3; ++c) {
                const double from = receiver_length(f, c);
                const double to = donor_length(f, c);
                if (from <= 0.0 || to <= 0.0) continue;
                ratios.push_back(to / from);
                lengths.push_back(from);
            }
        }
        stretch = median(ratios);
        usual_length = median(lengths);
    }

    // Read all corners of the triangles [from, to) of polygons.triangle as one, if all of them are matched and not torn.
    void place(int from, int to, PatchReader& reader) {
        double longest_receiver = 0.0, longest_donor = 0.0, area = 0.0;
        Vector3d moment = Vector3d::Zero(), sum = Vector3d::Zero();
        std::vector<int> corners;
        for (int i = from; i < to; ++i) {
            const int f = polygons.triangle[i];
            if (!matched(f)) return;
            Vector3d p[3];
            for (int c = 0; c < 3; ++c) {
                p[c] = images[receiver.faces(f, c)].point;
                corners.push_back(receiver.faces(f, c));
                longest_receiver = std::max(longest_receiver, receiver_length(f, c));
                longest_donor = std::max(longest_donor, donor_length(f, c));
            }
            const double share = (p[1] - p[0]).cross(p[2] - p[0]).norm();
            moment += share * (p[0] + p[1] + p[2]) / 3.0;
            sum += (p[0] + p[1] + p[2]) / 3.0;
            area += share;
        }
        if (longest_donor > tear * stretch * std::max(longest_receiver, usual_length)) return;
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
    Placement placement{receiver, view, group(receiver), images_of(correspondence, view)};
    placement.measure_stretch();
    const Eigen::Index count = receiver.faces.rows();
    placement.result.triangle = Eigen::VectorXi::Constant(3 * count, -1);
    placement.result.weights = Points::Zero(3 * count, 3);
    placement.result.island = Eigen::VectorXi::Constant(count, -1);
    placement.result.mask = Mask::Constant(count, false);

    const int polygons = placement.polygons.count();
    const int tasks = (polygons + polygons_a_task - 1) / polygons_a_task;
    std::vector<std::unique_ptr<PatchReader>> readers(worker_count(options.threads));
    const auto task = [&](int index, int worker) {
        if (!readers[worker]) readers[worker] = std::make_unique<PatchReader>(view, options.extrapolation);
        const int end = std::min(polygons, (index + 1) * polygons_a_task);
        for (int p = index * polygons_a_task; p < end; ++p) {
            placement.place(placement.polygons.first[p], placement.polygons.first[p + 1], *readers[worker]);
        }
    };
    parallel_for(tasks, options.threads, task, watched, "transfer", 0.0, 1.0);
    return std::move(placement.result);
}

}  // namespace isograft
