# SPDX-License-Identifier: GPL-3.0-or-later
"""Cut a receiver's faces where the donor's seams run through them, and carry its match over to the cut mesh."""

from dataclasses import dataclass
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
from isograft import transfer

from . import bridge, matching
from .bridge import Array, RefusedError
from .job import Progress
from .pairing import Pair

_COUNTED = {"MULTIRES", "PARTICLE_SYSTEM", "MESH_CACHE", "MESH_SEQUENCE_CACHE"}
"""Modifiers whose data belong to the faces as they are."""


@dataclass(frozen=True)
class Cut:
    """What is to be cut, found but not done. Holds no object: it is done to a copy of the mesh and to itself."""

    edges: Array
    """(c,) of the receiver's mesh."""
    starts: Array
    """(c,) the vertex that fractions count from."""
    fractions: Array
    """(c,)."""
    faces: Array
    """(k,) polygons to cut."""
    ends: Array
    """(k, 2) rows of `edges` whose new vertices are joined."""
    match: dict[str, Array]
    """Attributes of the match at the new vertices."""
    left_whole: int
    """Concave faces that a seam crosses."""

    def apply(self, obj: Any) -> None:
        """Cut the object's own mesh and write its match anew."""
        read = {name: bridge.read_attribute(obj, name, kind) for name, kind in matching.ATTRIBUTES.items()}
        content = bridge.read_property(obj) or {}
        rows = bridge.cut_faces(obj, self.edges, self.starts, self.fractions, self.faces, self.ends)
        for name, kind in matching.ATTRIBUTES.items():
            old = read[name]
            if old is None:
                continue
            values = np.zeros((len(obj.data.vertices), *old.shape[1:]), dtype=old.dtype)
            values[: len(old)] = old
            values[rows] = self.match[name]
            bridge.write_attribute(obj, name, "POINT", kind, values)
        bpy.context.view_layer.update()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        content["receiver_hash"] = bridge.read_receiver(obj, depsgraph).content_hash
        bridge.write_property(obj, content)


def refuse(pair: Pair) -> None:
    """Raises RefusedError if the receiver must not be cut."""
    donor = pair.donor.obj.name
    if pair.donor.is_own:
        raise RefusedError(
            f"{pair.name} cannot be cut, it is what {donor} was matched to; run Match with {donor} as the active "
            "object, or switch Cut Seams off"
        )
    for item in pair.receiver.modifiers:
        if item.type in _COUNTED or getattr(item, "is_bound", False) or getattr(item, "is_bind", False):
            raise RefusedError(
                f"{pair.name}: cutting would spoil its modifier {item.name}; apply or remove it, or switch Cut Seams "
                "off"
            )
    for obj in bpy.data.objects:
        for item in obj.modifiers:
            if getattr(item, "is_bound", False) and pair.receiver in (
                getattr(item, "target", None),
                getattr(item, "object", None),
            ):
                raise RefusedError(
                    f"{pair.name} cannot be cut, the modifier {item.name} of {obj.name} is bound to it; unbind it, or "
                    "switch Cut Seams off"
                )


