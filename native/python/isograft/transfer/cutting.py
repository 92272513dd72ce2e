# SPDX-License-Identifier: GPL-3.0-or-later
"""Receiver triangles cut where the donor's seam runs through them, so that UVs are exact on both sides."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.progress import part_of
from isograft.transfer.arrays import (
    Array,
    CorrespondenceArrays,
    Progress,
    check_indices,
    corner_rows,
    correspondence_arrays,
    point_rows,
    triangle_rows,
    value_columns,
)
from isograft.transfer.attributes import locate
from isograft.transfer.seams import seam_edges

# An edge crosses a seam if its ends' UVs lie farther apart than this many times what the donor's UVs stretch there.
_JUMP = 3.0
# Every round looks at the ends of this many parts of each edge and keeps the one that jumps.
_PARTS = 8
_ROUNDS = 7
# Seams nearer to a vertex than this share of the edge need no cut.
_END = 1e-3
# A weight below this is on an edge of the donor's triangle.
_ALONG = 1e-6


class CutMesh(NamedTuple):
    """The receiver with triangles cut along the donor's seams, and the map that fits it."""

    vertices: npt.NDArray[np.float64]
    """(n + e, 3): the receiver's own, then one on every edge that a seam crosses."""
    faces: npt.NDArray[np.int32]
    """(F', 3), in the winding of the triangles they come from."""
    parent: npt.NDArray[np.int32]
    """(F',) the receiver triangle that each was cut from."""
    edges: npt.NDArray[np.int32]
    """(e, 2) the receiver's edges that were cut, the lower vertex first."""
    fraction: npt.NDArray[np.float64]
    """(e,) where, from the first vertex."""
    face: npt.NDArray[np.int32]
    """(n + e,) with `barycentric` and `vertex` the correspondence of the new vertices: pass this object as one."""
    barycentric: npt.NDArray[np.float64]
    """(n + e, 3)."""
    vertex: npt.NDArray[np.int32]
    """(n + e,)."""


