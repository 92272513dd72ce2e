// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "isograft/transfer.h"
#include "transfer/donor_view.h"

namespace isograft {

/// The triangles of every polygon: those of polygon p are triangle[first[p]] to triangle[first[p + 1] - 1].
struct Polygons {
    std::vector<int> triangle;
    std::vector<int> first;

    [[nodiscard]] int count() const { return static_cast<int>(first.size()) - 1; }
};

/// The triangles by `ReceiverMesh::polygons`, in ascending order of polygon and triangle.
Polygons group(const ReceiverMesh& receiver);

/// The receiver's vertices and polygons on the donor. The references given must outlive it.
struct ReceiverImages {
    /// O(#F log #F).
    ReceiverImages(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorView& donor);

    const ReceiverMesh& receiver;
    Polygons polygons;
    /// One per vertex.
    std::vector<Image> images;
    /// Longest edge of every polygon's image. Infinite where a corner is unmatched, or where the map tore it apart:
    /// over four times as long as the median stretch says, or so long that the images could not lie side by side.
    std::vector<double> extent;
    /// Median length of an edge's image over that of the edge; 0 if nothing is matched.
    double stretch = 0.0;

    [[nodiscard]] const Image& corner(int f, int c) const { return images[receiver.faces(f, c)]; }
    [[nodiscard]] bool matched(int f) const;

  private:
    [[nodiscard]] double receiver_length(int f, int c) const;
    [[nodiscard]] double donor_length(int f, int c) const;
    // Sets `stretch`; returns the median length of the receiver's edges.
    double measure_stretch();
    void measure_extents(double donor_area);
};

}  // namespace isograft
