# SPDX-License-Identifier: GPL-3.0-or-later
"""Move what a donor carries along a correspondence: values per point, UVs and values per corner.

The receiver is the source S of the correspondence, the donor its target T. Corner arrays have one row per corner of the
triangles: row 3 f + c belongs to corner c of triangle f; (F, 3, ...) arrays are taken as well.
"""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from isograft import _native

Mode = Literal["auto", "barycentric", "nearest"]
Array = npt.NDArray[Any]

__all__ = [
    "TransferredUV",
    "TransferredValues",
    "transfer_corner",
    "transfer_corner_uv",
    "transfer_point",
    "uv_islands",
]


class CorrespondenceArrays(Protocol):
    """What is read of a Correspondence: any object with these arrays will do."""

    @property
    def face(self) -> Any:
        """(n,) index into the donor's triangles, -1 = unmatched."""

    @property
    def barycentric(self) -> Any:
        """(n, 3) weights of that triangle's corners."""

    @property
    def vertex(self) -> Any:
        """(n,) nearest donor vertex or -1."""


class TransferredValues(NamedTuple):
    """Values moved along a correspondence."""

    values: Array
    """One row per receiver vertex (transfer_point) or corner (transfer_corner), of the donor values' dtype. Where
    unmatched: NaN in floats per vertex, else 0, False or an empty string."""
    mask: npt.NDArray[np.bool_]
    """True where matched: one entry per receiver vertex (transfer_point) or triangle (transfer_corner)."""


class TransferredUV(NamedTuple):
    """UVs moved along a correspondence."""

    uv: npt.NDArray[np.float64]
    """(3 F, 2), 0 where unmatched."""
    island: npt.NDArray[np.int32]
    """(F,) the donor's island as uv_islands(..., vertices=donor_vertices) numbers it, -1 where unmatched."""
    mask: npt.NDArray[np.bool_]
    """(F,) True where the triangle has UVs."""


