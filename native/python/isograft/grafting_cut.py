# SPDX-License-Identifier: GPL-3.0-or-later
"""A receiver's file cut along the donor's seams, with everything that it carries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isograft.correspondence import Correspondence
from isograft.formats.layers import Layers
from isograft.formats.mesh import MeshFile, Polygons
from isograft.formats.npz import Arrays
from isograft.grafting_moves import edges_of
from isograft.transfer import CutMesh, cut_along_seams
from isograft.transfer.arrays import Array, Progress


def cut_receiver(
    correspondence: Correspondence,
    receiver: MeshFile,
    donor: MeshFile,
    donor_uvs: Array,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> tuple[CutMesh, MeshFile, int]:
    """The map and the receiver, cut where seams of `donor_uvs` (G, 3, 2) run; and how many polygons were.

    What is cut becomes triangles, behind all other polygons. New vertices and corners have what lies between the two
    that they were made from: floats the mean by the place of the cut, all else that of the nearer one. Pieces of
    polygons and of edges have what the whole had; edges across polygons are new and have nothing.
    """
    cut = cut_along_seams(
        correspondence,
        receiver.vertices,
        receiver.faces,
        donor.vertices,
        donor.faces,
        donor_uvs,
        threads=threads,
        progress=progress,
    )
    old = receiver.polygons
    is_cut = np.zeros(len(old.sizes), bool)
    is_cut[receiver.triangle_polygon[np.bincount(cut.parent, minlength=len(receiver.faces)) > 1]] = True
    polygon = receiver.triangle_polygon[cut.parent]
    whole, pieces = ~is_cut[polygon], cut.faces[is_cut[polygon]]
    kept = np.repeat(~is_cut, old.sizes)
    number, corner = np.cumsum(~is_cut) - 1, np.cumsum(kept) - 1
    at_end = kept.sum() + np.arange(3 * len(pieces)).reshape(-1, 3)
    first, second, share = _corners(receiver, cut, ~whole)
    start = np.flatnonzero(kept)
    blend = _Blend(
        np.concatenate([start, first]), np.concatenate([start, second]), np.concatenate([np.zeros(len(start)), share])
    )
    own = np.arange(len(receiver.vertices))
    at_vertices = _Blend(
        np.concatenate([own, cut.edges[:, 0]]),
        np.concatenate([own, cut.edges[:, 1]]),
        np.concatenate([np.zeros(len(own)), cut.fraction]),
    )
    parents = np.concatenate([np.flatnonzero(~is_cut), polygon[~whole]])
    uvs = receiver.corner_uvs
    polygons = Polygons(
        cut.vertices,
        np.concatenate([old.sizes[~is_cut], np.full(len(pieces), 3, old.sizes.dtype)]),
        np.concatenate([old.corners[kept], pieces.ravel()]),
        None if old.colors is None else at_vertices(old.colors),
        uvs=None if uvs is None else blend(uvs),
        uv_index=None if uvs is None else np.arange(len(blend.first), dtype=np.int32),
        layers=_layers(old.layers, at_vertices, blend, parents),
    )
    mesh = MeshFile(
        receiver.path,
        cut.vertices,
        np.concatenate([cut.faces[whole], pieces]),
        np.concatenate([number[polygon[whole]], (~is_cut).sum() + np.arange(len(pieces))]).astype(np.int32),
        np.concatenate([corner[receiver.triangle_corners[cut.parent[whole]]], at_end]).astype(np.int32),
        polygons,
    )
    if old.layers.edges is not None:
        _cut_edges(receiver, mesh, cut)
    return cut, mesh, int(is_cut.sum())


@dataclass(frozen=True, eq=False)
class _Blend:
    """Rows between two rows each, `share` of the way from the first to the second."""

    first: Array
    second: Array
    share: Array

    def __call__(self, values: Array) -> Array:
        if values.dtype.kind != "f":
            picked: Array = values[np.where(self.share < 0.5, self.first, self.second)]
            return picked
        share = self.share.reshape(-1, *[1] * (values.ndim - 1)).astype(values.dtype)
        # Where nothing is cut, the very same number.
        mean: Array = np.where(
            share == 0, values[self.first], (1 - share) * values[self.first] + share * values[self.second]
        )
        return mean


def _corners(receiver: MeshFile, cut: CutMesh, chosen: npt.NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """For each corner of the chosen triangles of `cut` the two old corners that it lies between, and where."""
    count = len(receiver.vertices)
    corners = receiver.triangle_corners[cut.parent[chosen]]
    vertices = receiver.faces[cut.parent[chosen]]
    here = cut.faces[chosen]
    is_new = here >= count
    # An old corner lies between itself and itself.
    ends = np.stack([here, here], axis=2)
    ends[is_new] = cut.edges[here[is_new] - count]
    share = np.zeros(here.shape)
    share[is_new] = cut.fraction[here[is_new] - count]
    place = (ends[:, :, :, None] == vertices[:, None, None, :]).argmax(axis=3)
    found = np.take_along_axis(corners[:, None, :], place.reshape(len(here), 1, 6), axis=2).reshape(-1, 2)
    return found[:, 0], found[:, 1], share.ravel()


def _each(arrays: Arrays, move: Callable[[Array], Array]) -> Arrays:
    return {name: move(values) for name, values in arrays.items()}


def _layers(old: Layers, at_vertices: _Blend, at_corners: _Blend, parents: Array) -> Layers:
    """All but those of edges."""
    layers = Layers(
        point=_each(old.point, at_vertices),
        weights=_each(old.weights, at_vertices),
        keys=_each(old.keys, at_vertices),
        corner=_each(old.corner, at_corners),
        uv=_each(old.uv, at_corners),
        face=_each(old.face, lambda values: values[parents]),
    )
    if old.normals is not None:
        normals = at_corners(old.normals)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        unit = normals / np.where(length > 0, length, 1)
        given = [(old.normals[rows] != 0).any(axis=1) for rows in (at_corners.first, at_corners.second)]
        between = (at_corners.share > 0)[:, None]
        layers.normals = np.where(between, np.where((given[0] & given[1])[:, None], unit, 0.0), normals)
    return layers


def _cut_edges(receiver: MeshFile, mesh: MeshFile, cut: CutMesh) -> None:
    """The table of edges and their layers: two halves for every edge that is cut, then what runs across polygons."""
    old = receiver.layers
    assert old.edges is not None
    middle = {tuple(ends): len(receiver.vertices) + row for row, ends in enumerate(cut.edges.tolist())}
    new = np.array([middle.get((min(a, b), max(a, b)), -1) for a, b in old.edges.tolist()], np.int64).reshape(-1)
    halved = np.flatnonzero(new >= 0)
    edges = old.edges.astype(np.int64)
    edges[halved, 1] = new[halved]
    others = np.stack([new[halved], old.edges[halved, 1]], axis=1)
    # What runs across polygons is neither an edge of theirs nor half of one: those are in the table, or left out of it.
    key = np.array([len(mesh.vertices), 1])
    there = edges_of(receiver) @ key
    borders = np.flatnonzero(np.isin(cut.edges @ key, there))
    halves = [np.stack([cut.edges[borders, k], len(receiver.vertices) + borders], axis=1) @ key for k in range(2)]
    now = edges_of(mesh)
    across = now[~np.isin(now @ key, np.concatenate([there, *halves]))]
    rows = np.concatenate([np.arange(len(edges)), halved])
    layers = mesh.polygons.layers
    layers.edges = np.concatenate([edges, others, across]).astype(np.int32)
    for name, values in old.edge.items():
        nothing = np.zeros((len(across), *values.shape[1:]), values.dtype)
        layers.edge[name] = np.concatenate([values[rows], nothing])
