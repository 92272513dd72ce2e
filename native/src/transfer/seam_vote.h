// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "isograft/monitor.h"
#include "transfer/patch.h"
#include "transfer/receiver_images.h"

namespace isograft {

/// A polygon of the receiver as the donor sees it.
struct PolygonCorners {
    /// Vertices of the polygon, ascending.
    std::vector<int> vertices;
    /// One per vertex.
    std::vector<Image> images;
    /// Mean of the images over the polygon's area.
    Eigen::Vector3d centre;

    /// The index of a vertex of the polygon.
    [[nodiscard]] std::size_t index_of(int vertex) const {
        return std::lower_bound(vertices.begin(), vertices.end(), vertex) - vertices.begin();
    }
};

/// The vertices of polygon `p` and their images.
PolygonCorners polygon_corners(const ReceiverImages& receiver, int p);

/// Hand the places of polygon `p`, one per vertex, to the corners of its triangles. \param places 3 #F.
void write_places(const ReceiverImages& receiver, int p, const PolygonCorners& corners, const std::vector<Place>& found,
                  std::vector<Place>& places);

/// Assigns the polygons that a seam of the donor runs through by their centre and by their neighbours.
///
/// The patch under the centre has a polygon at first. Another patch that one of its corners lies in takes it over if
/// that shortens the edges along which the polygon parts from its neighbours, measured against its perimeter, by more
/// than the share of the polygon that it takes out of its place: half of it at the least of what is at stake, so that
/// nothing changes where a polygon lies in one patch. Polygons are asked in ascending order, over and over until none
/// changes (the sum of all costs falls with each change), at most `sweeps` times. O(#F log #F) to find the neighbours,
/// then linear in the corners of the polygons asked.
/// \param asked polygons in ascending order, each placed and matched.
/// \param places 3 #F: where every corner is read; changed. `face` -1 where unmatched. \param root by polygon a
/// triangle of its patch; changed.
void vote_on_seams(const ReceiverImages& receiver, const DonorView& donor, const std::vector<int>& asked,
                   PatchReader& reader, std::vector<Place>& places, std::vector<int>& root, Monitor& monitor,
                   int sweeps = 4);

}  // namespace isograft
