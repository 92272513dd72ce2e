// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/fill.h"

#include "transfer_arrays.h"

namespace {

using namespace isograft;
using namespace isograft::bindings;

using BoolArray = py::array_t<bool, py::array::c_style>;

Mask to_known(const BoolArray& array) { return Eigen::Map<const Mask>(array.data(), array.size()); }

}  // namespace

void bind_fill(py::module_& m) {
    m.def(
        "fill_smooth",
        [](const DoubleArray& vertices, const IntArray& faces, const DoubleArray& values, const BoolArray& known,
           const py::object& progress) {
            const Points points = to_points(vertices, "vertices");
            const Triangles triangles = to_triangles(faces, "faces");
            const CornerValues given = to_values(values, "values");
            const Mask mask = to_known(known);
            TransferredValues filled;
            run_with_progress(
                progress, [&](Monitor& monitor) { filled = fill_smooth(points, triangles, given, mask, &monitor); });
            return py::make_tuple(to_numpy(filled.values), to_mask(filled.mask));
        },
        py::arg("vertices"), py::arg("faces"), py::arg("values"), py::arg("known"), py::arg("progress"));
    m.def(
        "nearest_known",
        [](const DoubleArray& vertices, const IntArray& faces, const BoolArray& known, const py::object& progress) {
            const Points points = to_points(vertices, "vertices");
            const Triangles triangles = to_triangles(faces, "faces");
            const Mask mask = to_known(known);
            Eigen::VectorXi source;
            run_with_progress(progress,
                              [&](Monitor& monitor) { source = nearest_known(points, triangles, mask, &monitor); });
            return to_numpy(source);
        },
        py::arg("vertices"), py::arg("faces"), py::arg("known"), py::arg("progress"));
    m.def(
        "corner_groups",
        [](const IntArray& faces, const DoubleArray& values, double tolerance, const DoubleArray& vertices,
           const py::object& progress) {
            const Triangles triangles = to_triangles(faces, "faces");
            const CornerValues given = to_values(values, "corner values");
            const Points points = to_points(vertices, "vertices");
            Eigen::VectorXi groups;
            run_with_progress(progress, [&](Monitor& monitor) {
                groups = corner_groups(triangles, given, tolerance, points, &monitor);
            });
            return to_numpy(groups);
        },
        py::arg("faces"), py::arg("values"), py::arg("tolerance"), py::arg("vertices"), py::arg("progress"));
    m.def(
        "complete_rigid",
        [](const DoubleArray& rest, const IntArray& faces, const DoubleArray& placed, const BoolArray& known,
           double scale, int iterations, const py::object& progress) {
            const Points shape = to_points(rest, "rest"), places = to_points(placed, "placed");
            const Triangles triangles = to_triangles(faces, "faces");
            const Mask mask = to_known(known);
            TransferredValues completed;
            run_with_progress(progress, [&](Monitor& monitor) {
                completed = complete_rigid(shape, triangles, places, mask, scale, {iterations}, &monitor);
            });
            return py::make_tuple(to_numpy(completed.values), to_mask(completed.mask));
        },
        py::arg("rest"), py::arg("faces"), py::arg("placed"), py::arg("known"), py::arg("scale"), py::arg("iterations"),
        py::arg("progress"));
}
