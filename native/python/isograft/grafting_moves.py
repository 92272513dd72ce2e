# SPDX-License-Identifier: GPL-3.0-or-later
"""One layer of a mesh file moved to another: rows as the files count them, not the triangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from isograft.formats.mesh import MeshFile
from isograft.progress import part_of
from isograft.transfer import (
    fill_corner,
    fill_edge,
    fill_face,
    fill_normals,
    fill_point,
    transfer_corner,
    transfer_corner_uv,
    transfer_edge,
    transfer_face,
    transfer_normals,
    transfer_point,
    transfer_shape_keys,
    transfer_weights,
)
from isograft.transfer.arrays import Array, CorrespondenceArrays, Progress
from isograft.transfer.shape_keys import Scale

Bools = npt.NDArray[np.bool_]


class Moved(NamedTuple):
    """A layer on the receiver."""

    values: Array
    """0, False or empty where there is none."""
    known: Bools
    """Rows that have a value, found or made up."""
    filled: Bools
    """(n,) vertices at what was made up and at nothing that was found."""


@dataclass(frozen=True, eq=False)
class Mover:
    """Moves layers of the donor's file along a correspondence, and fills what is unmatched if `fill` asks for it."""

    correspondence: CorrespondenceArrays
    receiver: MeshFile
    donor: MeshFile
    #: (e, 2) the receiver's edges, for layers of edges.
    edges: Array | None
    fill: bool
    threads: int | None
    progress: Progress | None

    def move(self, kind: str, values: Array, number: int = 0, count: int = 1) -> Moved:
        """Values of a domain, a "uv" map (c, 2), or "weights" (m, k); layer `number` of `count`, for the progress.

        Raises:
            InvalidInput: the map does not fit, or the values cannot be used.
        """
        progress = part_of(self.progress, number / count, (number + 1) / count)
        moves = {
            "point": self._point, "corner": self._corner, "face": self._face, "edge": self._edge, "uv": self._uv,
        }  # fmt: skip
        return self._weights(values, progress) if kind == "weights" else moves[kind](values, progress)

    def keys(self, keys: Array, scale: Scale, smoothing: int | None) -> Moved:
        """Displacements (k, m, 3) to (n, k, 3); see transfer_shape_keys()."""
        moved = transfer_shape_keys(
            self.correspondence,
            *self._geometry(),
            keys,
            scale=scale,
            smoothing=smoothing,
            threads=self.threads,
            progress=part_of(self.progress, 0.0, 0.7),
        )
        values = np.ascontiguousarray(np.moveaxis(moved.values, 0, 1))
        return self._completed(values, np.asarray(moved.mask), part_of(self.progress, 0.7, 1.0))

    def normals(self, normals: Array | None) -> Moved:
        """Custom normals of the corners (c, 3)."""
        return self._corners(transfer_normals, fill_normals, normals, self.progress)

    def _geometry(self) -> tuple[Array, Array, Array, Array]:
        return self.receiver.vertices, self.receiver.faces, self.donor.vertices, self.donor.faces

    def _point(self, values: Array, progress: Progress | None) -> Moved:
        moved = transfer_point(self.correspondence, self.donor.faces, values, progress=part_of(progress, 0.0, 0.3))
        result = moved.values
        result[~moved.mask] = np.zeros((), result.dtype)
        return self._completed(result, np.asarray(moved.mask), part_of(progress, 0.3, 1.0))

    def _weights(self, values: Array, progress: Progress | None) -> Moved:
        moved = transfer_weights(self.correspondence, self.donor.faces, values, progress=part_of(progress, 0.0, 0.3))
        rest = part_of(progress, 0.3, 1.0)
        return self._completed(moved.values, np.asarray(moved.mask), rest, low=0.0, high=1.0)

    def _completed(self, values: Array, known: Bools, progress: Progress | None, **limits: float) -> Moved:
        if not self._to_fill(known):
            return Moved(values, known, np.zeros(len(known), bool))
        values, filled = fill_point(
            self.receiver.vertices, self.receiver.faces, values, known, progress=progress, **limits
        )
        return Moved(values, known | filled, filled)

    def _corner(self, values: Array, progress: Progress | None) -> Moved:
        return self._corners(transfer_corner, fill_corner, values, progress)

    def _uv(self, values: Array, progress: Progress | None) -> Moved:
        return self._corners(transfer_corner_uv, fill_corner, values, progress)

    def _corners(self, transfer: Any, fill: Any, values: Any, progress: Progress | None) -> Moved:
        own = self.receiver
        moved = transfer(
            self.correspondence,
            *self._geometry(),
            values[self.donor.triangle_corners],
            receiver_polygons=own.triangle_polygon,
            threads=self.threads,
            progress=part_of(progress, 0.0, 0.7),
        )
        result, known = moved[0], np.asarray(moved.mask)
        filled = np.zeros_like(known)
        if self._to_fill(known):
            result, filled = fill(own.vertices, own.faces, result, known, progress=part_of(progress, 0.7, 1.0))
        triangles = known | filled
        rows = np.zeros((len(own.polygons.corners), *result.shape[1:]), result.dtype)
        rows[own.triangle_corners[triangles]] = result.reshape(-1, 3, *result.shape[1:])[triangles]
        has = np.zeros(len(rows), bool)
        has[own.triangle_corners[triangles]] = True
        return Moved(rows, has, self._vertices_of(filled, known))

    def _face(self, values: Array, progress: Progress | None) -> Moved:
        own = self.receiver
        moved = transfer_face(
            self.correspondence,
            *self._geometry(),
            values,
            receiver_polygons=own.triangle_polygon,
            donor_polygons=self.donor.triangle_polygon,
            threads=self.threads,
            progress=part_of(progress, 0.0, 0.7),
        )
        # Polygons without a triangle at the end of the file are not counted there.
        rest = len(own.polygons.sizes) - len(moved.mask)
        result = np.concatenate([moved.values, np.zeros((rest, *moved.values.shape[1:]), moved.values.dtype)])
        known = np.concatenate([moved.mask, np.zeros(rest, bool)])
        filled = np.zeros_like(known)
        if self._to_fill(known):
            result, filled = fill_face(
                own.vertices,
                own.faces,
                result,
                known,
                polygons=own.triangle_polygon,
                progress=part_of(progress, 0.7, 1.0),
            )
        marks = self._vertices_of(filled[own.triangle_polygon], known[own.triangle_polygon])
        return Moved(result, known | filled, marks)

    def _edge(self, values: Array, progress: Progress | None) -> Moved:
        own, faces, given, donor_faces = self._geometry()
        edges = np.zeros((0, 2), np.int32) if self.edges is None else self.edges
        moved = transfer_edge(
            self.correspondence,
            own,
            faces,
            edges,
            given,
            donor_faces,
            self.donor.layers.edges,
            values,
            threads=self.threads,
            progress=part_of(progress, 0.0, 0.7),
        )
        matched = np.asarray(self.correspondence.face) >= 0
        # A matched edge without a value has none on the donor either: that is known of it.
        known: Bools = np.asarray(matched[edges].all(axis=1))
        filled = np.zeros(len(own), bool)
        if not self._to_fill(known):
            return Moved(moved.values, known, filled)
        result, made_up = fill_edge(own, edges, moved.values, known, progress=part_of(progress, 0.7, 1.0))
        filled[edges[made_up]] = True
        return Moved(result, known | made_up, filled & ~matched)

    def _to_fill(self, known: Bools) -> bool:
        return self.fill and bool(known.any()) and not bool(known.all())

    def _vertices_of(self, filled: Bools, known: Bools) -> Bools:
        """(n,) vertices of filled triangles (F,) that no known triangle (F,) touches."""
        marked = np.zeros(len(self.receiver.vertices), bool)
        marked[self.receiver.faces[filled]] = True
        marked[self.receiver.faces[known]] = False
        return marked


def edges_of(mesh: MeshFile) -> npt.NDArray[np.int32]:
    """(e, 2) vertices of the polygons' edges, the lower first, in ascending order."""
    sizes = mesh.polygons.sizes[mesh.polygons.sizes > 0].astype(np.int64)
    ends = np.cumsum(sizes)
    following = np.arange(1, int(sizes.sum()) + 1)
    following[ends - 1] = ends - sizes
    corners = mesh.polygons.corners
    pairs = np.sort(np.stack([corners, corners[following]], axis=1), axis=1)
    return np.unique(pairs[pairs[:, 0] != pairs[:, 1]], axis=0).astype(np.int32).reshape(-1, 2)
