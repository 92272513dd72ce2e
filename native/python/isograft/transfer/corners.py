# SPDX-License-Identifier: GPL-3.0-or-later
"""Values per point, UVs and values per corner."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.transfer.arrays import (
    CorrespondenceArrays,
    Mode,
    Progress,
    TransferredValues,
    as_type,
    corner_rows,
    correspondence_arrays,
    is_nearest,
    pick_rows,
    point_rows,
    polygon_ids,
    row_codes,
    triangle_rows,
    value_columns,
)


class TransferredUV(NamedTuple):
    """UVs moved along a correspondence."""

    uv: npt.NDArray[np.float64]
    """(3 F, 2), 0 where unmatched."""
    island: npt.NDArray[np.int32]
    """(F,) the donor's island as uv_islands(..., vertices=donor_vertices) numbers it, -1 where unmatched."""
    mask: npt.NDArray[np.bool_]
    """(F,) True where the triangle has UVs."""


def transfer_point(
    correspondence: CorrespondenceArrays,
    donor_faces: Any,
    values: Any,
    *,
    mode: Mode = "auto",
    progress: Progress | None = None,
) -> TransferredValues:
    """Move values from the donor's vertices to the receiver's.

    Args:
        correspondence: receiver to donor. Vertices with a `vertex` but no `face` (point-cloud donors) take the value
            of that vertex.
        donor_faces: (F, 3) triangles that `correspondence.face` counts; None for a point cloud.
        values: (V,) or (V, ...) per donor vertex: floats, integers, booleans or strings.
        mode: "barycentric" (weighted mean; integers are rounded), "nearest" (the corner with the largest weight), or
            "auto": barycentric for floats, nearest for anything else.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other.
        Cancelled: `progress` returned False.
    """
    data = np.asarray(values)
    if data.ndim == 0:
        raise _native.InvalidInput("values: expected one row per donor vertex, got a single value")
    face, barycentric, vertex = correspondence_arrays(correspondence)
    faces = triangle_rows(donor_faces, "donor_faces")
    if is_nearest(data, mode):
        # Whatever the type, the row number is moved and the rows are then picked.
        rows = np.arange(len(data), dtype=np.float64).reshape(-1, 1)
        moved, mask = _native.transfer_point(face, barycentric, vertex, faces, rows, True, progress)
        missing = np.nan if data.dtype.kind == "f" else None
        return TransferredValues(pick_rows(data, moved[:, 0], mask, missing), mask)
    moved, mask = _native.transfer_point(face, barycentric, vertex, faces, value_columns(data), False, progress)
    if data.dtype.kind != "f":
        moved[~mask] = 0.0
    return TransferredValues(as_type(moved, data, len(mask)), mask)


def uv_islands(
    faces: Any,
    corner_uv: Any,
    tolerance: float = 1e-6,
    *,
    vertices: Any = None,
    progress: Progress | None = None,
) -> npt.NDArray[np.int32]:
    """Island of every triangle: triangles are joined across an edge if the UVs at both of its ends agree.

    Folded, flipped and zero-area UV triangles join like any other; non-manifold edges join all that agree.

    Args:
        faces: (F, 3) triangles.
        corner_uv: (3 F, 2) or (F, 3, 2); any other corner values of floats do as well.
        tolerance: largest difference of UVs that are still equal.
        vertices: (V, 3); if given, vertices of equal position count as one.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        (F,) int32, islands numbered by their first triangle.

    Raises:
        InvalidInput: arrays that do not fit each other, values that are not finite.
        Cancelled: `progress` returned False.
    """
    triangles = triangle_rows(faces, "faces")
    corner_values = value_columns(corner_rows(corner_uv, len(triangles), "corner_uv"))
    points = np.zeros((0, 3)) if vertices is None else point_rows(vertices, "vertices")
    islands: npt.NDArray[np.int32] = _native.uv_islands(triangles, corner_values, tolerance, points, progress)
    return islands


