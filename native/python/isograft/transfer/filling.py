# SPDX-License-Identifier: GPL-3.0-or-later
"""Unmatched areas filled smoothly from what lies around them, and marked; only on request."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.progress import part_of
from isograft.transfer.arrays import (
    Array,
    Progress,
    as_type,
    corner_rows,
    point_rows,
    polygon_ids,
    row_codes,
    triangle_rows,
    value_columns,
)

# Share of fill_corner() that cuts the mesh open along its seams.
_SPLITTING = 0.3


class Filled(NamedTuple):
    """Values without holes."""

    values: Array
    """As they were given, with the holes filled."""
    filled: npt.NDArray[np.bool_]
    """True where a value was made up: per vertex (fill_point), triangle (fill_corner) or face (fill_face)."""


def fill_point(
    vertices: Any,
    faces: Any,
    values: npt.ArrayLike,
    known: npt.ArrayLike,
    *,
    low: float | None = None,
    high: float | None = None,
    progress: Progress | None = None,
) -> Filled:
    """Fill values per vertex where they are not known.

    Floats continue smoothly (their bi-Laplacian is zero in the holes); integers, booleans and strings take the value of
    the nearest known vertex along the edges. Parts of the mesh without any known vertex stay as they are.

    Args:
        vertices: (n, 3) of the mesh that has the values.
        faces: (F, 3).
        values: (n,) or (n, ...).
        known: (n,) True where the values are known; those do not change.
        low: filled floats are not lower, such as 0 for weights.
        high: filled floats are not higher.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other; known values that are not finite.
    """
    data, mask = np.asarray(values), _booleans(known, "known")
    points, triangles = point_rows(vertices, "vertices"), triangle_rows(faces, "faces")
    if data.ndim == 0 or len(data) != len(points):
        raise _native.InvalidInput(f"values: expected {len(points)} rows, one per vertex, got shape {data.shape}")
    if data.dtype.kind == "f":
        columns, filled = _native.fill_smooth(points, triangles, value_columns(data), mask, progress)
        columns[filled] = np.clip(columns[filled], low, high) if (low, high) != (None, None) else columns[filled]
        return Filled(as_type(columns, data, len(data)), filled)
    source = _native.nearest_known(points, triangles, mask, progress)
    filled = (source >= 0) & ~mask
    result = data.copy()
    result[filled] = data[source[filled]]
    return Filled(result, filled)


def fill_corner(
    vertices: Any,
    faces: Any,
    values: npt.ArrayLike,
    known: npt.ArrayLike,
    *,
    tolerance: float = 1e-6,
    progress: Progress | None = None,
) -> Filled:
    """Fill values per corner, such as UVs, in triangles where they are not known.

    A hole continues, of the islands around it, the one that it shares the longest border with; the others keep their
    seam to it. Floats continue smoothly, other types take the nearest known value.

    Args:
        vertices: (n, 3) of the mesh that has the values.
        faces: (F, 3).
        values: (3 F,), (3 F, ...) or (F, 3, ...).
        known: (F,) True where all three corners of a triangle are known. Give all triangles of a polygon the same.
        tolerance: largest difference of floats that are still equal.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        (3 F, ...) values, and which triangles were filled: the unknown ones whose part of the mesh has a known one.

    Raises:
        InvalidInput: arrays that do not fit each other; known values that are not finite.
    """
    points, triangles = point_rows(vertices, "vertices"), triangle_rows(faces, "faces")
    data = corner_rows(values, len(triangles), "values")
    mask = _booleans(known, "known")
    if mask.shape != (len(triangles),):
        raise _native.InvalidInput(f"known: expected {len(triangles)} booleans, one per triangle, got {mask.shape}")
    smooth = data.dtype.kind == "f"
    compared = value_columns(data) if smooth else row_codes(data)
    split = _split(points, triangles, compared, mask, tolerance if smooth else 0.0, part_of(progress, 0.0, _SPLITTING))
    count = int(split.max(initial=-1)) + 1
    corner = np.flatnonzero(np.repeat(mask, 3))
    # One known value per split vertex: of the first corner, so that the result does not depend on an order.
    first = np.full(count, -1)
    first[split.ravel()[corner][::-1]] = corner[::-1]
    split_points = np.empty((count, 3))
    split_points[split.ravel()] = points[triangles.ravel()]
    split_values = np.zeros((count, *data.shape[1:]), data.dtype)
    split_values[first >= 0] = data[first[first >= 0]]
    result = fill_point(split_points, split, split_values, first >= 0, progress=part_of(progress, _SPLITTING, 1.0))
    reached = (result.filled | (first >= 0))[split].all(axis=1)
    filled = ~mask & reached
    corners = np.repeat(filled, 3)
    moved = data.copy()
    moved[corners] = result.values[split.ravel()[corners]]
    return Filled(moved, filled)


def fill_face(
    vertices: Any,
    faces: Any,
    values: npt.ArrayLike,
    known: npt.ArrayLike,
    *,
    polygons: Any = None,
    progress: Progress | None = None,
) -> Filled:
    """Fill values per face, such as material indices, with that of the nearest known face along the edges.

    Args:
        vertices: (n, 3) of the mesh that has the values.
        faces: (F, 3).
        values: (P,) or (P, ...), one row per polygon, without polygons per triangle; of any type.
        known: (P,) True where the values are known; those do not change.
        polygons: (F,) polygon of every triangle; None: every triangle is a face.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        Values, and which faces were filled. Parts of the mesh without any known face stay as they are.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    points, triangles = point_rows(vertices, "vertices"), triangle_rows(faces, "faces")
    data, mask = np.asarray(values), _booleans(known, "known")
    owner = np.arange(len(triangles)) if polygons is None else polygon_ids(polygons, "polygons")
    count = int(owner.max(initial=-1)) + 1
    if len(owner) != len(triangles):
        raise _native.InvalidInput(f"polygons: expected {len(triangles)} rows, one per triangle, got {len(owner)}")
    if data.ndim == 0 or len(data) != len(mask) or len(data) < count:
        raise _native.InvalidInput(
            f"values and known: expected {count} rows, one per face, got {data.shape} and {mask.shape}"
        )
    # Every vertex of a known face stands for the first of them; an unknown face asks its corners.
    giver = np.full(len(points), count)
    sure = mask[owner]
    np.minimum.at(giver, triangles[sure].ravel(), np.repeat(owner[sure], 3))
    source = _native.nearest_known(points, triangles, giver < count, progress)
    nearest = np.where(source >= 0, giver[source], count)[triangles]
    away = np.linalg.norm(points[triangles] - points[source[triangles]], axis=2)
    corner = np.where(nearest < count, away, np.inf).argmin(axis=1)
    asked = nearest[np.arange(len(triangles)), corner]
    result, filled = data.copy(), np.zeros(len(data), bool)
    unsure = np.flatnonzero(~sure & (asked < count))[::-1]
    result[owner[unsure]] = data[asked[unsure]]
    filled[owner[unsure]] = True
    return Filled(result, filled)


