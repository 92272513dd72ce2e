# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes written as OBJ or binary PLY: polygons as they were, colours, texture coordinates, marks."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from isograft.formats.atomic import replacing
from isograft.formats.mesh import Floats, Ints

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


def write_obj(path: PathLike, mesh: MeshOutput, material: str | None = None) -> None:
    """`material` is the file named by mtllib, its material is called isograft. OBJ has no place for marks."""
    lines = [f"mtllib {material}\n"] if material else []
    rows = mesh.vertices.tolist()
    if mesh.colors is None:
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in rows]
    else:
        lines += [
            f"v {x:.9g} {y:.9g} {z:.9g} {r:.6g} {g:.6g} {b:.6g}\n"
            for (x, y, z), (r, g, b) in zip(rows, mesh.colors[:, :3].tolist(), strict=True)
        ]
    texts = (mesh.corners + 1).astype(str).tolist()
    if mesh.corner_uvs is not None:
        given = np.flatnonzero(~np.isnan(mesh.corner_uvs).any(axis=1))
        table, index = np.unique(mesh.corner_uvs[given], axis=0, return_inverse=True)
        lines += [f"vt {u:.9g} {v:.9g}\n" for u, v in table.tolist()]
        for corner, row in zip(given.tolist(), index.reshape(-1).tolist(), strict=True):
            texts[corner] += f"/{row + 1}"
        _drop_parts(texts, mesh.sizes)
    if material:
        lines.append("usemtl isograft\n")
    start = 0
    for size in mesh.sizes.tolist():
        lines.append(f"f {' '.join(texts[start : start + size])}\n")
        start += size
    with replacing(path) as file:
        file.write("".join(lines).encode("ascii"))


def _drop_parts(texts: list[str], sizes: Ints) -> None:
    """OBJ wants all corners of a face or none to have texture coordinates."""
    start = 0
    for size in sizes.tolist():
        corners = range(start, start + size)
        if not all("/" in texts[i] for i in corners):
            for i in corners:
                texts[i] = texts[i].partition("/")[0]
        start += size


def write_mtl(path: PathLike, image: str) -> None:
    """One material, isograft, with an image as its colour."""
    with replacing(path) as file:
        file.write(f"newmtl isograft\nKd 1 1 1\nmap_Kd {image}\n".encode())


def write_ply_mesh(path: PathLike, mesh: MeshOutput) -> None:
    """Binary: vertices with colours and marks, faces with `texcoord` (0 where a corner has none)."""
    columns: list[tuple[str, str, npt.NDArray[np.generic]]] = [
        (axis, "double", mesh.vertices[:, i]) for i, axis in enumerate("xyz")
    ]
    if mesh.colors is not None:
        levels = np.rint(255 * np.clip(mesh.colors, 0, 1)).astype(np.uint8)
        columns += [
            (name, "uchar", levels[:, i]) for i, name in enumerate(("red", "green", "blue", "alpha")[: levels.shape[1]])
        ]
    if mesh.filled is not None:
        columns.append(("isograft_filled", "uchar", mesh.filled.astype(np.uint8)))
    codes = {"double": "<f8", "uchar": "<u1"}
    table = np.empty(len(mesh.vertices), [(name, codes[kind]) for name, kind, _ in columns])
    for name, _, values in columns:
        table[name] = values
    header = [
        "ply", "format binary_little_endian 1.0", f"element vertex {len(table)}",
        *(f"property {kind} {name}" for name, kind, _ in columns),
        f"element face {len(mesh.sizes)}", "property list uint int vertex_indices",
    ]  # fmt: skip
    starts = np.cumsum(mesh.sizes) - mesh.sizes
    if mesh.corner_uvs is None:
        body = np.insert(mesh.corners, starts, mesh.sizes).astype("<i4").tobytes()
    else:
        header.append("property list uint float texcoord")
        uvs = np.nan_to_num(mesh.corner_uvs).astype("<f4")
        # Per polygon: its size, its corners, twice its size, their coordinates; all of four bytes.
        words = np.empty(len(mesh.corners) * 3 + 2 * len(mesh.sizes), "<i4")
        at = 3 * starts + 2 * np.arange(len(mesh.sizes))
        words[at] = mesh.sizes
        within = np.arange(len(mesh.corners)) - np.repeat(starts, mesh.sizes)
        words[np.repeat(at, mesh.sizes) + 1 + within] = mesh.corners
        words[at + 1 + mesh.sizes] = 2 * mesh.sizes
        for k in range(2):
            words[np.repeat(at + 2 + mesh.sizes, mesh.sizes) + 2 * within + k] = uvs[:, k].view("<i4")
        body = words.tobytes()
    with replacing(path) as file:
        file.write("\n".join([*header, "end_header", ""]).encode("ascii"))
        file.write(table.tobytes())
        file.write(body)
