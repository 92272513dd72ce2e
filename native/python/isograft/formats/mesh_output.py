# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes written as OBJ or binary PLY: polygons as they were, colours, texture coordinates, marks, layers."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.formats.atomic import replacing
from isograft.formats.layers import FILLED, MATERIAL, Layers, Property, ply_properties
from isograft.formats.mesh import Floats, Ints
from isograft.formats.ply import KNOWN, KNOWN_OF_EDGES, WEIGHTS
from isograft.formats.ply_header import CODES

PathLike = str | os.PathLike[str]


@dataclass(eq=False)
class MeshOutput:
    """What is written: `sizes` (p,) corners of every polygon, `corners` (c,) their vertices one after another."""

    vertices: Floats
    sizes: Ints
    corners: Ints
    #: (n, 3 or 4) in [0, 1].
    colors: Floats | None = None
    #: (c, 2), NaN where a corner has none.
    corner_uvs: Floats | None = None
    #: (n,) vertices with values that were made up: the property isograft_filled of a PLY.
    filled: npt.NDArray[np.bool_] | None = None
    #: What else the mesh carries; a PLY has those of one number a row as properties.
    layers: Layers = field(default_factory=Layers)


def write_obj(path: PathLike, mesh: MeshOutput, materials: Sequence[str] = (), libraries: Sequence[str] = ()) -> None:
    """`materials` has the name of every polygon's material, of which `libraries` tell. OBJ has no place for marks."""
    # An empty one is called as other programs do.
    materials = [" ".join(name.split()) or "None" for name in materials]
    lines = [f"mtllib {name}\n" for name in libraries]
    rows = mesh.vertices.tolist()
    if mesh.colors is None:
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in rows]
    else:
        lines += [
            f"v {x:.9g} {y:.9g} {z:.9g} {r:.6g} {g:.6g} {b:.6g}\n"
            for (x, y, z), (r, g, b) in zip(rows, mesh.colors[:, :3].tolist(), strict=True)
        ]
    texts = (mesh.corners + 1).astype(str).tolist()
    normals = mesh.layers.normals
    has_normal = None if normals is None else (normals != 0).any(axis=1)
    uv_lines, uv_rows = _table_of_corners("vt", mesh.corner_uvs, None, mesh.sizes)
    normal_lines, normal_rows = _table_of_corners("vn", normals, has_normal, mesh.sizes)
    lines += uv_lines + normal_lines
    if uv_lines or normal_lines:
        texts = [
            f"{text}/{uv or ''}/{normal}" if normal else f"{text}/{uv}" if uv else text
            for text, uv, normal in zip(texts, uv_rows, normal_rows, strict=True)
        ]
    start = 0
    for row, size in enumerate(mesh.sizes.tolist()):
        if materials and (row == 0 or materials[row] != materials[row - 1]):
            lines.append(f"usemtl {materials[row]}\n")
        lines.append(f"f {' '.join(texts[start : start + size])}\n")
        start += size
    with replacing(path) as file:
        file.write("".join(lines).encode())


def face_materials(mesh: MeshOutput) -> list[str]:
    """The name of every polygon's material, as the layer MATERIAL has them; [] if that is not of strings."""
    names = mesh.layers.face.get(MATERIAL)
    return [] if names is None or names.dtype.kind != "U" or names.ndim != 1 else names.tolist()


def _table_of_corners(
    keyword: str, values: Floats | None, given: npt.NDArray[np.bool_] | None, sizes: Ints
) -> tuple[list[str], list[int]]:
    """Lines of the values that occur, and the number of its line for every corner (c,), 0 for none.

    OBJ wants all corners of a face or none to have them. `given` (c,); None: wherever they are numbers.
    """
    rows = np.zeros(int(sizes.sum()), np.int64)
    if values is None:
        return [], rows.tolist()
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    known = ~np.isnan(values).any(axis=1) if given is None else given
    chosen = np.bincount(polygon, weights=~known, minlength=len(sizes))[polygon] == 0
    table, index = np.unique(values[chosen], axis=0, return_inverse=True)
    rows[chosen] = index.reshape(-1) + 1
    return [f"{keyword} {' '.join(f'{value:.9g}' for value in row)}\n" for row in table.tolist()], rows.tolist()