def cut_along_seams(
    correspondence: CorrespondenceArrays,
    receiver_vertices: Any,
    receiver_faces: Any,
    donor_vertices: Any,
    donor_faces: Any,
    donor_corner_uv: Any,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> CutMesh:
    """Cut the receiver's triangles where the donor's seams cross their edges, straight from edge to edge.

    Seams are found by the jump of the UVs along an edge: those whose sides lie beside each other in UV space too are no
    seams to the eye and are left. An edge that a seam crosses more than once is cut once. Where a seam ends inside a
    triangle, or three meet, the triangle is divided from the cuts of its edges.

    Args:
        correspondence: receiver to donor.
        receiver_vertices: (n, 3).
        receiver_faces: (F, 3).
        donor_vertices: (m, 3).
        donor_faces: (G, 3), the triangles that `correspondence.face` counts.
        donor_corner_uv: (3 G, 2) or (G, 3, 2).
        threads: None takes all cores. The result does not depend on it.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    vertices = point_rows(receiver_vertices, "receiver_vertices")
    faces = triangle_rows(receiver_faces, "receiver_faces")
    donor, other_faces = point_rows(donor_vertices, "donor_vertices"), triangle_rows(donor_faces, "donor_faces")
    uv = value_columns(corner_rows(donor_corner_uv, len(other_faces), "donor_corner_uv")).reshape(-1, 3, 2)
    check_indices(faces, len(vertices), "receiver_faces")
    face, barycentric, vertex = correspondence_arrays(correspondence)
    edges, half_edge, edge_of = _unique_edges(faces)

    def read(rows: Array, at: Array, share: float) -> tuple[Array, Array, Array]:
        """UVs, donor triangles and weights at the fractions `at` of the edges `rows`."""
        corner = half_edge[rows]
        weights = np.zeros((len(rows), 3))
        turned = faces[corner // 3, corner % 3] != edges[rows, 0]
        along = np.where(turned, 1.0 - at, at)
        weights[np.arange(len(rows)), corner % 3] = 1.0 - along
        weights[np.arange(len(rows)), (corner + 1) % 3] = along
        found = locate(
            correspondence, vertices, faces, donor, other_faces, (corner // 3).astype(np.int32), weights,
            threads=threads, progress=part_of(progress, share, share + 1.0 / (_ROUNDS + 1)),
        )  # fmt: skip
        return (found.barycentric[:, :, None] * uv[found.face]).sum(axis=1), found.face, found.barycentric

    rows = _crossed(face, barycentric, edges, donor, other_faces, uv)
    low, high = np.zeros(len(rows)), np.ones(len(rows))
    for turn in range(_ROUNDS):
        if not len(rows):
            break
        at = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, _PARTS + 1)
        here, found, weights = read(np.repeat(rows, _PARTS + 1), at.ravel(), turn / (_ROUNDS + 1))
        jump = np.linalg.norm(np.diff(here.reshape(len(rows), _PARTS + 1, 2), axis=1), axis=2)
        part = jump.argmax(axis=1)
        low, high = at[np.arange(len(rows)), part], at[np.arange(len(rows)), part + 1]
        whole = (found.reshape(len(rows), -1) >= 0).all(axis=1)
        if turn == 0:
            # What lies on the seam all along does not cross it.
            on_seam = _on_edges(other_faces[found], weights, seam_edges(other_faces, uv))
            whole &= ~on_seam.reshape(len(rows), -1).all(axis=1)
        rows, low, high = rows[whole], low[whole], high[whole]
    inner = (low > _END) & (high < 1.0 - _END)
    rows, low = rows[inner], low[inner]
    cut_face, cut_weights = np.zeros(0, np.int32), np.zeros((0, 3))
    if len(rows):
        _, cut_face, cut_weights = read(rows, low, _ROUNDS / (_ROUNDS + 1))
    new = np.full(len(edges), -1)
    new[rows] = len(vertices) + np.arange(len(rows))
    a, b = vertices[edges[rows, 0]], vertices[edges[rows, 1]]
    triangles, parent = _divide(faces, new[edge_of])
    heaviest = other_faces[cut_face, cut_weights.argmax(axis=1)] if len(rows) else np.zeros(0, np.int32)
    return CutMesh(
        np.vstack([vertices, a + low[:, None] * (b - a)]),
        triangles,
        parent,
        edges[rows].astype(np.int32),
        low,
        np.concatenate([face, cut_face]),
        np.vstack([barycentric, cut_weights]),
        np.concatenate([vertex, heaviest.astype(np.int32)]),
    )


def _unique_edges(faces: Array) -> tuple[Array, Array, Array]:
    """(E, 2) edges, a half-edge of each, and (F, 3) the edge of every half-edge."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1).astype(np.int64)
    edges, first, index = np.unique(ends, axis=0, return_index=True, return_inverse=True)
    return edges, first, index.reshape(-1, 3)


def _crossed(face: Array, barycentric: Array, edges: Array, donor: Array, faces: Array, uv: Array) -> Array:
    """Edges whose ends' UVs lie farther apart than the donor's own stretch explains."""
    if len(face) <= int(edges.max(initial=-1)):
        raise _native.InvalidInput(f"correspondence: {len(face)} rows for {int(edges.max(initial=-1)) + 1} vertices")
    matched = np.flatnonzero((face[edges] >= 0).all(axis=1) & (edges[:, 0] != edges[:, 1]))
    sides = np.linalg.norm(uv - np.roll(uv, -1, axis=1), axis=2)
    lengths = np.linalg.norm(donor[faces] - np.roll(donor[faces], -1, axis=1), axis=2)
    stretch = (sides / np.maximum(lengths, 1e-300)).max(axis=1, initial=0.0)
    ends = [edges[matched, k] for k in range(2)]
    at = [(barycentric[v][:, :, None] * uv[face[v]]).sum(axis=1) for v in ends]
    points = [(barycentric[v][:, :, None] * donor[faces[face[v]]]).sum(axis=1) for v in ends]
    usual = np.maximum(stretch[face[ends[0]]], stretch[face[ends[1]]]) * np.linalg.norm(points[1] - points[0], axis=1)
    crossed: Array = matched[np.linalg.norm(at[1] - at[0], axis=1) > _JUMP * usual + 1e-6]
    return crossed


def _on_edges(corners: Array, weights: Array, edges: Array) -> Array:
    """True for points on one of the given edges, or on a vertex."""
    width = int(max(corners.max(initial=0), edges.max(initial=0))) + 1
    rows, across = np.arange(len(corners)), weights.argmin(axis=1)
    ends = np.stack([corners[rows, (across + k) % 3] for k in (1, 2)], axis=1).astype(np.int64)
    known = edges[:, 0].astype(np.int64) * width + edges[:, 1]
    on_edge = np.isin(ends.min(axis=1) * width + ends.max(axis=1), known) & (weights.min(axis=1) < _ALONG)
    result: Array = on_edge | ((weights < _ALONG).sum(axis=1) > 1)
    return result


def _divide(faces: Array, new: Array) -> tuple[Array, Array]:
    """Triangles with new vertices `new` (F, 3) on their edges, -1 for none; and which triangle each comes from."""
    cuts = (new >= 0).sum(axis=1)
    triangles, parents = [faces[cuts == 0]], [np.flatnonzero(cuts == 0)]

    def add(rows: Array, *corners: Array) -> None:
        triangles.append(np.stack(corners, axis=1).astype(np.int32))
        parents.append(rows)

    for first in range(3):
        a, b, c = (faces[:, (first + k) % 3] for k in range(3))
        ab, bc, ca = (new[:, (first + k) % 3] for k in range(3))
        one = np.flatnonzero((cuts == 1) & (ab >= 0))
        add(one, a[one], ab[one], c[one])
        add(one, ab[one], b[one], c[one])
        # The corner a is cut off; the rest is a quad.
        two = np.flatnonzero((cuts == 2) & (ab >= 0) & (ca >= 0))
        add(two, a[two], ab[two], ca[two])
        add(two, ab[two], b[two], c[two])
        add(two, ab[two], c[two], ca[two])
        if first == 0:
            three = np.flatnonzero(cuts == 3)
            for corners in ((a, ab, ca), (ab, b, bc), (bc, c, ca), (ab, bc, ca)):
                add(three, *(corner[three] for corner in corners))
    parent = np.concatenate(parents)
    order = np.argsort(parent, kind="stable")
    return np.vstack(triangles)[order].astype(np.int32), parent[order].astype(np.int32)