def transfer_corner_uv(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_corner_uv: Any,
    *,
    receiver_polygons: Any = None,
    tolerance: float = 1e-6,
    extrapolation: float = 1.0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredUV:
    """Move UVs from the donor's corners to the receiver's with seams kept.

    No receiver triangle spans a seam of the donor, neither between two islands nor inside one (a tube cut open along a
    line): all of it is read in the patch of the donor around the image of its centroid, so that seams run along
    receiver edges.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3), n the length of the correspondence.
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_corner_uv: (3 G, 2) or (G, 3, 2).
        receiver_polygons: (F,) polygon of every receiver triangle; the triangles of one polygon are never parted by a
            seam and agree at the corners they share. None: every triangle for itself.
        tolerance: largest difference of UVs that are still equal.
        extrapolation: how far beyond the border of its island a corner may be read, in longest edges of the donor
            triangle there. 0 keeps all UVs inside the islands.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        UVs per receiver corner, the island and a mask per receiver triangle. Triangles with an unmatched corner, or
        torn apart by the correspondence, are unmatched.

    Raises:
        InvalidInput: arrays that do not fit each other, values that are not finite.
    """
    faces = triangle_rows(donor_faces, "donor_faces")
    uv = value_columns(corner_rows(donor_corner_uv, len(faces), "donor_corner_uv"))
    if uv.shape[1] != 2:
        raise _native.InvalidInput(f"donor_corner_uv: expected 2 columns, got {uv.shape[1]}")
    return TransferredUV(
        *_native.transfer_corner_uv(
            *correspondence_arrays(correspondence),
            point_rows(receiver_vertices, "receiver_vertices"),
            triangle_rows(receiver_faces, "receiver_faces"),
            polygon_ids(receiver_polygons),
            point_rows(donor_vertices, "donor_vertices"),
            faces,
            uv,
            tolerance,
            extrapolation,
            threads or 0,
            progress,
        )
    )


def transfer_corner(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_corner_values: Any,
    *,
    mode: Mode = "auto",
    receiver_polygons: Any = None,
    tolerance: float = 1e-6,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move any other corner attribute, such as colours, keeping its jumps.

    An edge across which the attribute jumps is treated as a seam: see transfer_corner_uv, whose arguments these are.
    Values stay within the donor's.

    Args:
        donor_corner_values: (3 G,), (3 G, ...) or (G, 3, ...): floats, integers, booleans or strings. An array of shape
            (3, 3, ...) for a single triangle is read as (3 G, ...).
        mode: as for transfer_point.
        tolerance: largest difference of floats that are still equal; other types are compared exactly.

    Returns:
        Values of shape (3 F,) or (3 F, ...) and a mask per receiver triangle.

    Raises:
        InvalidInput: arrays that do not fit each other, values that are not finite.
    """
    faces = triangle_rows(donor_faces, "donor_faces")
    data = corner_rows(donor_corner_values, len(faces), "donor_corner_values")
    nearest = is_nearest(data, mode)
    if data.dtype.kind == "f":
        seams = value_columns(data)
    else:
        seams = row_codes(data)
        tolerance = 0.0
    triangle, weights, _, mask = _native.place_corners(
        *correspondence_arrays(correspondence),
        point_rows(receiver_vertices, "receiver_vertices"),
        triangle_rows(receiver_faces, "receiver_faces"),
        polygon_ids(receiver_polygons),
        point_rows(donor_vertices, "donor_vertices"),
        faces,
        seams,
        tolerance,
        0.0,
        threads or 0,
        progress,
    )
    corners = np.repeat(mask, 3)
    if nearest:
        return TransferredValues(pick_rows(data, 3 * triangle + weights.argmax(axis=1), corners), mask)
    columns = value_columns(data).reshape(len(faces), 3, -1) if data.size else np.zeros((len(faces), 3, 0))
    around = columns[triangle[corners]]
    moved = np.zeros((len(triangle), columns.shape[2]))
    # Rounding may not lead out of the range either: a mean of equal values is that value.
    mean = np.einsum("ij,ijk->ik", weights[corners], around)
    moved[corners] = np.clip(mean, around.min(axis=1), around.max(axis=1))
    return TransferredValues(as_type(moved, data, len(triangle)), mask)
