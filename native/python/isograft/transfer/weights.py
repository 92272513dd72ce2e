# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups: weights moved, mixed with the receiver's own as Blender's Data Transfer mixes them, and tidied.

A matrix of weights has one row per vertex and one column per group; 0 stands for "not in the group".
"""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.progress import part_of, tell
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    TransferredValues,
    correspondence_arrays,
    triangle_rows,
)

MixMode = Literal["replace", "above_threshold", "below_threshold", "mix", "add", "subtract", "multiply"]
MIX_MODES: tuple[MixMode, ...] = (
    "replace", "above_threshold", "below_threshold", "mix", "add", "subtract", "multiply",
)  # fmt: skip

# Rows at a time: so that a matrix of many groups is never held several times.
_ROWS = 1 << 15
# Share of transfer_weights() that checks the correspondence.
_CHECKING = 0.2


def transfer_weights(
    correspondence: CorrespondenceArrays,
    donor_faces: Any,
    donor_weights: npt.ArrayLike,
    *,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move vertex-group weights from the donor's vertices to the receiver's.

    Args:
        correspondence: receiver to donor; a point cloud's `vertex` will do.
        donor_faces: (G, 3) triangles that `correspondence.face` counts; None for a point cloud.
        donor_weights: (m, k) finite numbers >= 0.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        (n, k) weighted means, 0 where unmatched (float32 stays float32), and the mask of matched vertices. A vertex
        whose donor corners' weights sum to 1 has weights that sum to 1.

    Raises:
        InvalidInput: arrays that do not fit each other; weights that are negative or not finite.
        Cancelled: `progress` returned False.
    """
    tell(progress, "weights", 0.0)
    weights = _weights(donor_weights, "donor_weights")
    face, barycentric, vertex = correspondence_arrays(correspondence)
    faces = triangle_rows(donor_faces, "donor_faces")
    # The one place that checks a correspondence against its donor; no column is moved there.
    nothing = np.zeros((len(weights), 0))
    _, mask = _native.transfer_point(
        face, barycentric, vertex, faces, nothing, False, part_of(progress, 0.0, _CHECKING)
    )
    moved = np.zeros((len(face), weights.shape[1]), weights.dtype)
    moving = part_of(progress, _CHECKING, 1.0)
    for start in range(0, len(face), _ROWS):
        tell(moving, "weights", start / len(face))
        rows = slice(start, start + _ROWS)
        on_face = face[rows] >= 0
        on_vertex = mask[rows] & ~on_face
        corners = faces[face[rows][on_face]]
        shares = np.clip(barycentric[rows][on_face], 0.0, None)
        shares = (shares / shares.sum(axis=1, keepdims=True)).astype(weights.dtype)
        part = moved[rows]
        part[on_face] = sum(shares[:, c, None] * weights[corners[:, c]] for c in range(3))
        part[on_vertex] = weights[vertex[rows][on_vertex]]
    tell(progress, "weights", 1.0)
    return TransferredValues(moved, mask)


def mix_weights(
    own: npt.ArrayLike,
    moved: npt.ArrayLike,
    *,
    mode: MixMode = "replace",
    mix: float = 1.0,
    mask: npt.ArrayLike | None = None,
    locked: npt.ArrayLike | None = None,
) -> Array:
    """The receiver's own weights mixed with those that came, with the meaning of Blender's Data Transfer.

    Args:
        own: (n, k) what the receiver has in these groups, 0 where nothing.
        moved: (n, k), as from transfer_weights().
        mode: "replace"; "above_threshold" and "below_threshold" (replaced where the own weight is not below, or not
            above, the threshold `mix`; what is in no group is not above any threshold); "mix" (the mean of both),
            "add", "subtract" (own minus moved), "multiply".
        mix: in [0, 1]: how much of the result is taken, the rest is the own weight. In the two threshold modes the
            threshold, as in Blender.
        mask: (n,) rows that may change, such as the matched ones; None: all.
        locked: (k,) columns that may not change.

    Returns:
        (n, k) in [0, 1]; unchanged rows and columns are exactly `own`.

    Raises:
        InvalidInput: shapes that do not fit; an unknown mode; `mix` outside [0, 1]; values negative or not finite.
    """
    before, came = _weights(own, "own"), _weights(moved, "moved")
    if before.shape != came.shape:
        raise _native.InvalidInput(f"own and moved must have one shape, not {before.shape} and {came.shape}")
    if mode not in MIX_MODES:
        raise _native.InvalidInput(f"mode must be one of {', '.join(MIX_MODES)}, not {mode!r}")
    if not 0.0 <= mix <= 1.0:
        raise _native.InvalidInput(f"mix must be from 0 to 1, not {mix}")
    if mode == "above_threshold":
        result = np.where((before < mix) | (before == 0.0), before, came)
    elif mode == "below_threshold":
        result = np.where(before > mix, before, came)
    else:
        result = _blend(before, came, mode)
        # Whole factors give whole results, to the last bit.
        result = result if mix == 1.0 else mix * result + (1.0 - mix) * before
    change = _rows(mask, len(before))[:, None] & ~_columns(locked, before.shape[1])
    return np.where(change, np.clip(result, 0.0, 1.0), before).astype(came.dtype)


