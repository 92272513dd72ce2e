// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/geodesic.h"

#include <array>

#include "bindings.h"

namespace isograft::bindings {

void bind_geodesic(py::module_& m) {
    m.def(
        "geodesic_distances",
        [](const Surface& surface, int face, const std::array<double, 3>& barycentric) {
            Eigen::VectorXd distances;
            {
                const py::gil_scoped_release release;
                distances =
                    geodesic_distances(surface, face, Eigen::Vector3d(barycentric[0], barycentric[1], barycentric[2]));
            }
            return to_numpy(distances);
        },
        py::arg("surface"), py::arg("face"), py::arg("barycentric"));
}

}  // namespace isograft::bindings