def _split(
    points: Array, triangles: Array, compared: Array, mask: Array, tolerance: float, progress: Progress | None
) -> Array:
    """(F, 3) vertices of the mesh cut open along its seams, every hole sewn to one island only."""
    vertex = _positions(points)[triangles]
    split = np.full(triangles.shape, -1, np.int64)
    groups: Array = np.zeros(0, np.int64)
    known = np.flatnonzero(mask)
    if len(known):
        corners = compared.reshape(len(triangles), 3, -1)[known].reshape(3 * len(known), -1)
        groups = _native.corner_groups(
            triangles[known], np.ascontiguousarray(corners), tolerance, points, part_of(progress, 0.0, 0.4)
        )
        split[known] = groups.reshape(-1, 3)
    count = int(groups.max(initial=-1)) + 1
    unknown = np.flatnonzero(~mask)
    if not len(unknown):
        return split.astype(np.int32)
    hole = np.zeros(len(triangles), np.int64)
    hole[unknown] = _native.uv_islands(
        vertex[unknown].astype(np.int32),
        np.zeros((3 * len(unknown), 0)),
        0.0,
        points,
        part_of(progress, 0.4, 0.6),
    )
    island = np.full(len(triangles), -1, np.int64)
    if len(known):
        island[known] = _native.uv_islands(
            triangles[known], np.ascontiguousarray(corners), tolerance, points, part_of(progress, 0.6, 1.0)
        )
    border, other = _border(vertex, mask)
    chosen = _longest(points, triangles, border, hole[border[:, 0]], island[other[:, 0]])
    # At the border a hole's vertex is that of the chosen island, elsewhere one of its own.
    sewn: dict[tuple[int, int], int] = {}
    for (f, c), (g, d) in zip(border.tolist(), other.tolist(), strict=True):
        if chosen[hole[f]] != island[g]:
            continue
        for mine in (c, (c + 1) % 3):
            theirs = next(k for k in (d, (d + 1) % 3) if vertex[g, k] == vertex[f, mine])
            sewn.setdefault((int(hole[f]), int(vertex[f, mine])), int(split[g, theirs]))
    keys = hole[unknown][:, None] * (len(points) + 1) + vertex[unknown]
    values, index = np.unique(keys, return_inverse=True)
    own = np.arange(count, count + len(values))
    if sewn:
        at = np.array(list(sewn))
        own[np.searchsorted(values, at[:, 0] * (len(points) + 1) + at[:, 1])] = list(sewn.values())
    split[unknown] = own[index.reshape(-1, 3)]
    # Numbers without gaps.
    return np.unique(split, return_inverse=True)[1].reshape(split.shape).astype(np.int32)


