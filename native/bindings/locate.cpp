// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/locate.h"

#include "transfer_arrays.h"

void bind_locate(py::module_& m) {
    using namespace isograft;
    using namespace isograft::bindings;
    m.def(
        "locate",
        [](const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
           const DoubleArray& receiver_vertices, const IntArray& receiver_faces, const DoubleArray& donor_vertices,
           const IntArray& donor_faces, const IntArray& point_faces, const DoubleArray& point_weights, int threads,
           const py::object& progress) {
            const Correspondence correspondence = to_correspondence(face, barycentric, vertex);
            const Points own = to_points(receiver_vertices, "receiver_vertices");
            const Points other = to_points(donor_vertices, "donor_vertices");
            const Triangles own_faces = to_triangles(receiver_faces, "receiver_faces");
            const Triangles other_faces = to_triangles(donor_faces, "donor_faces");
            const Eigen::VectorXi no_polygons;
            const SurfacePoints given{to_int_vector(point_faces), to_points(point_weights, "weights")};
            SurfacePoints found;
            run_with_progress(progress, [&](Monitor& monitor) {
                found = locate(correspondence, {own, own_faces, no_polygons}, {other, other_faces}, given, threads,
                               &monitor);
            });
            return py::make_tuple(to_numpy(found.face), to_numpy(found.weights));
        },
        py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("receiver_vertices"),
        py::arg("receiver_faces"), py::arg("donor_vertices"), py::arg("donor_faces"), py::arg("point_faces"),
        py::arg("point_weights"), py::arg("threads"), py::arg("progress"));
}
