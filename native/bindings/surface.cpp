// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/surface.h"

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.h"
#include "isograft/gate.h"

namespace isograft::bindings {

namespace {

void check_rows_of_three(const py::array& array, const std::string& name) {
    if (array.ndim() == 2 && array.shape(1) == 3) return;
    std::string shape;
    for (py::ssize_t i = 0; i < array.ndim(); ++i) shape += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
    throw InvalidInput(name + " must have shape (n, 3), not (" + shape + ")");
}

using PartsTuple = std::tuple<std::string, DoubleArray, py::object, py::object>;

std::vector<Surface> surfaces_of(const std::vector<PartsTuple>& list, int threads, const py::object& progress) {
    std::vector<SurfaceParts> parts;
    for (const auto& [name, vertices, faces, normals] : list) {
        SurfaceParts part;
        part.name = name;
        part.vertices = to_points(vertices, "vertices");
        part.is_cloud = faces.is_none();
        if (!part.is_cloud) part.faces = to_triangles(py::cast<IntArray>(faces), "faces");
        if (!normals.is_none()) part.normals = to_points(py::cast<DoubleArray>(normals), "normals");
        parts.push_back(std::move(part));
    }
    std::vector<Surface> made;
    run_with_progress(progress, [&](Monitor& monitor) { made = make_surfaces(std::move(parts), threads, &monitor); });
    return made;
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

    m.def("make_surfaces", &surfaces_of, py::arg("parts"), py::arg("threads"), py::arg("progress"));
}

}  // namespace isograft::bindings
