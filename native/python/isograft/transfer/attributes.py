# SPDX-License-Identifier: GPL-3.0-or-later
"""Points anywhere on the surface, and values of faces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    TransferredValues,
    check_indices,
    correspondence_arrays,
    pick_rows,
    point_rows,
    polygon_ids,
    triangle_rows,
)


class Located(NamedTuple):
    """Points of the donor."""

    face: npt.NDArray[np.int32]
    """(q,) donor triangle, -1 where the receiver's triangle is unmatched or torn."""
    barycentric: npt.NDArray[np.float64]
    """(q, 3) weights of its corners, 0 where there is none."""


def locate(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    face: Any,
    barycentric: Any,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Located:
    """The donor's point for any points of the receiver's triangles: `face` (q,) and `barycentric` (q, 3).

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    return Located(
        *_native.locate(
            *correspondence_arrays(correspondence),
            point_rows(receiver_vertices, "receiver_vertices"),
            triangle_rows(receiver_faces, "receiver_faces"),
            point_rows(donor_vertices, "donor_vertices"),
            triangle_rows(donor_faces, "donor_faces"),
            polygon_ids(face, "face"),
            point_rows(barycentric, "barycentric"),
            threads or 0,
            progress,
        )
    )


def transfer_face(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_values: npt.ArrayLike,
    *,
    receiver_polygons: Any = None,
    donor_polygons: Any = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move values of faces: material indices, face sets, flags, of any type.

    A face takes the value of the donor's face under its centre.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_values: (P,) or (P, ...) one row per donor polygon, without polygons per donor triangle.
        receiver_polygons: (F,) polygon of every receiver triangle; None: every triangle is a face.
        donor_polygons: (G,) likewise of the donor.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        One row per receiver polygon (0, False or an empty string where unmatched), and which have a value.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    data = np.asarray(donor_values)
    vertices = point_rows(receiver_vertices, "receiver_vertices")
    faces = triangle_rows(receiver_faces, "receiver_faces")
    other_faces = triangle_rows(donor_faces, "donor_faces")
    source = _polygon_of(donor_polygons, len(other_faces), "donor_polygons")
    polygons = _polygon_of(receiver_polygons, len(faces), "receiver_polygons")
    if data.ndim == 0 or len(data) <= int(source.max(initial=-1)):
        raise _native.InvalidInput(
            f"donor_values: expected at least {int(source.max(initial=-1)) + 1} rows, one per face of the donor, got "
            f"shape {data.shape}"
        )
    check_indices(faces, len(vertices), "receiver_faces")
    triangle, weights = _centres(vertices, faces, polygons)
    found = locate(
        correspondence,
        vertices,
        faces,
        donor_vertices,
        other_faces,
        triangle,
        weights,
        threads=threads,
        progress=progress,
    )
    mask = found.face >= 0
    rows = np.zeros(len(mask), np.int64)
    rows[mask] = source[found.face[mask]]
    return TransferredValues(pick_rows(data, rows, mask), mask)


def _polygon_of(polygons: Any, count: int, name: str) -> Array:
    if polygons is None:
        return np.arange(count, dtype=np.int32)
    ids = polygon_ids(polygons, name)
    if len(ids) != count:
        raise _native.InvalidInput(f"{name}: expected {count} rows, one per triangle, got {len(ids)}")
    if count and ids.min() < 0:
        raise _native.InvalidInput(f"{name}: number polygons from 0, there is {ids.min()}")
    return ids


def _centres(vertices: Array, faces: Array, polygons: Array) -> tuple[Array, Array]:
    """Per polygon the triangle of it that its centre of area lies in, and the weights there."""
    count = int(polygons.max(initial=-1)) + 1
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = np.maximum(np.linalg.norm(np.cross(b - a, c - a), axis=1), 1e-300)
    total = np.bincount(polygons, weights=area, minlength=count)
    middle = (a + b + c) / 3.0
    centre = (
        np.stack([np.bincount(polygons, weights=area * middle[:, k], minlength=count) for k in range(3)], axis=1)
        / np.maximum(total, 1e-300)[:, None]
    )
    normal = np.cross(b - a, c - a)
    size = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    p = centre[polygons] - a
    v = np.einsum("ij,ij->i", np.cross(p, c - a), normal) / size
    w = np.einsum("ij,ij->i", np.cross(b - a, p), normal) / size
    weights = np.stack([1.0 - v - w, v, w], axis=1)
    # The triangle that the centre lies deepest in, the first of equal ones.
    order = np.lexsort((np.arange(len(faces)), -weights.min(axis=1), polygons))
    first = order[np.unique(polygons[order], return_index=True)[1]]
    triangle = np.full(count, -1, np.int32)
    triangle[polygons[first]] = first
    chosen = np.zeros((count, 3))
    inside = np.clip(weights[first], 0.0, None)
    total_weight = inside.sum(axis=1, keepdims=True)
    chosen[polygons[first]] = np.where(total_weight > 0.0, inside / np.maximum(total_weight, 1e-300), 1.0 / 3.0)
    return triangle, chosen
