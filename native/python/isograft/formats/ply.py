# SPDX-License-Identifier: GPL-3.0-or-later
"""PLY, text and binary of both byte orders: vertices, normals, colours, texture coordinates and polygons of any size.

Other numbers of vertices, faces and edges are layers; but what is called isograft_... is a mark of a map or of a
transfer. Whatever else a file holds is passed over, wherever it stands.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.layers import Layers
from isograft.formats.mesh import Floats, Polygons
from isograft.formats.npz import Arrays
from isograft.formats.ply_body import BinaryBody, Column, ListColumn, TextBody
from isograft.formats.ply_header import Element, read_header

_UV_NAMES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))
_COLORS = ("red", "green", "blue", "alpha")
_NORMALS = ("nx", "ny", "nz")
_ENDS = ("vertex1", "vertex2")
#: Properties of vertices that have a meaning of their own, and of edges.
KNOWN = frozenset({*"xyz", *_NORMALS, *_COLORS, *(name for pair in _UV_NAMES for name in pair)})
KNOWN_OF_EDGES = frozenset(_ENDS)
#: Begins the names of vertex groups.
WEIGHTS = "weights/"


def read_ply(path: str, data: bytes) -> Polygons:
    """Raises InvalidInput naming the line (header, text) or the byte (binary)."""
    header = read_header(path, data)
    body: TextBody | BinaryBody
    if header.byte_order is None:
        body = TextBody(path, data[header.end :], header.lines)
    else:
        body = BinaryBody(path, data, header.end, header.byte_order)
    found: dict[str, dict[str, Column]] = {}
    for element in header.elements:
        if element.name == "tristrips":
            raise InvalidInput(f"{path}: triangle strips are not supported: save the mesh with faces")
        found[element.name] = body.read(element)
    vertex, face, edge = (found.get(name, {}) for name in ("vertex", "face", "edge"))
    if any(name not in vertex for name in "xyz"):
        raise InvalidInput(f"{path}: line {header.lines}: the header names no vertex element with x, y and z")
    vertices = np.stack([_plain(vertex[name], path) for name in "xyz"], axis=1)
    corners = next((face[name] for name in ("vertex_indices", "vertex_index") if name in face), None)
    if face and not isinstance(corners, ListColumn):
        raise InvalidInput(f"{path}: line {header.lines}: the faces have no list vertex_indices")
    if not isinstance(corners, ListColumn):
        sizes = indices = np.empty(0, np.int32)
    else:
        sizes, indices = _indices(corners, len(vertices), path, body)
    polygons = Polygons(vertices=vertices, sizes=sizes, corners=indices, colors=_colors(vertex, header.elements, path))
    if all(name in vertex for name in _NORMALS):
        polygons.normals = np.stack([_plain(vertex[name], path) for name in _NORMALS], axis=1)
    _add_uvs(polygons, vertex, face, path)
    polygons.layers = _layers(vertex, face, edge, header.elements)
    if all(name in edge for name in _ENDS):
        polygons.layers.edges = _edges(edge, len(vertices), path)
    return polygons


def _layers(
    vertex: dict[str, Column], face: dict[str, Column], edge: dict[str, Column], elements: list[Element]
) -> Layers:
    code = {(element.name, p.name): p.code for element in elements for p in element.properties}

    def others(name: str, columns: dict[str, Column], known: frozenset[str]) -> Arrays:
        # Text is read as floats, and a binary file may be of the other byte order.
        with np.errstate(invalid="ignore"):
            return {
                key: column.astype(code[name, key])
                for key, column in columns.items()
                if not isinstance(column, ListColumn) and key not in known and not key.startswith("isograft_")
            }

    of_vertices = others("vertex", vertex, KNOWN)
    return Layers(
        point={name: values for name, values in of_vertices.items() if not name.startswith(WEIGHTS)},
        weights={name[len(WEIGHTS) :]: values for name, values in of_vertices.items() if name.startswith(WEIGHTS)},
        face=others("face", face, frozenset()),
        edge=others("edge", edge, KNOWN_OF_EDGES) if all(name in edge for name in _ENDS) else {},
    )


def _edges(edge: dict[str, Column], vertices: int, path: str) -> npt.NDArray[np.int32]:
    ends = np.stack([_plain(edge[name], path) for name in _ENDS], axis=1)
    bad = np.flatnonzero(~((ends >= 0) & (ends < vertices)).all(axis=1))
    if bad.size:
        raise InvalidInput(
            f"{path}: edge {bad[0]} has the ends {ends[bad[0], 0]:g} and {ends[bad[0], 1]:g}, the file has {vertices} "
            "vertices"
        )
    return ends.astype(np.int32)


def _plain(column: Column, path: str) -> Floats:
    if isinstance(column, ListColumn):
        raise InvalidInput(f"{path}: a property that should be a number is a list")
    return column.astype(np.float64)


def _indices(
    column: ListColumn, vertices: int, path: str, body: TextBody | BinaryBody
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    bad = np.flatnonzero(~((column.items >= 0) & (column.items < vertices) & (column.items == np.floor(column.items))))
    if bad.size:
        face = int(np.searchsorted(np.cumsum(column.sizes), bad[0], side="right"))
        raise InvalidInput(
            f"{path}: {body.place(column, face)}: face {face} has the corner {column.items[bad[0]]:g}, "
            f"the file has {vertices} vertices"
        )
    return column.sizes.astype(np.int32), column.items.astype(np.int32)


def _colors(vertex: dict[str, Column], elements: list[Element], path: str) -> Floats | None:
    names = [name for name in _COLORS if name in vertex]
    if names[:3] != ["red", "green", "blue"]:
        return None
    element = next(element for element in elements if element.name == "vertex")
    channels = []
    for name in names:
        code = next(p.code for p in element.properties if p.name == name)
        full = float(np.iinfo(code).max) if np.dtype(code).kind in "iu" else 1.0
        channels.append(_plain(vertex[name], path) / full)
    return np.stack(channels, axis=1)


def _add_uvs(polygons: Polygons, vertex: dict[str, Column], face: dict[str, Column], path: str) -> None:
    """Of the corners (texcoord, two numbers a corner) if there are any, else of the vertices."""
    wedge = face.get("texcoord")
    if isinstance(wedge, ListColumn) and (wedge.sizes == 2 * polygons.sizes).all():
        polygons.uvs = wedge.items.astype(np.float64).reshape(-1, 2)
        polygons.uv_index = np.arange(len(polygons.corners), dtype=np.int32)
        return
    for u, v in _UV_NAMES:
        if u in vertex and v in vertex:
            polygons.uvs = np.stack([_plain(vertex[u], path), _plain(vertex[v], path)], axis=1)
            polygons.uv_index = polygons.corners.copy()
            return