@dataclass(frozen=True)
class Search:
    """What finding a cut needs of Blender, read; find() touches no object of Blender's."""

    pair: Pair
    corner_uv: Array
    """(3 G, 2) of the donor's UV map."""
    read: dict[str, Array]
    """Attributes of the match that new vertices take the mean of."""

    @classmethod
    def of(cls, pair: Pair, corner_uv: Array) -> "Search":
        """Read the attributes from the receiver's own mesh."""
        kinds = {name: matching.ATTRIBUTES[name] for name in _MEANS}
        return cls(
            pair, corner_uv, {name: bridge.read_attribute(pair.receiver, name, kind) for name, kind in kinds.items()}
        )

    def find(self, progress: Progress | None = None) -> Cut | None:
        """Where the seams of the donor's UV map run through faces of the receiver; None if nowhere."""
        pair, read = self.pair, self.read
        found = transfer.cut_along_seams(pair.correspondence, *pair.geometry(), self.corner_uv, progress=progress)
        rows = _rows_of(pair.arrays.edges, found.edges)
        real = np.flatnonzero(rows >= 0)
        if not len(real):
            return None
        number = np.full(len(found.edges) + 1, -1)
        number[real] = np.arange(len(real))
        sides = np.stack([pair.own.triangles, np.roll(pair.own.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
        crossed = _rows_of(found.edges, sides).reshape(-1, 3)
        faces, ends, left_whole = _chords(pair, crossed, number, rows[real])
        new = len(pair.own.vertices) + real
        first, second = found.edges[real].T
        at = SimpleNamespace(
            face=found.face[new],
            barycentric=found.barycentric[new],
            vertex=found.vertex[new],
            **{field: combine(read[name][first], read[name][second]) for name, (field, combine) in _MEANS.items()},
        )
        return Cut(
            rows[real],
            first.astype(np.int64),
            found.fraction[real],
            faces,
            ends,
            matching.attributes(pair.donor.arrays, at),
            left_whole,
        )


_MEANS = {
    "isograft_confidence": ("confidence", np.minimum),
    "isograft_stretch": ("stretch", np.maximum),
    "isograft_region": ("region", lambda first, _: first),
}
"""What a new vertex has of the two ends of its edge."""


def _rows_of(known: Array, edges: Array) -> Array:
    """For each of `edges` (q, 2) its row in `known` (r, 2), -1 if it is not there."""
    if not len(known) or not len(edges):
        return np.full(len(edges), -1)
    width = np.int64(max(known.max(), edges.max()) + 1)
    there, wanted = (np.sort(pairs, axis=1).astype(np.int64) @ [width, 1] for pairs in (known, edges))
    order = np.argsort(there, kind="stable")
    place = np.searchsorted(there[order], wanted).clip(max=len(there) - 1)
    rows: Array = np.where(there[order][place] == wanted, order[place], -1)
    return rows


def _chords(pair: Pair, crossed: Array, number: Array, edges: Array) -> tuple[Array, Array, int]:
    """Polygons to cut (k,), the two new vertices (k, 2) of each chord, and how many polygons are left whole.

    A seam is followed from triangle to triangle of its polygon: what it joins on the polygon's border is joined.

    Args:
        crossed: (F, 3) row of the cut of every triangle side, -1 for none.
        number: new vertex of every such row, -1 where it lies inside a polygon.
        edges: the mesh's edge of every new vertex.
    """
    arrays = pair.arrays
    order = np.argsort(arrays.loop_polygons, kind="stable")
    start = np.searchsorted(arrays.loop_polygons[order], np.arange(arrays.polygon_count + 1))
    links: dict[int, list[list[int]]] = {}
    for triangle in np.flatnonzero((crossed >= 0).sum(axis=1) > 1):
        rows = [int(row) for row in crossed[triangle] if row >= 0]
        links.setdefault(int(pair.own.polygons[triangle]), []).append(rows)
    faces, ends, left_whole = [], [], 0
    for polygon in sorted(links):
        loops = order[start[polygon] : start[polygon + 1]]
        if not _is_convex(pair.own.vertices[arrays.loop_vertices[loops]]):
            left_whole += 1
            continue
        place = {int(edge): at for at, edge in enumerate(arrays.loop_edges[loops])}
        for part in _joined(links[polygon]):
            ring = sorted((number[row] for row in part if number[row] >= 0), key=lambda row: place[int(edges[row])])
            chords = list(pairwise(ring)) + ([(ring[-1], ring[0])] if len(ring) > 2 else [])
            faces += [polygon] * len(chords)
            ends += chords
    return np.array(faces, dtype=np.int64), np.array(ends, dtype=np.int64).reshape(-1, 2), left_whole


def _joined(groups: list[list[int]]) -> list[list[int]]:
    """Groups that have a number in common are one, in the order of their first."""
    parts: list[list[int]] = []
    for group in groups:
        touching = [part for part in parts if set(part) & set(group)]
        parts = [part for part in parts if part not in touching]
        parts.append(sorted({number for part in [*touching, group] for number in part}))
    return sorted(parts)


def _is_convex(points: Array) -> bool:
    """True if the polygon (n, 3) turns one way only."""
    ahead = np.roll(points, -1, axis=0)
    normal = np.cross(points, ahead).sum(axis=0)
    turn = np.cross(points - np.roll(points, 1, axis=0), ahead - points) @ normal
    return bool((turn >= -1e-6 * np.abs(turn).max(initial=0.0)).all())