def _positions(points: Array) -> Array:
    """Per vertex the first one at the same place."""
    _, first, index = np.unique(points, axis=0, return_index=True, return_inverse=True)
    result: Array = first[index.reshape(-1)]
    return result


def _border(vertex: Array, mask: Array) -> tuple[Array, Array]:
    """(b, 2) half-edges (triangle, corner) of unknown triangles, and of the known ones across."""
    face = np.repeat(np.arange(len(vertex)), 3)
    corner = np.tile(np.arange(3), len(vertex))
    ends = np.sort(np.stack([vertex.ravel(), np.roll(vertex, -1, axis=1).ravel()], axis=1), axis=1)
    keep = ends[:, 0] != ends[:, 1]
    face, corner, ends = face[keep], corner[keep], ends[keep]
    order = np.lexsort((face, ends[:, 1], ends[:, 0]))
    face, corner, ends = face[order], corner[order], ends[order]
    same = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    pairs = np.stack([same, same + 1], axis=1)
    pairs = pairs[mask[face[pairs[:, 0]]] != mask[face[pairs[:, 1]]]]
    turned = mask[face[pairs[:, 0]]]
    pairs[turned] = pairs[turned][:, ::-1]
    sides = np.stack([face, corner], axis=1)
    return sides[pairs[:, 0]], sides[pairs[:, 1]]


def _longest(points: Array, triangles: Array, border: Array, hole: Array, island: Array) -> Array:
    """Per hole the island with the longest border to it, the first of equal ones."""
    count = int(hole.max(initial=-1)) + 1
    chosen = np.full(max(count, 1), -1, np.int64)
    if not len(border):
        return np.full(len(triangles) + 1, -1, np.int64)
    a = points[triangles[border[:, 0], border[:, 1]]]
    b = points[triangles[border[:, 0], (border[:, 1] + 1) % 3]]
    width = int(island.max()) + 1
    keys, index = np.unique(hole * width + island, return_inverse=True)
    length = np.bincount(index.reshape(-1), weights=np.linalg.norm(a - b, axis=1))
    for key, total in sorted(zip(keys.tolist(), length.tolist(), strict=True), key=lambda entry: (entry[1], -entry[0])):
        if total > 0.0:
            chosen[key // width] = key % width
    result = np.full(len(triangles) + 1, -1, np.int64)
    result[: len(chosen)] = chosen
    return result


def _booleans(values: npt.ArrayLike, name: str) -> Array:
    array = np.asarray(values)
    if array.ndim != 1 or array.dtype != bool:
        raise _native.InvalidInput(f"{name}: expected booleans of shape (n,), got {array.dtype} {array.shape}")
    return np.ascontiguousarray(array)
