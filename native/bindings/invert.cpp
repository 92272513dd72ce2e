// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/invert.h"

#include "transfer_arrays.h"

namespace {

using namespace isograft;
using namespace isograft::bindings;

Eigen::VectorXd to_vector(const DoubleArray& array) {
    return Eigen::Map<const Eigen::VectorXd>(array.data(), array.size());
}

}  // namespace

void bind_invert(py::module_& m) {
    m.def(
        "invert",
        [](const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex, const DoubleArray& confidence,
           const DoubleArray& stretch, const IntArray& region, const DoubleArray& source_vertices,
           const IntArray& source_faces, const DoubleArray& target_vertices, const IntArray& target_faces, int threads,
           const py::object& progress) {
            Correspondence forward = to_correspondence(face, barycentric, vertex);
            forward.confidence = to_vector(confidence);
            forward.stretch = to_vector(stretch);
            forward.region = to_int_vector(region);
            const Points from = to_points(source_vertices, "source_vertices");
            const Points to = to_points(target_vertices, "target_vertices");
            const Triangles from_faces = to_triangles(source_faces, "source_faces");
            const Triangles to_faces = to_triangles(target_faces, "target_faces");
            const Eigen::VectorXi no_polygons;
            Correspondence inverse;
            run_with_progress(progress, [&](Monitor& monitor) {
                inverse = invert(forward, {from, from_faces, no_polygons}, {to, to_faces}, threads, &monitor);
            });
            return inverse;
        },
        py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("confidence"), py::arg("stretch"),
        py::arg("region"), py::arg("source_vertices"), py::arg("source_faces"), py::arg("target_vertices"),
        py::arg("target_faces"), py::arg("threads"), py::arg("progress"));
}
