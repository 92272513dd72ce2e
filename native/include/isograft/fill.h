// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "isograft/monitor.h"
#include "isograft/transfer.h"

namespace isograft {

/// Continue values smoothly into the vertices that have none: their bi-Laplacian is zero there (thin plates), and what
/// is known stays as it is.
///
/// Connected parts without any known vertex, and vertices of no triangle, keep the values they came with.
/// One sparse Cholesky factorisation of the unknown vertices for all columns: near O(n log n) for bands and small
/// holes. With a hole of more than 50,000 vertices only where its time is nearly linear (sheets up to some 110,000,
/// bodies up to some 300,000); else nearly, by a reduced space and a fixed number of conjugate gradients: near O(n log
/// n), within 4e-3 of the largest value on sheets, but 0.25 on bodies of which little is known. Linear functions of a
/// plane are kept by both in holes that do not reach the border of the surface.
/// \param values #V by k, finite where `known`. \param known #V. \param monitor may be null.
/// \return values, and in the mask which vertices were filled.
/// \throw InvalidInput on sizes, indices or values that do not fit; Cancelled.
TransferredValues fill_smooth(const Points& vertices, const Triangles& faces, const CornerValues& values,
                              const Mask& known, Monitor* monitor = nullptr);

/// The nearest known vertex along the edges, for values that have no mean.
/// O(#F log #F). \param monitor may be null.
/// \return #V: known vertices themselves; -1 where no path leads to one. Of equally near ones the lowest.
/// \throw InvalidInput on sizes or indices that do not fit; Cancelled.
Eigen::VectorXi nearest_known(const Points& vertices, const Triangles& faces, const Mask& known,
                              Monitor* monitor = nullptr);

/// Which corners at a vertex are joined by edges across which a corner attribute does not jump.
/// \param values 3 #F by k. \param vertices as in uv_islands(). \param monitor may be null.
/// \return 3 #F: numbers from 0, one per group. O(#F log #F). \throw as uv_islands().
Eigen::VectorXi corner_groups(const Triangles& faces, const CornerValues& values, double tolerance,
                              const Points& vertices = Points(), Monitor* monitor = nullptr);

/// Options of complete_rigid().
struct CompletionOptions {
    /// Rounds of fitting rotations and solving for positions; it ends sooner when nothing moves any more.
    int iterations = 50;

    /// \throw InvalidInput naming the first field that is out of range.
    void validate() const;
};

/// Place the unknown vertices of a mesh so that it is bent and not stretched: as-rigid-as-possible (Sorkine and Alexa
/// 2007), started from fill_smooth() of the displacements.
///
/// Large holes nearly, as fill_smooth(): near O(n log n).
/// \param rest #V by 3, the shape to keep. \param placed #V by 3, where `known` vertices are.
/// \param scale size of the result against `rest`. \return #V by 3 and which were filled; parts without any known
/// vertex keep `placed`. \throw as fill_smooth().
TransferredValues complete_rigid(const Points& rest, const Triangles& faces, const Points& placed, const Mask& known,
                                 double scale, const CompletionOptions& options = {}, Monitor* monitor = nullptr);

}  // namespace isograft
