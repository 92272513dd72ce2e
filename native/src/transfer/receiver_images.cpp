// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/receiver_images.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace isograft {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// A polygon longer than this many times what the pair's median stretch says was torn by the map.
constexpr double tear = 4.0;
// Squared lengths of all images may add up to this many times the donor's area: an injective map of slim triangles
// stays far below, a map of noise would make every polygon look at half of the donor.
constexpr double most_overlap = 100.0;

double median(std::vector<double>& values) {
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace

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

ReceiverImages::ReceiverImages(const Correspondence& correspondence, const ReceiverMesh& given, const DonorView& donor)
    : receiver(given), polygons(group(given)), images(images_of(correspondence, donor)) {
    measure_extents(donor.area);
}

bool ReceiverImages::matched(int f) const {
    for (int c = 0; c < 3; ++c) {
        if (corner(f, c).face < 0) return false;
    }
    return true;
}

double ReceiverImages::receiver_length(int f, int c) const {
    const int a = receiver.faces(f, c), b = receiver.faces(f, (c + 1) % 3);
    return (receiver.vertices.row(a) - receiver.vertices.row(b)).norm();
}

double ReceiverImages::donor_length(int f, int c) const {
    return (corner(f, c).point - corner(f, (c + 1) % 3).point).norm();
}

double ReceiverImages::measure_stretch() {
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
    return median(lengths);
}

void ReceiverImages::measure_extents(double donor_area) {
    const double usual_length = measure_stretch();
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
    double left = most_overlap * donor_area;
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

}  // namespace isograft
