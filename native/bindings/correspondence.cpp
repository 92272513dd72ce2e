// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/correspondence.h"

#include "bindings.h"

namespace isograft::bindings {

namespace {

template <class Vector>
Vector to_vector(const py::array_t<typename Vector::Scalar, py::array::c_style>& array, py::ssize_t rows,
                 const char* name) {
    if (array.ndim() != 1 || array.shape(0) != rows) {
        throw InvalidInput(std::string(name) + " must have shape (" + std::to_string(rows) + ",) like face");
    }
    return Eigen::Map<const Vector>(array.data(), rows);
}

Points to_rows(const DoubleArray& array, py::ssize_t rows, const char* name) {
    Points points = to_points(array, name);
    if (points.rows() != rows) {
        throw InvalidInput(std::string(name) + " has " + std::to_string(points.rows()) + " rows, face " +
                           std::to_string(rows));
    }
    return points;
}

}  // namespace

void bind_correspondence(py::module_& m) {
    using DoubleVector = py::array_t<double, py::array::c_style>;
    py::class_<Correspondence>(m, "Correspondence")
        .def(py::init([](const IntArray& face, const DoubleArray& barycentric, const DoubleArray& points,
                         const IntArray& vertex, const DoubleVector& confidence, const DoubleVector& stretch,
                         const IntArray& region) {
                 const py::ssize_t n = face.size();
                 Correspondence c;
                 c.face = to_vector<Eigen::VectorXi>(face, n, "face");
                 c.barycentric = to_rows(barycentric, n, "barycentric");
                 c.points = to_rows(points, n, "points");
                 c.vertex = to_vector<Eigen::VectorXi>(vertex, n, "vertex");
                 c.confidence = to_vector<Eigen::VectorXd>(confidence, n, "confidence");
                 c.stretch = to_vector<Eigen::VectorXd>(stretch, n, "stretch");
                 c.region = to_vector<Eigen::VectorXi>(region, n, "region");
                 return c;
             }),
             py::arg("face"), py::arg("barycentric"), py::arg("points"), py::arg("vertex"), py::arg("confidence"),
             py::arg("stretch"), py::arg("region"))
        .def_property_readonly("face", [](const Correspondence& c) { return to_numpy(c.face); })
        .def_property_readonly("corners", [](const Correspondence& c) { return to_numpy(c.corners); })
        .def_property_readonly("barycentric", [](const Correspondence& c) { return to_numpy(c.barycentric); })
        .def_property_readonly("points", [](const Correspondence& c) { return to_numpy(c.points); })
        .def_property_readonly("vertex", [](const Correspondence& c) { return to_numpy(c.vertex); })
        .def_property_readonly("confidence", [](const Correspondence& c) { return to_numpy(c.confidence); })
        .def_property_readonly("stretch", [](const Correspondence& c) { return to_numpy(c.stretch); })
        .def_property_readonly("region", [](const Correspondence& c) { return to_numpy(c.region); });
}

}  // namespace isograft::bindings
