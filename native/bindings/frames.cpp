// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/frames.h"

#include <optional>

#include <pybind11/stl.h>

#include "transfer_arrays.h"

void bind_frames(py::module_& m) {
    using namespace isograft;
    using namespace isograft::bindings;
    m.def(
        "local_frames",
        [](const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
           const DoubleArray& receiver_vertices, const IntArray& receiver_faces, const DoubleArray& donor_vertices,
           const IntArray& donor_faces, std::optional<int> smoothing, int threads, const py::object& progress) {
            const Correspondence correspondence = to_correspondence(face, barycentric, vertex);
            const Points own = to_points(receiver_vertices, "receiver_vertices");
            const Points other = to_points(donor_vertices, "donor_vertices");
            const Triangles own_faces = to_triangles(receiver_faces, "receiver_faces");
            const Triangles other_faces = to_triangles(donor_faces, "donor_faces");
            const Eigen::VectorXi no_polygons;
            LocalFrames frames;
            run_with_progress(progress, [&](Monitor& monitor) {
                frames = local_frames(correspondence, {own, own_faces, no_polygons}, {other, other_faces},
                                      {smoothing, threads}, &monitor);
            });
            return py::make_tuple(to_numpy(frames.rotation), to_numpy(frames.scale), frames.median_scale,
                                  to_mask(frames.mask), frames.one_pose);
        },
        py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("receiver_vertices"),
        py::arg("receiver_faces"), py::arg("donor_vertices"), py::arg("donor_faces"), py::arg("smoothing"),
        py::arg("threads"), py::arg("progress"));
}
