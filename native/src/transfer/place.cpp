// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/parallel.h"
#include "isograft/transfer.h"
#include "transfer/checks.h"
#include "transfer/patch.h"

namespace isograft {

using Eigen::Vector3d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// A polygon longer than this many times what the pair's median stretch says was torn by the map.
constexpr double tear = 4.0;
// Squared lengths of all images may add up to this many times the donor's area: an injective map of slim triangles
// stays far below, a map of noise would make every polygon look at half of the donor.
constexpr double most_overlap = 100.0;
// Polygons a task: enough that handing out tasks costs nothing.
constexpr int polygons_a_task = 64;

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
        std::stable_sort(polygons.triangle.begin(), polygons.triangle.end(),
                         [&](int a, int b) { return id[a] < id[b]; });
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
    // Longest edge of every polygon's image; infinite where it is unmatched or torn.
    std::vector<double> extent{};
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

    // Median stretch of the receiver's edges, and their median length.
    [[nodiscard]] std::pair<double, double> usual_edge() const {
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
        return {median(ratios), median(lengths)};
    }

    void measure_extents() {
        const auto [stretch, usual_length] = usual_edge();
        extent.assign(polygons.count(), 0.0);
        std::vector<double> ascending;
        for (int p = 0; p < polygons.count(); ++p) {
            double from = usual_length;
            for (int i = polygons.first[p]; i < polygons.first[p + 1]; ++i) {
                const int f = polygons.triangle[i];
                for (int c = 0; c < 3; ++c) {
                    from = std::max(from, receiver_length(f, c));
                    extent[p] = matched(f) ? std::max(extent[p], donor_length(f, c)) : infinity;
                }
            }
            if (extent[p] > tear * stretch * from) extent[p] = infinity;
            if (extent[p] < infinity) ascending.push_back(extent[p]);
        }
        std::sort(ascending.begin(), ascending.end());
        double left = most_overlap * donor.area;
        double longest = 0.0;
        for (const double length : ascending) {
            left -= length * length;
            if (left < 0.0) break;
            longest = length;
        }
        for (double& length : extent) {
            if (length > longest) length = infinity;
        }
    }

    // Read all corners of polygon p as one, if all of them are matched and not torn.
    void place(int p, PatchReader& reader) {
        if (extent[p] == infinity) return;
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
    Placement placement{receiver, view, group(receiver), images_of(correspondence, view)};
    placement.measure_extents();
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
            placement.place(p, *readers[worker]);
        }
    };
    parallel_for(tasks, options.threads, task, watched, "transfer", 0.0, 1.0);
    return std::move(placement.result);
}

}  // namespace isograft
