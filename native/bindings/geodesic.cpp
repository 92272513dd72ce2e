// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/geodesic.h"

#include <array>

#include "bindings.h"

namespace isograft::bindings {

void bind_geodesic(py::module_& m) {
    m.def(
        "geodesic_distances",
        [](const Surface& surface, int face, const std::array<double, 3>& barycentric, double radius) {
            Eigen::VectorXd distances;
            {
                const py::gil_scoped_release release;
                const Eigen::Vector3d weights(barycentric[0], barycentric[1], barycentric[2]);
                distances = geodesic_distances(surface, face, weights, radius);
            }
            return to_numpy(distances);
        },
        py::arg("surface"), py::arg("face"), py::arg("barycentric"), py::arg("radius"));
}

}  // namespace isograft::bindings
