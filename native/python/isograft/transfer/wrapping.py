# SPDX-License-Identifier: GPL-3.0-or-later
"""The donor's topology on the receiver's shape: registration."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.progress import part_of
from isograft.transfer.arrays import Array, CorrespondenceArrays, Progress, point_rows, triangle_rows
from isograft.transfer.inverse import invert

Method = Literal["rigid", "smooth"]
METHODS: tuple[Method, ...] = ("rigid", "smooth")


class Wrapped(NamedTuple):
    """A mesh with the donor's triangles and the receiver's shape."""

    vertices: npt.NDArray[np.float64]
    """(m, 3), one per donor vertex."""
    filled: npt.NDArray[np.bool_]
    """(m,) True where the receiver has no counterpart and the place was made up."""


def wrap(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    *,
    method: Method = "rigid",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Wrapped:
    """Put the donor's vertices where the receiver is: vertex order and triangles are the donor's, the shape is not.

    A donor vertex goes to its point under the inverse map. What has none is completed from the donor's own shape.

    Args:
        correspondence: receiver to donor, as for every transfer.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        method: how the rest is completed: "rigid" bends the donor's shape and stretches it as little as possible
            (as-rigid-as-possible), "smooth" continues the displacements (their bi-Laplacian is zero). Parts of the
            donor without any matched vertex are placed by the best similarity of all the others.
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other; a map to a point cloud; fewer than three vertices matched.
    """
    if method not in METHODS:
        raise _native.InvalidInput(f"method must be rigid or smooth, not {method!r}")
    donor, faces = point_rows(donor_vertices, "donor_vertices"), triangle_rows(donor_faces, "donor_faces")
    inverse = invert(
        correspondence,
        receiver_vertices,
        receiver_faces,
        donor,
        faces,
        threads=threads,
        progress=part_of(progress, 0.0, 0.4),
    )
    known = inverse.matched
    if known.sum() < 3:
        raise _native.InvalidInput(f"{int(known.sum())} donor vertices are matched, at least 3 are needed to wrap")
    placed = _similar(donor, inverse.points, known)
    placed[known] = inverse.points[known]
    scale = _scale(donor, faces, placed, known)
    finish = part_of(progress, 0.4, 1.0)
    if method == "rigid":
        vertices, _ = _native.complete_rigid(donor, faces, placed, known, scale, 50, finish)
    else:
        moved, _ = _native.fill_smooth(donor, faces, placed - scale * donor, known, finish)
        vertices = moved + scale * donor
        vertices[known] = inverse.points[known]
    return Wrapped(vertices, ~known)


def _similar(donor: Array, points: Array, known: Array) -> Array:
    """All of the donor moved by the rotation, scale and shift that fit the known points best (Umeyama 1991)."""
    a, b = donor[known], points[known]
    from_mean, to_mean = a.mean(axis=0), b.mean(axis=0)
    left, size, right = np.linalg.svd((b - to_mean).T @ (a - from_mean))
    flip = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right)) or 1.0])
    spread = ((a - from_mean) ** 2).sum()
    scale = float((size * flip).sum() / spread) if spread > 0.0 else 1.0
    result: Array = scale * (donor - from_mean) @ (left * flip @ right).T + to_mean
    return result


def _scale(donor: Array, faces: Array, placed: Array, known: Array) -> float:
    """Median ratio of lengths over the edges between known vertices."""
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ends = ends[known[ends].all(axis=1)]
    before = np.linalg.norm(donor[ends[:, 0]] - donor[ends[:, 1]], axis=1)
    after = np.linalg.norm(placed[ends[:, 0]] - placed[ends[:, 1]], axis=1)
    usable = (before > 0.0) & (after > 0.0)
    return float(np.median(after[usable] / before[usable])) if usable.any() else 1.0
