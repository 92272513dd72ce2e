// SPDX-License-Identifier: GPL-3.0-or-later
#include "isograft/fill.h"

#include <limits>
#include <string>
#include <vector>

#include "base/piece.h"
#include "isograft/errors.h"
#include "transfer/checks.h"
#include "transfer/laplacian.h"
#include "transfer/seams.h"
#include "transfer/thin_plate.h"
#include "transfer/vertex_graph.h"

namespace isograft {

TransferredValues fill_smooth(const Points& vertices, const Triangles& faces, const CornerValues& values,
                              const Mask& known, Monitor* monitor) {
    check_values_known(vertices, faces, values, known);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("fill", 0.0);
    const Unknowns unknowns(faces, known);
    TransferredValues filled{values, unknowns.mask()};
    if (unknowns.count() > 0) {
        const CornerValues solved =
            thin_plate(vertices, faces, laplacian(vertices, faces), unknowns, values, large_hole, Piece(watched, 1.0));
        for (Eigen::Index i = 0; i < unknowns.count(); ++i) filled.values.row(unknowns.vertex[i]) = solved.row(i);
    }
    watched.report("fill", 1.0);
    return filled;
}

Eigen::VectorXi nearest_known(const Points& vertices, const Triangles& faces, const Mask& known, Monitor* monitor) {
    check_values_known(vertices, faces, CornerValues(vertices.rows(), 0), known);
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("fill", 0.0);
    std::vector<int> sources;
    for (int v = 0; v < known.rows(); ++v) {
        if (known[v]) sources.push_back(v);
    }
    const VertexGraph graph(vertices, faces);
    watched.report("fill", 0.1);
    Eigen::VectorXi source = graph.nearest(sources, watched, 0.9);
    watched.report("fill", 1.0);
    return source;
}

Eigen::VectorXi corner_groups(const Triangles& faces, const CornerValues& values, double tolerance,
                              const Points& vertices, Monitor* monitor) {
    check_faces(faces, vertices.rows() > 0 ? vertices.rows() : std::numeric_limits<int>::max(), "faces");
    check_finite(vertices, "vertices");
    check_corner_values(values, faces.rows(), "corner values");
    Monitor silent;
    Monitor& watched = monitor != nullptr ? *monitor : silent;
    watched.report("groups", 0.0);
    const Triangles welded = weld(vertices, faces, &watched);
    watched.report("groups", 0.3);
    const SeamGraph graph = build_seam_graph(welded, values, tolerance, &watched);
    watched.report("groups", 0.9);
    Eigen::VectorXi group = group_corners(graph, welded, [](int, int) { return true; }, &watched);
    watched.report("groups", 1.0);
    return group;
}

}  // namespace isograft