def transfer_point(
    correspondence: CorrespondenceArrays, donor_faces: Any, values: Any, *, mode: Mode = "auto"
) -> TransferredValues:
    """Move values from the donor's vertices to the receiver's.

    Args:
        correspondence: receiver to donor. Vertices with a `vertex` but no `face` (point-cloud donors) take the value
            of that vertex.
        donor_faces: (F, 3) triangles that `correspondence.face` counts; None for a point cloud.
        values: (V,) or (V, ...) per donor vertex: floats, integers, booleans or strings.
        mode: "barycentric" (weighted mean; integers are rounded), "nearest" (the corner with the largest weight), or
            "auto": barycentric for floats, nearest for anything else.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    data = np.asarray(values)
    if data.ndim == 0:
        raise _native.InvalidInput("values: expected one row per donor vertex, got a single value")
    face, barycentric, vertex = _correspondence(correspondence)
    faces = _triangles(donor_faces, "donor_faces")
    if _nearest(data, mode):
        # Whatever the type, the row number is moved and the rows are then picked.
        rows = np.arange(len(data), dtype=np.float64).reshape(-1, 1)
        moved, mask = _native.transfer_point(face, barycentric, vertex, faces, rows, True)
        missing = np.nan if data.dtype.kind == "f" else None
        return TransferredValues(_pick(data, moved[:, 0], mask, missing), mask)
    moved, mask = _native.transfer_point(face, barycentric, vertex, faces, _columns(data), False)
    if data.dtype.kind != "f":
        moved[~mask] = 0.0
    return TransferredValues(_as_type(moved, data, len(mask)), mask)


def uv_islands(faces: Any, corner_uv: Any, tolerance: float = 1e-6, *, vertices: Any = None) -> npt.NDArray[np.int32]:
    """Island of every triangle: triangles are joined across an edge if the UVs at both of its ends agree.

    Folded, flipped and zero-area UV triangles join like any other; non-manifold edges join all that agree.

    Args:
        faces: (F, 3) triangles.
        corner_uv: (3 F, 2) or (F, 3, 2); any other corner values of floats do as well.
        tolerance: largest difference of UVs that are still equal.
        vertices: (V, 3); if given, vertices of equal position count as one.

    Returns:
        (F,) int32, islands numbered by their first triangle.

    Raises:
        InvalidInput: arrays that do not fit each other, values that are not finite.
    """
    triangles = _triangles(faces, "faces")
    corner_values = _columns(_corner_rows(corner_uv, len(triangles), "corner_uv"))
    points = np.zeros((0, 3)) if vertices is None else _points(vertices, "vertices")
    islands: npt.NDArray[np.int32] = _native.uv_islands(triangles, corner_values, tolerance, points)
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

    Returns:
        UVs per receiver corner, the island and a mask per receiver triangle. Triangles with an unmatched corner, or
        torn apart by the correspondence, are unmatched.

    Raises:
        InvalidInput: arrays that do not fit each other, values that are not finite.
    """
    faces = _triangles(donor_faces, "donor_faces")
    uv = _columns(_corner_rows(donor_corner_uv, len(faces), "donor_corner_uv"))
    if uv.shape[1] != 2:
        raise _native.InvalidInput(f"donor_corner_uv: expected 2 columns, got {uv.shape[1]}")
    return TransferredUV(
        *_native.transfer_corner_uv(
            *_correspondence(correspondence),
            _points(receiver_vertices, "receiver_vertices"),
            _triangles(receiver_faces, "receiver_faces"),
            _polygons(receiver_polygons),
            _points(donor_vertices, "donor_vertices"),
            faces,
            uv,
            tolerance,
            extrapolation,
            threads or 0,
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
    faces = _triangles(donor_faces, "donor_faces")
    data = _corner_rows(donor_corner_values, len(faces), "donor_corner_values")
    nearest = _nearest(data, mode)
    if data.dtype.kind == "f":
        seams = _columns(data)
    else:
        seams = _codes(data)
        tolerance = 0.0
    triangle, weights, _, mask = _native.place_corners(
        *_correspondence(correspondence),
        _points(receiver_vertices, "receiver_vertices"),
        _triangles(receiver_faces, "receiver_faces"),
        _polygons(receiver_polygons),
        _points(donor_vertices, "donor_vertices"),
        faces,
        seams,
        tolerance,
        0.0,
        threads or 0,
    )
    corners = np.repeat(mask, 3)
    if nearest:
        return TransferredValues(_pick(data, 3 * triangle + weights.argmax(axis=1), corners), mask)
    columns = _columns(data).reshape(len(faces), 3, -1) if data.size else np.zeros((len(faces), 3, 0))
    around = columns[triangle[corners]]
    moved = np.zeros((len(triangle), columns.shape[2]))
    # Rounding may not lead out of the range either: a mean of equal values is that value.
    mean = np.einsum("ij,ijk->ik", weights[corners], around)
    moved[corners] = np.clip(mean, around.min(axis=1), around.max(axis=1))
    return TransferredValues(_as_type(moved, data, len(triangle)), mask)


def _correspondence(correspondence: CorrespondenceArrays) -> tuple[Array, Array, Array]:
    face = np.ascontiguousarray(correspondence.face, dtype=np.int32)
    barycentric = np.ascontiguousarray(correspondence.barycentric, dtype=np.float64)
    vertex = np.ascontiguousarray(correspondence.vertex, dtype=np.int32)
    if face.ndim != 1 or vertex.shape != face.shape or barycentric.shape != (len(face), 3):
        raise _native.InvalidInput(
            "correspondence: expected face (n,), barycentric (n, 3) and vertex (n,), "
            f"got {face.shape}, {barycentric.shape} and {vertex.shape}"
        )
    return face, barycentric, vertex


def _points(points: Any, name: str) -> Array:
    array = np.ascontiguousarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise _native.InvalidInput(f"{name}: expected shape (n, 3), got {array.shape}")
    return array


def _triangles(faces: Any, name: str) -> Array:
    if faces is None:
        return np.zeros((0, 3), dtype=np.int32)
    array = np.asarray(faces)
    if array.ndim != 2 or array.shape[1] != 3 or (array.size and array.dtype.kind not in "iu"):
        raise _native.InvalidInput(f"{name}: expected integers of shape (n, 3), got {array.dtype} {array.shape}")
    if array.size and (array.max() > np.iinfo(np.int32).max or array.min() < np.iinfo(np.int32).min):
        raise _native.InvalidInput(f"{name}: indices do not fit 32 bits")
    return np.ascontiguousarray(array, dtype=np.int32)


def _polygons(polygons: Any) -> Array:
    array = np.zeros(0, dtype=np.int32) if polygons is None else np.asarray(polygons)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise _native.InvalidInput(
            f"receiver_polygons: expected integers of shape (n,), got {array.dtype} {array.shape}"
        )
    return np.ascontiguousarray(array, dtype=np.int32)


def _corner_rows(values: Any, count: int, name: str) -> Array:
    """Corner values as 3 `count` rows, whatever of the two layouts they came in."""
    array = np.asarray(values)
    if array.ndim >= 1 and len(array) == 3 * count:
        return array
    if array.ndim >= 2 and array.shape[:2] == (count, 3):
        return array.reshape(3 * count, *array.shape[2:])
    raise _native.InvalidInput(
        f"{name}: expected {3 * count} rows, one per corner of {count} triangles, got shape {array.shape}"
    )


def _columns(data: Array) -> Array:
    return np.ascontiguousarray(data.reshape(len(data), int(np.prod(data.shape[1:]))), dtype=np.float64)


def _codes(data: Array) -> Array:
    """Numbers that are equal exactly where whole rows are: compared instead of integers, booleans and strings."""
    codes = np.zeros(len(data), dtype=np.int64)
    for column in data.reshape(len(data), int(np.prod(data.shape[1:]))).T:
        values, code = np.unique(column, return_inverse=True)
        _, codes = np.unique(codes * len(values) + code, return_inverse=True)
    return codes.astype(np.float64).reshape(-1, 1)


def _nearest(data: Array, mode: str) -> bool:
    if mode not in ("auto", "barycentric", "nearest"):
        raise _native.InvalidInput(f"mode: expected auto, barycentric or nearest, got {mode!r}")
    if mode == "barycentric" and data.dtype.kind not in "fiu":
        raise _native.InvalidInput(f"mode: values of type {data.dtype} have no mean, use nearest")
    return mode == "nearest" or (mode == "auto" and data.dtype.kind != "f")


def _pick(data: Array, rows: Array, mask: Array, missing: float | None = None) -> Array:
    picked = np.zeros((len(mask), *data.shape[1:]), dtype=data.dtype)
    if missing is not None:
        picked[~mask] = missing
    picked[mask] = data[rows[mask].astype(np.intp)]
    return picked


def _as_type(moved: Array, data: Array, count: int) -> Array:
    if data.dtype.kind in "iu":
        limits = np.iinfo(data.dtype)
        moved = np.clip(np.rint(moved), limits.min, limits.max)
    return moved.astype(data.dtype).reshape(count, *data.shape[1:])
