// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "isograft/transfer.h"

namespace isograft {

/// \throw InvalidInput naming `name` and how many coordinates are not finite.
void check_finite(const CornerValues& values, const std::string& name);
/// \throw InvalidInput if an index is not in [0, vertex_count). \throw ResourceLimit above 2^29 triangles.
void check_faces(const Triangles& faces, Eigen::Index vertex_count, const std::string& name);
/// \throw InvalidInput unless there is one row per corner of `face_count` triangles and all are finite.
void check_corner_values(const CornerValues& values, Eigen::Index face_count, const std::string& name);
/// \throw InvalidInput unless matched rows point into `donor_face_count` triangles with weights >= 0 that sum to 1, and
/// the other arrays are as long as `face`.
void check_correspondence(const Correspondence& correspondence, Eigen::Index donor_face_count);
/// \throw InvalidInput unless faces and vertices fit, and there is one row of values, finite where known, per vertex.
void check_values_known(const Points& vertices, const Triangles& faces, const CornerValues& values, const Mask& known);
/// All of what place_corners() is given.
void check_placement(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                     const CornerValues& donor_values);

}  // namespace isograft
