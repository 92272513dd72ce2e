// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/surface.h"

#include <utility>

#include "bindings.h"

namespace isograft::bindings {

namespace {

void check_rows_of_three(const py::array& array, const std::string& name) {
    if (array.ndim() == 2 && array.shape(1) == 3) return;
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
    throw InvalidInput(name + " must have shape (n, 3), not (" + shape + ")");
}

}  // namespace

Points to_points(const DoubleArray& array, const std::string& name) {
    check_rows_of_three(array, name);
    return Eigen::Map<const Points>(array.data(), array.shape(0), 3);
}

Triangles to_triangles(const IntArray& array, const std::string& name) {
    check_rows_of_three(array, name);
    return Eigen::Map<const Triangles>(array.data(), array.shape(0), 3);
}

void bind_surface(py::module_& m) {
    py::class_<Surface>(m, "Surface")
        .def(py::init([](const DoubleArray& vertices, const IntArray& faces) {
                 Points points = to_points(vertices, "vertices");
                 Triangles triangles = to_triangles(faces, "faces");
                 const py::gil_scoped_release release;
                 return Surface::from_mesh(std::move(points), std::move(triangles));
             }),
             py::arg("vertices"), py::arg("faces"))
        .def_static(
            "from_points",
            [](const DoubleArray& vertices, const py::object& normals) {
                Points points = to_points(vertices, "vertices");
                const Points sides = normals.is_none() ? Points(0, 3) : to_points(normals, "normals");
                const py::gil_scoped_release release;
                return Surface::from_points(std::move(points), sides);
            },
            py::arg("vertices"), py::arg("normals"))
        .def_property_readonly("is_cloud", &Surface::is_cloud)
        .def_property_readonly("normals", [](const Surface& s) { return to_numpy(s.normals()); })
        .def_property_readonly("working_mesh",
                               [](const Surface& s) {
                                   const auto [vertices, faces] = s.working_mesh();
                                   return py::make_tuple(to_numpy(vertices), to_numpy(faces));
                               })
        .def_property_readonly("vertices", [](const Surface& s) { return to_numpy(s.vertices()); })
        .def_property_readonly("faces", [](const Surface& s) { return to_numpy(s.faces()); })
        .def_property_readonly("warnings", &Surface::warnings)
        .def_property_readonly("orientation_is_ambiguous", &Surface::orientation_is_ambiguous);
}

}  // namespace isograft::bindings
