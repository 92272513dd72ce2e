# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys and custom normals: vectors of the donor's surface turned as the receiver's surface lies."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_float
from isograft.progress import part_of, tell
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    TransferredValues,
    correspondence_arrays,
    point_rows,
    triangle_rows,
)

Scale = Literal["global", "local"] | float


class LocalFrames(NamedTuple):
    """How the donor's surface is turned and sized to lie on the receiver's, at every receiver vertex."""

    rotation: npt.NDArray[np.float64]
    """(n, 3, 3): rotation @ donor vector = receiver vector; 0 where there is none."""
    scale: npt.NDArray[np.float64]
    """(n,) receiver units per donor unit in the few edges around the vertex; 0 where there is none."""
    median_scale: float
    """Median of that over all edges."""
    mask: npt.NDArray[np.bool_]
    """(n,) True where matched, with a neighbour that is."""
    one_pose: bool
    """Whether the two were found in one pose, and rotations so fitted over a wide surrounding; see `smoothing`."""


def local_frames(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    *,
    smoothing: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> LocalFrames:
    """Rotation and scale between the surfaces around every receiver vertex: the best rigid fit of edges and normals.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        smoothing: neighbours of neighbours that a frame is fitted to. More is calmer on a noisy map and blurs the
            turning at joints by as many edges. None: two shapes in one pose, such as the faces of two persons, have
            rotations fitted over about a third of the root of the receiver's area, so that what one shape has of its
            own turns nothing; others over 2.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    rotation, scale, median_scale, mask, one_pose = _native.local_frames(
        *correspondence_arrays(correspondence),
        point_rows(receiver_vertices, "receiver_vertices"),
        triangle_rows(receiver_faces, "receiver_faces"),
        point_rows(donor_vertices, "donor_vertices"),
        triangle_rows(donor_faces, "donor_faces"),
        smoothing,
        threads or 0,
        progress,
    )
    return LocalFrames(rotation.reshape(-1, 3, 3), scale, median_scale, mask, one_pose)


def transfer_shape_keys(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_keys: npt.ArrayLike,
    *,
    scale: Scale = "global",
    smoothing: int | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move shape keys: displacements are carried in the local frames of the surfaces.

    So they arrive turned as the receiver's limbs lie, and as long as its scale asks for.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3), the shape the keys start from.
        receiver_faces: (F, 3).
        donor_vertices: (m, 3), the shape the donor's keys start from.
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_keys: (k, m, 3), or (m, 3) for a single one: displacements, key minus basis.
        scale: "global" (one ratio of lengths for the pair), "local" (the ratio around each vertex: a larger nose moves
            farther), or receiver units per donor unit.
        smoothing: as for local_frames().
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        Displacements of the shape of `donor_keys`, with n for m, 0 where unmatched, and the mask of matched vertices.
        float32 stays float32.

    Raises:
        InvalidInput: arrays that do not fit each other, displacements that are not finite, a scale that
            is not positive.
    """
    keys = _keys(donor_keys, len(np.asarray(donor_vertices)))
    frames = local_frames(
        correspondence,
        receiver_vertices,
        receiver_faces,
        donor_vertices,
        donor_faces,
        smoothing=smoothing,
        threads=threads,
        progress=part_of(progress, 0.0, 0.5),
    )
    mask = frames.mask
    turn = frames.rotation[mask] * _sizes(scale, frames)[:, None, None]
    face = np.asarray(correspondence.face)[mask]
    corners = triangle_rows(donor_faces, "donor_faces")[face]
    weights = np.asarray(correspondence.barycentric, np.float64)[mask]
    moved = np.zeros((len(keys), len(mask), 3), keys.dtype)
    for i, key in enumerate(keys):
        tell(progress, "shape keys", 0.5 + 0.5 * i / len(keys))
        there = sum(weights[:, c, None] * key[corners[:, c]] for c in range(3))
        moved[i, mask] = np.einsum("ijk,ik->ij", turn, there)
    tell(progress, "shape keys", 1.0)
    return TransferredValues(moved if np.ndim(donor_keys) == 3 else moved[0], mask)


def _sizes(scale: Scale, frames: LocalFrames) -> Array:
    count = int(frames.mask.sum())
    if isinstance(scale, str):
        if scale not in ("global", "local"):
            raise _native.InvalidInput(f'scale must be "global", "local" or a positive number, not {scale!r}')
        return frames.scale[frames.mask] if scale == "local" else np.full(count, frames.median_scale)
    value = to_float(scale, "scale")
    if value <= 0.0:
        raise _native.InvalidInput(f"scale must be positive, not {value}")
    return np.full(count, value)


def _keys(donor_keys: npt.ArrayLike, count: int) -> Array:
    keys = np.asarray(donor_keys)
    if keys.ndim == 2:
        keys = keys[None]
    if keys.ndim != 3 or keys.shape[1:] != (count, 3) or keys.dtype.kind not in "fiu":
        raise _native.InvalidInput(
            f"donor_keys must be numbers of shape (keys, {count}, 3), one row per donor vertex, not {keys.dtype} "
            f"{np.shape(donor_keys)}"
        )
    keys = keys.astype(np.float32 if keys.dtype == np.float32 else np.float64, copy=False)
    for i, key in enumerate(keys):
        bad = ~np.isfinite(key).all(axis=1)
        if bad.any():
            raise _native.InvalidInput(
                f"donor_keys: key {i} is not finite in {int(bad.sum())} vertices, the first is {int(bad.argmax())}"
            )
    return keys
