# SPDX-License-Identifier: GPL-3.0-or-later
"""Seams of a corner attribute as edges of the mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.transfer.arrays import corner_rows, polygon_ids, row_codes, triangle_rows, value_columns


def seam_edges(
    faces: Any,
    corner_values: Any,
    *,
    mask: Any = None,
    polygons: Any = None,
    tolerance: float = 1e-6,
) -> npt.NDArray[np.int32]:
    """The edges along which a corner attribute jumps: to be marked as seams.

    Args:
        faces: (F, 3) triangles.
        corner_values: (3 F, ...) or (F, 3, ...), such as the UVs that transfer_corner_uv() returns.
        mask: (F,) triangles that have values; edges of others are no seams. None: all.
        polygons: (F,) polygon of every triangle; the diagonals inside one are no seams.
        tolerance: largest difference of floats that are still equal.

    Returns:
        (e, 2) vertices of edges between two or more triangles with values that do not agree at both ends, the lower
        vertex first, in ascending order.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    triangles = triangle_rows(faces, "faces")
    data = corner_rows(corner_values, len(triangles), "corner_values")
    values = value_columns(data) if data.dtype.kind == "f" else row_codes(data)
    values = values.reshape(len(triangles), 3, -1)
    chosen = np.ones(len(triangles), bool) if mask is None else np.asarray(mask)
    if chosen.shape != (len(triangles),) or chosen.dtype != bool:
        raise _native.InvalidInput(
            f"mask: expected {len(triangles)} booleans, one per triangle, got {chosen.dtype} {chosen.shape}"
        )
    polygon = np.arange(len(triangles)) if polygons is None else polygon_ids(polygons, "polygons")
    if len(polygon) != len(triangles):
        raise _native.InvalidInput(f"polygons: expected {len(triangles)} rows, one per triangle, got {len(polygon)}")
    a, b = triangles, np.roll(triangles, -1, axis=1)
    at_a, at_b = values, np.roll(values, -1, axis=1)
    swap = (a > b)[:, :, None]
    low, high = np.where(swap, at_b, at_a), np.where(swap, at_a, at_b)
    keep = (chosen[:, None] & (a != b)).ravel()
    ends = np.stack([np.minimum(a, b).ravel(), np.maximum(a, b).ravel()], axis=1)[keep]
    both = np.concatenate([low, high], axis=2).reshape(3 * len(triangles), -1)[keep]
    owner = np.repeat(polygon, 3)[keep]
    order = np.lexsort((np.arange(len(ends)), ends[:, 1], ends[:, 0]))
    ends, both, owner = ends[order], both[order], owner[order]
    jump = np.abs(both[1:] - both[:-1]).max(axis=1, initial=0.0) > (tolerance if data.dtype.kind == "f" else 0.0)
    seam = (ends[1:] == ends[:-1]).all(axis=1) & (owner[1:] != owner[:-1]) & jump
    return np.unique(ends[1:][seam], axis=0).astype(np.int32).reshape(-1, 2)