def tidy_weights(
    weights: npt.ArrayLike,
    *,
    normalise: bool = False,
    limit: int | None = None,
    locked: npt.ArrayLike | None = None,
    mask: npt.ArrayLike | None = None,
    prune: float = 0.0,
) -> Array:
    """Drop small weights, limit how many groups a vertex is in, and make its weights sum to 1, in this order.

    Args:
        weights: (n, k).
        normalise: scale the columns that are not locked so that all of a row sum to 1. Locked columns keep what they
            have, even if that is more than 1 (then the others get 0); rows without any other weight stay as they are.
        limit: the largest number of groups of a vertex; locked ones count and always stay, of equal ones the first.
        locked: (k,) columns that may not change.
        mask: (n,) rows that may change; None: all.
        prune: weights up to this one become 0.

    Raises:
        InvalidInput: shapes that do not fit; a limit below 1; values negative or not finite.
    """
    before = _weights(weights, "weights")
    fixed = _columns(locked, before.shape[1])
    if limit is not None and limit < 1:
        raise _native.InvalidInput(f"limit must be at least 1, not {limit}")
    if not prune >= 0.0:
        raise _native.InvalidInput(f"prune must not be negative, and is {prune}")
    rows = _rows(mask, len(before))
    result = before.copy()
    for start in range(0, len(before), _ROWS):
        chosen = np.flatnonzero(rows[start : start + _ROWS]) + start
        result[chosen] = _tidy(before[chosen], normalise, limit, fixed, prune)
    return result


def _blend(own: Array, moved: Array, mode: str) -> Array:
    if mode == "replace":
        return moved
    if mode == "mix":
        return 0.5 * (own + moved)
    if mode == "add":
        return own + moved
    return own - moved if mode == "subtract" else own * moved


def _tidy(weights: Array, normalise: bool, limit: int | None, fixed: Array, prune: float) -> Array:
    free = np.where(fixed, 0.0, weights).astype(weights.dtype)
    held = np.where(fixed, weights, 0.0).astype(weights.dtype)
    free[free <= prune] = 0.0
    if limit is not None and limit < free.shape[1]:
        left = np.clip(limit - np.count_nonzero(held, axis=1), 0, None)
        order = np.argsort(-free, axis=1, kind="stable")
        rank = np.empty_like(order)
        np.put_along_axis(rank, order, np.broadcast_to(np.arange(free.shape[1]), order.shape), axis=1)
        free[rank >= left[:, None]] = 0.0
    if normalise:
        total = free.sum(axis=1, dtype=np.float64)
        room = np.clip(1.0 - held.sum(axis=1, dtype=np.float64), 0.0, None)
        factor = np.divide(room, total, out=np.ones_like(total), where=total > 0.0)
        free = (free * factor[:, None]).astype(weights.dtype)
    tidied: Array = held + free
    return tidied


def _weights(values: npt.ArrayLike, name: str) -> Array:
    array = np.asarray(values)
    if array.ndim != 2 or array.dtype.kind not in "fiub":
        raise _native.InvalidInput(
            f"{name} must be numbers of shape (vertices, groups), not {array.dtype} {array.shape}"
        )
    array = array.astype(np.float32 if array.dtype == np.float32 else np.float64, copy=False)
    bad = ~(np.isfinite(array) & (array >= 0.0))
    if bad.any():
        row, column = np.argwhere(bad)[0]
        raise _native.InvalidInput(
            f"{name}: {int(bad.sum())} weights are negative or not finite, the first is {array[row, column]} in row "
            f"{row}, group {column}"
        )
    return array


def _rows(mask: npt.ArrayLike | None, count: int) -> Array:
    rows = np.ones(count, bool) if mask is None else np.asarray(mask)
    if rows.shape != (count,) or rows.dtype != bool:
        raise _native.InvalidInput(f"mask must be booleans of shape ({count},), not {rows.dtype} {rows.shape}")
    return rows


def _columns(locked: npt.ArrayLike | None, count: int) -> Array:
    columns = np.zeros(count, bool) if locked is None else np.asarray(locked)
    if columns.shape != (count,) or columns.dtype != bool:
        raise _native.InvalidInput(f"locked must be booleans of shape ({count},), not {columns.dtype} {columns.shape}")
    return columns
