// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/checks.h"

#include <cmath>
#include <sstream>

#include "isograft/errors.h"

namespace isograft {

namespace {

// Weights may have been stored in single precision.
constexpr double weight_tolerance = 1e-3;

// Count the rows that `bad` tells and throw if there are any.
template <class Bad>
void refuse_rows(Eigen::Index rows, const Bad& bad, const std::string& what, const std::string& remedy) {
    Eigen::Index count = 0, first = -1;
    for (Eigen::Index i = rows; i-- > 0;) {
        if (!bad(i)) continue;
        ++count;
        first = i;
    }
    if (count == 0) return;
    std::ostringstream text;
    text << what << " in " << count << (count == 1 ? " row" : " rows") << ", the first is row " << first << "; "
         << remedy;
    throw InvalidInput(text.str());
}

void refuse_length(Eigen::Index found, Eigen::Index expected, const std::string& name, const std::string& per) {
    if (found == expected) return;
    std::ostringstream text;
    text << "`" << name << "` has " << found << " rows, expected " << expected << ", one per " << per;
    throw InvalidInput(text.str());
}

}  // namespace

void check_finite(const CornerValues& values, const std::string& name) {
    refuse_rows(
        values.rows(), [&](Eigen::Index i) { return !values.row(i).array().isFinite().all(); },
        "`" + name + "` holds NaN or infinity", "give finite numbers");
}

void check_faces(const Triangles& faces, Eigen::Index vertex_count, const std::string& name) {
    if (faces.rows() > (Eigen::Index(1) << 29)) {
        throw ResourceLimit("`" + name + "` has " + std::to_string(faces.rows()) +
                            " triangles, at most 2^29 are possible");
    }
    refuse_rows(
        faces.rows(),
        [&](Eigen::Index f) { return faces.row(f).minCoeff() < 0 || faces.row(f).maxCoeff() >= vertex_count; },
        "`" + name + "` holds indices out of range", "indices must be 0 to " + std::to_string(vertex_count - 1));
}

void check_corner_values(const CornerValues& values, Eigen::Index face_count, const std::string& name) {
    refuse_length(values.rows(), 3 * face_count, name, "corner of the triangles");
    check_finite(values, name);
}

void check_correspondence(const Correspondence& correspondence, Eigen::Index donor_face_count) {
    const auto& face = correspondence.face;
    const auto& weights = correspondence.barycentric;
    refuse_length(weights.rows(), face.rows(), "barycentric", "row of `face`");
    refuse_length(correspondence.vertex.rows(), face.rows(), "vertex", "row of `face`");
    refuse_rows(
        face.rows(), [&](Eigen::Index i) { return face[i] < -1 || face[i] >= donor_face_count; },
        "the correspondence's `face` is out of range",
        "it must be -1 or one of the donor's " + std::to_string(donor_face_count) +
            " triangles: was the donor changed since the match?");
    refuse_rows(
        face.rows(),
        [&](Eigen::Index i) {
            return face[i] >= 0 && !(std::abs(weights.row(i).sum() - 1.0) <= weight_tolerance &&
                                     weights.row(i).minCoeff() >= -weight_tolerance);
        },
        "the correspondence's `barycentric` holds no weights", "matched rows must be >= 0 and sum to 1");
}

void check_placement(const Correspondence& correspondence, const ReceiverMesh& receiver, const DonorMesh& donor,
                     const CornerValues& donor_values) {
    check_faces(receiver.faces, receiver.vertices.rows(), "receiver_faces");
    check_faces(donor.faces, donor.vertices.rows(), "donor_faces");
    check_finite(receiver.vertices, "receiver_vertices");
    check_finite(donor.vertices, "donor_vertices");
    check_corner_values(donor_values, donor.faces.rows(), "donor corner values");
    check_correspondence(correspondence, donor.faces.rows());
    refuse_length(correspondence.face.rows(), receiver.vertices.rows(), "correspondence", "vertex of the receiver");
    if (receiver.polygons.rows() == 0) return;
    refuse_length(receiver.polygons.rows(), receiver.faces.rows(), "receiver_polygons", "triangle of the receiver");
    refuse_rows(
        receiver.polygons.rows(), [&](Eigen::Index f) { return receiver.polygons[f] < 0; },
        "`receiver_polygons` is negative", "number polygons from 0");
}

void check_values_known(const Points& vertices, const Triangles& faces, const CornerValues& values, const Mask& known) {
    check_faces(faces, vertices.rows(), "faces");
    check_finite(vertices, "vertices");
    const auto same = [&](Eigen::Index rows, const char* name) {
        if (rows == vertices.rows()) return;
        throw InvalidInput(std::string("`") + name + "` has " + std::to_string(rows) + " rows, expected " +
                           std::to_string(vertices.rows()) + ", one per vertex");
    };
    same(values.rows(), "values");
    same(known.rows(), "known");
    for (Eigen::Index v = 0; v < known.rows(); ++v) {
        if (!known[v] || values.row(v).array().isFinite().all()) continue;
        throw InvalidInput("`values` holds NaN or infinity in row " + std::to_string(v) + ", which is known");
    }
}

}  // namespace isograft
