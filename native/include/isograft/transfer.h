// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/correspondence.h"
#include "isograft/monitor.h"
#include "isograft/surface.h"

namespace isograft {

/// One row per corner: row 3 f + c belongs to corner c of triangle f.
using CornerValues = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using CornerUV = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;
using Mask = Eigen::Array<bool, Eigen::Dynamic, 1>;

/// How values are read at a point inside a donor triangle.
enum class TransferMode {
    barycentric,  ///< weighted mean of the three corners
    nearest,      ///< the value of the corner with the largest weight, the first of equal ones
};

/// Options of the transfer of corner attributes.
struct CornerTransferOptions {
    /// Two corners at one donor vertex carry the same value if no column differs by more than this.
    double tolerance = 1e-6;
    /// How far beyond the border of its island a corner may be read, in longest edges of the donor triangle it is read
    /// in; what lies farther is read at that distance. 0 reads on the border itself.
    double extrapolation = 1.0;
    /// Worker threads; 0 takes all cores. The result does not depend on it.
    int threads = 0;

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

/// The receiver of a transfer. The references must outlive the call.
struct ReceiverMesh {
    /// #V by 3.
    const Points& vertices;
    /// #F by 3.
    const Triangles& faces;
    /// #F, or empty: triangles of one value >= 0 are one polygon and are never parted by a seam; empty = each alone.
    const Eigen::VectorXi& polygons;
};

/// The donor of a transfer. The references must outlive the call.
struct DonorMesh {
    /// #V by 3.
    const Points& vertices;
    /// #F by 3: the triangles that Correspondence::face counts.
    const Triangles& faces;
};

/// Values moved along a correspondence.
struct TransferredValues {
    /// One row per receiver vertex or corner; NaN (points) or 0 (corners) where unmatched.
    CornerValues values;
    /// One entry per receiver vertex (points) or triangle (corners).
    Mask mask;
};

/// UVs moved along a correspondence.
struct TransferredUV {
    /// 3 #F by 2; 0 where unmatched.
    CornerUV uv;
    /// #F: the donor's island, as numbered by uv_islands() with `vertices`; -1 where unmatched.
    Eigen::VectorXi island;
    /// #F.
    Mask mask;
};

/// Where on the donor every corner of the receiver is read.
struct CornerPlacement {
    /// 3 #F: donor triangle; -1 where unmatched.
    Eigen::VectorXi triangle;
    /// 3 #F by 3: weights of its corners, sum 1; outside [0, 1] where a corner lies beyond its island; 0 if unmatched.
    Points weights;
    /// #F: island of the donor that the whole triangle is read in; -1 where unmatched.
    Eigen::VectorXi island;
    /// #F.
    Mask mask;
};

/// Move values from the donor's vertices to the receiver's.
///
/// Vertices matched to a donor vertex only (`face` -1, `vertex` >= 0: a point cloud) take that vertex's value.
/// \param donor_faces #F by 3, may be empty for a point cloud. \param values #V(donor) by k.
/// \param monitor may be null.
/// \throw InvalidInput if a matched row is out of range or no set of weights; Cancelled if `monitor` asks for it.
TransferredValues transfer_point(const Correspondence& correspondence, const Triangles& donor_faces,
                                 const CornerValues& values, TransferMode mode, Monitor* monitor = nullptr);

/// Connected parts of a triangle mesh under a corner attribute: triangles are joined across an edge if the values at
/// both of its ends agree; any other edge is a seam.
///
/// Folded, flipped and zero-area UV triangles join like any other; non-manifold edges join all that agree.
/// \param values 3 #F by k, such as UVs. \param vertices empty, or #V by 3: then vertices of equal position count as
/// one, so that meshes split along their seams are read as the closed surfaces they are. \param monitor may be null.
/// \return #F, islands numbered by their first triangle. O(#F log #F).
/// \throw InvalidInput on wrong sizes, indices, values not finite; Cancelled if `monitor` asks for it.
Eigen::VectorXi uv_islands(const Triangles& faces, const CornerValues& values, double tolerance = 1e-6,
                           const Points& vertices = Points(), Monitor* monitor = nullptr);

/// Find where to read every corner of the receiver so that no receiver triangle (or polygon) spans a seam.
///
/// The donor triangle under the centroid of the three images decides, unless another patch serves the neighbours better
/// and hardly less of the triangle (see vote_on_seams()): around it the donor is unfolded without crossing a seam, and
/// each corner is read in this patch, at its own image if that lies in it, else at the nearest point of the
/// patch, extended in the plane of its triangle. So seams run along receiver edges, also those inside one island (a
/// tube cut open along a line). Receiver triangles that share a corner and a patch read it in one place. A triangle is
/// unmatched if a corner is, or if its images are torn apart: over four times as long as the pair's median stretch
/// says, or not connected near each other. O(#F(receiver) x donor triangles under one of them).
/// \param donor_values 3 #F(donor) by k: the attribute whose jumps are the seams.
/// \return equal bit for bit for any number of threads. \param monitor may be null.
/// \throw InvalidInput on sizes, indices or values that do not fit; Cancelled if `monitor` asks for it.
CornerPlacement place_corners(const Correspondence& correspondence, const ReceiverMesh& receiver,
                              const DonorMesh& donor, const CornerValues& donor_values,
                              const CornerTransferOptions& options = {}, Monitor* monitor = nullptr);

/// Move UVs from the donor's corners to the receiver's; see place_corners().
TransferredUV transfer_corner_uv(const Correspondence& correspondence, const ReceiverMesh& receiver,
                                 const DonorMesh& donor, const CornerUV& donor_corner_uv,
                                 const CornerTransferOptions& options = {}, Monitor* monitor = nullptr);

/// Move any other corner attribute, such as colours, keeping its jumps; see place_corners().
///
/// Nothing is read beyond an island, whatever `options.extrapolation` says: values stay within the donor's range.
TransferredValues transfer_corner(const Correspondence& correspondence, const ReceiverMesh& receiver,
                                  const DonorMesh& donor, const CornerValues& donor_corner_values, TransferMode mode,
                                  const CornerTransferOptions& options = {}, Monitor* monitor = nullptr);

}  // namespace isograft
