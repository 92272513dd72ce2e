# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of edges: creases, bevel weights, sharp and seam marks."""

from __future__ import annotations

from typing import Any

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
    triangle_rows,
)
from isograft.transfer.attributes import Located, locate

# An edge's image follows a donor edge if they are nearer to each other than this share of its length, or of the usual
# length if that is more, and the angle between them has at least this cosine.
_NEAR = 0.5
_ALONG = np.sqrt(0.5)


def transfer_edge(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    receiver_edges: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_edges: Any,
    donor_values: npt.ArrayLike,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransferredValues:
    """Move values of edges: creases, bevel weights, sharp and seam marks, of any type.

    An edge takes the value of the donor's edge that its image runs along: the nearest one at most half an edge away
    from its middle and within 45 degrees. An edge across the inside of a large donor face has none, and a line that
    runs between two rows of the receiver's edges may mark both.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        receiver_edges: (E, 2) vertices; edges of no triangle are unmatched.
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_edges: (D, 2) vertices.
        donor_values: (D,) or (D, ...).
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        One row per receiver edge (0, False or an empty string where there is none), and which have a value.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    data = np.asarray(donor_values)
    vertices = point_rows(receiver_vertices, "receiver_vertices")
    faces = triangle_rows(receiver_faces, "receiver_faces")
    donor, other_faces = point_rows(donor_vertices, "donor_vertices"), triangle_rows(donor_faces, "donor_faces")
    edges = _edges(receiver_edges, len(vertices), "receiver_edges")
    other_edges = _edges(donor_edges, len(donor), "donor_edges")
    if data.ndim == 0 or len(data) != len(other_edges):
        raise _native.InvalidInput(
            f"donor_values: expected {len(other_edges)} rows, one per edge, got shape {data.shape}"
        )
    check_indices(faces, len(vertices), "receiver_faces")
    triangle, weights = _middles(faces, edges)
    found = locate(
        correspondence, vertices, faces, donor, other_faces, triangle, weights, threads=threads, progress=progress
    )
    mask = (found.face >= 0) & (np.asarray(correspondence.face)[edges] >= 0).all(axis=1)
    nearest = np.full(len(edges), -1)
    rows = np.flatnonzero(mask)
    if len(rows) and len(other_edges):
        nearest[rows] = _parallel_edges(correspondence, donor, other_faces, other_edges, edges[rows], found, rows)
    mask &= nearest >= 0
    return TransferredValues(pick_rows(data, nearest, mask), mask)


def _edges(edges: Any, count: int, name: str) -> Array:
    array = np.asarray(edges)
    if array.ndim != 2 or array.shape[1] != 2 or (array.size and array.dtype.kind not in "iu"):
        raise _native.InvalidInput(f"{name}: expected integers of shape (n, 2), got {array.dtype} {array.shape}")
    check_indices(array, count, name)
    return array.astype(np.int64)


def _middles(faces: Array, edges: Array) -> tuple[Array, Array]:
    """Per edge the first triangle with it, and the weights of the edge's middle there."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1).astype(np.int64)
    width = int(max(faces.max(initial=0), edges.max(initial=0))) + 1
    keys, first = np.unique(ends[:, 0] * width + ends[:, 1], return_index=True)
    wanted = np.sort(edges, axis=1)
    wanted = wanted[:, 0] * width + wanted[:, 1]
    at = np.minimum(np.searchsorted(keys, wanted), max(len(keys) - 1, 0))
    found = keys[at] == wanted if len(keys) else np.zeros(len(edges), bool)
    half_edge = first[at] if len(keys) else np.zeros(len(edges), np.int64)
    triangle = np.where(found, half_edge // 3, -1).astype(np.int32)
    weights = np.full((len(edges), 3), 0.5)
    weights[np.arange(len(edges)), (half_edge + 2) % 3] = 0.0
    return triangle, weights


def _parallel_edges(
    correspondence: CorrespondenceArrays,
    donor: Array,
    faces: Array,
    donor_edges: Array,
    edges: Array,
    found: Located,
    rows: Array,
) -> Array:
    """Per receiver edge the row of the donor edge that it follows, -1 for none."""
    face, barycentric, _ = correspondence_arrays(correspondence)
    ends = [(barycentric[edges[:, k]][:, :, None] * donor[faces[face[edges[:, k]]]]).sum(axis=1) for k in range(2)]
    image = ends[1] - ends[0]
    length = np.linalg.norm(image, axis=1)
    usual = float(np.median(length))
    corners = faces[found.face[rows]]
    middle = (found.barycentric[rows][:, :, None] * donor[corners]).sum(axis=1)
    # Edges by vertex; candidates are those at the corners of the donor's triangle under the middle.
    ordered = np.argsort(donor_edges.ravel(), kind="stable")
    start = np.searchsorted(donor_edges.ravel()[ordered], np.arange(len(donor) + 1))
    best, nearest = np.full(len(edges), np.inf), np.full(len(edges), -1)
    for corner in corners.T:
        valence = start[corner + 1] - start[corner]
        for k in range(int(valence.max(initial=0))):
            here = np.flatnonzero(valence > k)
            candidate = ordered[start[corner[here]] + k] // 2
            a, b = donor[donor_edges[candidate, 0]], donor[donor_edges[candidate, 1]]
            along = b - a
            size = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
            t = np.clip(np.einsum("ij,ij->i", middle[here] - a, along) / size, 0.0, 1.0)
            away = np.linalg.norm(a + t[:, None] * along - middle[here], axis=1)
            both = np.maximum(np.sqrt(size) * length[here], 1e-300)
            cosine = np.abs(np.einsum("ij,ij->i", along, image[here])) / both
            score = away + (1.0 - cosine) * length[here]
            better = (away <= _NEAR * np.maximum(length[here], usual)) & (cosine >= _ALONG)
            better &= (score < best[here]) | ((score == best[here]) & (candidate < nearest[here]))
            best[here[better]], nearest[here[better]] = score[better], candidate[better]
    return nearest
