# SPDX-License-Identifier: GPL-3.0-or-later
"""What a mesh carries beside its shape: attributes of every domain, UV maps, vertex groups, shape keys, custom normals.

In an .npz each is an array with a name of its own, whose rows are counted as the mesh file counts them:

    point/NAME    (n, ...) one row per vertex
    corner/NAME   (c, ...) one row per corner of the file's polygons, one polygon after another
    face/NAME     (p, ...) one row per polygon
    edge/NAME     (e, ...) one row per row of `edges`, (e, 2): the vertices of each edge
    uv/NAME       (c, 2) a UV map, beside the one that the file has
    weights/NAME  (n,) a vertex group, numbers >= 0
    keys/NAME     (n, 3) a shape key: displacements from the file's shape
    normals       (c, 3) custom normals of the corners, 0 for none

Attributes are numbers, booleans or strings. A PLY file has those of one number a row as properties of its elements
vertex, face and edge (with vertex1 and vertex2), vertex groups as properties of the vertices called weights/NAME. An
OBJ file has face/material, of strings.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing
from isograft.formats.npz import Arrays, PathLike, load_arrays

DOMAINS = ("point", "corner", "face", "edge")
KINDS = (*DOMAINS, "uv", "weights", "keys")
#: The attribute of vertices that marks what a transfer made up.
FILLED = "isograft_filled"
#: The attribute of edges that marks seams, as the add-on calls it.
SEAMS = "uv_seam"
#: The attribute of faces that an OBJ file has: the name of the material, empty for none.
MATERIAL = "material"
_WORDS = {"point": "vertices", "weights": "vertices", "keys": "vertices", "corner": "corners of polygons",
          "uv": "corners of polygons", "face": "polygons", "edge": "edges"}  # fmt: skip
_PLY_TYPES = {"i1": "char", "u1": "uchar", "i2": "short", "u2": "ushort", "i4": "int", "u4": "uint", "f4": "float",
              "f8": "double", "b1": "uchar"}  # fmt: skip


@dataclass(eq=False)
class Layers:
    """Arrays by name, as above; `edges` are those that `edge` counts, None without any."""

    point: Arrays = field(default_factory=dict)
    corner: Arrays = field(default_factory=dict)
    face: Arrays = field(default_factory=dict)
    edge: Arrays = field(default_factory=dict)
    uv: Arrays = field(default_factory=dict)
    weights: Arrays = field(default_factory=dict)
    keys: Arrays = field(default_factory=dict)
    edges: npt.NDArray[np.int32] | None = None
    normals: npt.NDArray[np.float64] | None = None

    def of(self, kind: str) -> Arrays:
        """Those of one of KINDS."""
        arrays: Arrays = getattr(self, kind)
        return arrays

    def with_(self, other: Layers) -> Layers:
        """These and the other's, which take the place of those of the same name; one table of edges is kept."""
        merged = {kind: {**self.of(kind), **other.of(kind)} for kind in KINDS}
        edges = self.edges
        if other.edges is not None:
            merged["edge"], edges = dict(other.edge), other.edges
        return Layers(**merged, edges=edges, normals=self.normals if other.normals is None else other.normals)

    def __bool__(self) -> bool:
        return any(
            value is not None and len(value) > 0 for value in (getattr(self, item.name) for item in fields(self))
        )


def write_layers(path: PathLike, layers: Layers) -> None:
    """Write an .npz with the arrays named as above, whole or not at all."""
    arrays = {f"{kind}/{name}": array for kind in KINDS for name, array in layers.of(kind).items()}
    arrays |= {name: array for name in ("edges", "normals") if (array := getattr(layers, name)) is not None}
    with replacing(path) as file:
        # No allow_pickle: an older numpy would take it for an array.
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]


def read_layers(path: PathLike, vertices: int, sizes: npt.NDArray[np.int32], mesh: str) -> Layers:
    """What write_layers() wrote, for the mesh called `mesh` with so many vertices and polygons of so many corners.

    Raises InvalidInput naming the file and the array that is unknown, malformed, or of another mesh.
    """
    found = load_arrays(path)
    layers = Layers()
    rows = {"point": vertices, "weights": vertices, "keys": vertices, "face": len(sizes)}
    rows["corner"] = rows["uv"] = int(sizes.sum())
    if "edges" in found:
        layers.edges = _edges(path, found["edges"], vertices)
        rows["edge"] = len(layers.edges)
    for key, array in found.items():
        kind, _, name = key.partition("/")
        if key == "normals":
            _check(path, key, array, "corner", rows, mesh)
            layers.normals = _numbers(path, key, array, 3)
        elif kind in KINDS and name:
            if kind not in rows:
                raise InvalidInput(f"{path}: {key} needs the array edges, (e, 2), the vertices of each edge")
            _check(path, key, array, kind, rows, mesh)
            width = {"uv": 2, "weights": 1, "keys": 3}.get(kind)
            layers.of(kind)[name] = array if width is None else _numbers(path, key, array, width)
        elif key != "edges":
            known = ", ".join(f"{kind}/NAME" for kind in KINDS)
            raise InvalidInput(f"{path}: the array {key} is none of {known}, edges, normals; rename it or leave it out")
    return layers


def _edges(path: PathLike, edges: npt.NDArray[Any], vertices: int) -> npt.NDArray[np.int32]:
    if edges.ndim != 2 or edges.shape[1] != 2 or edges.dtype.kind not in "iu":
        raise InvalidInput(f"{path}: edges should be integers of shape (e, 2), and is {edges.dtype} {edges.shape}")
    bad = np.flatnonzero(((edges < 0) | (edges >= vertices)).any(axis=1))
    if bad.size:
        raise InvalidInput(f"{path}: edges row {bad[0]} is {edges[bad[0]].tolist()}: there are {vertices} vertices")
    return edges.astype(np.int32)


def _check(path: PathLike, key: str, array: npt.NDArray[Any], kind: str, rows: dict[str, int], mesh: str) -> None:
    if array.dtype.kind not in "biufUS":
        raise InvalidInput(f"{path}: {key} holds {array.dtype}; numbers, booleans and strings can be moved")
    count = len(array) if array.ndim else "no"
    if count != rows[kind]:
        whose = f"{path} has" if kind == "edge" else f"{mesh} has"
        raise InvalidInput(f"{path}: {key} has {count} rows, {whose} {rows[kind]} {_WORDS[kind]}; save it anew")


def _numbers(path: PathLike, key: str, array: npt.NDArray[Any], width: int) -> npt.NDArray[Any]:
    shape = (len(array),) if width == 1 else (len(array), width)
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InvalidInput(f"{path}: {key} should be numbers of shape {shape}, and is {array.dtype} {array.shape}")
    return array if array.dtype == np.float32 else array.astype(np.float64)


Property = tuple[str, str, npt.NDArray[Any]]


def ply_properties(arrays: Arrays, taken: Iterable[str], prefix: str = "") -> list[Property]:
    """Name, type and values of all that a PLY file can have as a property: one number a row, under a name not `taken`.

    White space in a name becomes an underscore.
    """
    used, found = set(taken), []
    for name, array in arrays.items():
        word = prefix + re.sub(r"\s", "_", name)
        kind = _PLY_TYPES.get(array.dtype.str[1:])
        if array.ndim == 1 and kind is not None and word not in used:
            used.add(word)
            found.append((word, kind, array))
    return found