def write_ply_mesh(path: PathLike, mesh: MeshOutput, texture: str | None = None) -> None:
    """Binary: vertices with colours, marks and normals, faces with `texcoord` (0 where a corner has none), edges that
    carry something, and all layers of one number a row. `texture` is the image that a comment names."""
    table, header = _vertex_table(mesh)
    faces, edges = ply_properties(mesh.layers.face, ()), ply_properties(mesh.layers.edge, KNOWN_OF_EDGES)
    header = [f"comment TextureFile {texture}", *header] if texture else header
    header += [f"element face {len(mesh.sizes)}", "property list uint int vertex_indices"]
    header += ["property list uint float texcoord"] if mesh.corner_uvs is not None else []
    header += [f"property {kind} {name}" for name, kind, _ in faces]
    parts = [table.tobytes(), _face_rows(mesh, faces)]
    if edges and mesh.layers.edges is not None:
        columns = [(name, "int", mesh.layers.edges[:, i]) for i, name in enumerate(("vertex1", "vertex2"))] + edges
        header += [f"element edge {len(mesh.layers.edges)}", *(f"property {kind} {name}" for name, kind, _ in columns)]
        parts.append(_table(columns).tobytes())
    with replacing(path) as file:
        file.write("\n".join(["ply", "format binary_little_endian 1.0", *header, "end_header", ""]).encode())
        for part in parts:
            file.write(part)


def _vertex_table(mesh: MeshOutput) -> tuple[npt.NDArray[Any], list[str]]:
    """The rows of the vertices, and the lines of the header about them."""
    columns: list[Property] = [(axis, "double", mesh.vertices[:, i]) for i, axis in enumerate("xyz")]
    if mesh.colors is not None:
        levels = np.rint(255 * np.clip(mesh.colors, 0, 1)).astype(np.uint8)
        columns += [
            (name, "uchar", levels[:, i]) for i, name in enumerate(("red", "green", "blue", "alpha")[: levels.shape[1]])
        ]
    if mesh.filled is not None:
        columns.append((FILLED, "uchar", mesh.filled.astype(np.uint8)))
    normals = _vertex_normals(mesh)
    if normals is not None:
        columns += [(f"n{axis}", "double", normals[:, i]) for i, axis in enumerate("xyz")]
    columns += ply_properties(mesh.layers.point, {*KNOWN, FILLED})
    columns += ply_properties(mesh.layers.weights, [name for name, _, _ in columns], WEIGHTS)
    table = _table(columns)
    return table, [f"element vertex {len(table)}", *(f"property {kind} {name}" for name, kind, _ in columns)]


def _vertex_normals(mesh: MeshOutput) -> Floats | None:
    """(n, 3) if all corners of each vertex agree on its normal, which is all that a PLY has room for; else None."""
    if mesh.layers.normals is None:
        return None
    normals = np.zeros_like(mesh.vertices)
    normals[mesh.corners] = mesh.layers.normals
    return normals if np.allclose(normals[mesh.corners], mesh.layers.normals, rtol=0.0, atol=1e-6) else None


def _table(columns: list[Property]) -> npt.NDArray[Any]:
    table = np.empty(len(columns[0][2]), [(name, "<" + CODES[kind]) for name, kind, _ in columns])
    for name, _, values in columns:
        table[name] = values
    return table


def _face_rows(mesh: MeshOutput, properties: list[Property]) -> bytes:
    """Rows of unlike length, those of polygons of one size at once."""
    sizes = mesh.sizes.astype(np.int64)
    starts = np.cumsum(sizes) - sizes
    more = [(f"p{i}", "<" + CODES[kind]) for i, (_, kind, _) in enumerate(properties)]
    uvs = None if mesh.corner_uvs is None else np.nan_to_num(mesh.corner_uvs)

    def row_of(size: int) -> np.dtype[Any]:
        lists: list[Any] = [("count", "<u4"), ("corners", "<i4", (size,))]
        lists += [("uv_count", "<u4"), ("uvs", "<f4", (size, 2))] if uvs is not None else []
        return np.dtype(lists + more)

    lengths = np.zeros(int(sizes.max(initial=0)) + 1, np.int64)
    kinds = np.unique(sizes)
    lengths[kinds] = [row_of(int(size)).itemsize for size in kinds]
    ends = np.cumsum(lengths[sizes])
    body = np.empty(int(ends[-1]) if len(ends) else 0, np.uint8)
    for size in kinds.tolist():
        which = np.flatnonzero(sizes == size)
        rows = np.empty(len(which), row_of(size))
        corners = starts[which, None] + np.arange(size)
        rows["count"], rows["corners"] = size, mesh.corners[corners]
        if uvs is not None:
            rows["uv_count"], rows["uvs"] = 2 * size, uvs[corners]
        for i, (_, _, values) in enumerate(properties):
            rows[f"p{i}"] = values[which]
        at = (ends - lengths[sizes])[which, None] + np.arange(lengths[size])
        body[at] = rows.view(np.uint8).reshape(len(which), -1)
    return body.tobytes()
