// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/transfer.h"

#include "transfer_arrays.h"

namespace {

using namespace isograft;
using namespace isograft::bindings;

// What place_corners() and transfer_corner_uv() are given, as values of their own: Python may run meanwhile.
struct Request {
    Correspondence correspondence;
    Points receiver_vertices;
    Triangles receiver_faces;
    Eigen::VectorXi receiver_polygons;
    Points donor_vertices;
    Triangles donor_faces;
    CornerValues donor_values;
    CornerTransferOptions options;

    Request(const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
            const DoubleArray& given_receiver_vertices, const IntArray& given_receiver_faces,
            const IntArray& given_receiver_polygons, const DoubleArray& given_donor_vertices,
            const IntArray& given_donor_faces, const DoubleArray& given_donor_values, double tolerance,
            double extrapolation, int threads)
        : correspondence(to_correspondence(face, barycentric, vertex)),
          receiver_vertices(to_points(given_receiver_vertices, "receiver_vertices")),
          receiver_faces(to_triangles(given_receiver_faces, "receiver_faces")),
          receiver_polygons(
              Eigen::Map<const Eigen::VectorXi>(given_receiver_polygons.data(), given_receiver_polygons.size())),
          donor_vertices(to_points(given_donor_vertices, "donor_vertices")),
          donor_faces(to_triangles(given_donor_faces, "donor_faces")),
          donor_values(to_values(given_donor_values, "donor corner values")),
          options{tolerance, extrapolation, threads} {}

    [[nodiscard]] ReceiverMesh receiver() const { return {receiver_vertices, receiver_faces, receiver_polygons}; }
    [[nodiscard]] DonorMesh donor() const { return {donor_vertices, donor_faces}; }
};

template <class... Arguments>
void bind(py::module_& m, const char* name, py::tuple (*function)(Arguments...)) {
    m.def(name, function, py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("receiver_vertices"),
          py::arg("receiver_faces"), py::arg("receiver_polygons"), py::arg("donor_vertices"), py::arg("donor_faces"),
          py::arg("donor_values"), py::arg("tolerance"), py::arg("extrapolation"), py::arg("threads"),
          py::arg("progress"));
}

py::tuple bound_place_corners(const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
                              const DoubleArray& receiver_vertices, const IntArray& receiver_faces,
                              const IntArray& receiver_polygons, const DoubleArray& donor_vertices,
                              const IntArray& donor_faces, const DoubleArray& donor_values, double tolerance,
                              double extrapolation, int threads, const py::object& progress) {
    const Request request(face, barycentric, vertex, receiver_vertices, receiver_faces, receiver_polygons,
                          donor_vertices, donor_faces, donor_values, tolerance, extrapolation, threads);
    CornerPlacement placement;
    run_with_progress(progress, [&](Monitor& monitor) {
        placement = place_corners(request.correspondence, request.receiver(), request.donor(), request.donor_values,
                                  request.options, &monitor);
    });
    return py::make_tuple(to_numpy(placement.triangle), to_numpy(placement.weights), to_numpy(placement.island),
                          to_mask(placement.mask));
}

py::tuple bound_transfer_corner_uv(const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex,
                                   const DoubleArray& receiver_vertices, const IntArray& receiver_faces,
                                   const IntArray& receiver_polygons, const DoubleArray& donor_vertices,
                                   const IntArray& donor_faces, const DoubleArray& donor_values, double tolerance,
                                   double extrapolation, int threads, const py::object& progress) {
    const Request request(face, barycentric, vertex, receiver_vertices, receiver_faces, receiver_polygons,
                          donor_vertices, donor_faces, donor_values, tolerance, extrapolation, threads);
    if (request.donor_values.cols() != 2) {
        throw InvalidInput("donor_corner_uv must have 2 columns, got " + std::to_string(request.donor_values.cols()));
    }
    const CornerUV uv = request.donor_values;
    TransferredUV moved;
    run_with_progress(progress, [&](Monitor& monitor) {
        moved = transfer_corner_uv(request.correspondence, request.receiver(), request.donor(), uv, request.options,
                                   &monitor);
    });
    return py::make_tuple(to_numpy(moved.uv), to_numpy(moved.island), to_mask(moved.mask));
}

}  // namespace

void bind_transfer(py::module_& m) {
    m.def(
        "transfer_point",
        [](const IntArray& face, const DoubleArray& barycentric, const IntArray& vertex, const IntArray& donor_faces,
           const DoubleArray& values, bool nearest, const py::object& progress) {
            const Correspondence correspondence = to_correspondence(face, barycentric, vertex);
            const Triangles faces = to_triangles(donor_faces, "donor_faces");
            const CornerValues given = to_values(values, "values");
            const TransferMode mode = nearest ? TransferMode::nearest : TransferMode::barycentric;
            TransferredValues moved;
            run_with_progress(progress, [&](Monitor& monitor) {
                moved = transfer_point(correspondence, faces, given, mode, &monitor);
            });
            return py::make_tuple(to_numpy(moved.values), to_mask(moved.mask));
        },
        py::arg("face"), py::arg("barycentric"), py::arg("vertex"), py::arg("donor_faces"), py::arg("values"),
        py::arg("nearest"), py::arg("progress"));
    m.def(
        "uv_islands",
        [](const IntArray& faces, const DoubleArray& values, double tolerance, const DoubleArray& vertices,
           const py::object& progress) {
            const Triangles triangles = to_triangles(faces, "faces");
            const CornerValues given = to_values(values, "corner values");
            const Points points = to_points(vertices, "vertices");
            Eigen::VectorXi islands;
            run_with_progress(progress, [&](Monitor& monitor) {
                islands = uv_islands(triangles, given, tolerance, points, &monitor);
            });
            return to_numpy(islands);
        },
        py::arg("faces"), py::arg("values"), py::arg("tolerance"), py::arg("vertices"), py::arg("progress"));
    bind(m, "place_corners", &bound_place_corners);
    bind(m, "transfer_corner_uv", &bound_transfer_corner_uv);
}
