# SPDX-License-Identifier: GPL-3.0-or-later
"""OFF and its variants with colours, normals and texture coordinates (COFF, NOFF, STOFF): text only."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.mesh import Polygons
from isograft.formats.text import Lines, parse_ints, quoted, whole

_KEYWORD = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF$")


def read_off(path: str, data: bytes) -> Polygons:
    """Raises InvalidInput naming the line."""
    lines = Lines(path, data)
    if not len(lines):
        raise InvalidInput(f"{path}: line 1: the file is empty")
    head = lines.text[0].split()
    keyword = _KEYWORD.match(head[0])
    has_uvs = has_colors = has_normals = False
    row = 0
    if keyword is not None:
        if keyword[4] or keyword[5]:
            lines.fail(0, f"{quoted(head[0])}: only three dimensions are supported")
        if head[1:2] == [b"BINARY"]:
            lines.fail(0, "binary OFF is not supported: save it as text, or as PLY")
        has_uvs, has_colors, has_normals = bool(keyword[1]), bool(keyword[2]), bool(keyword[3])
        head = head[1:]
        if not head:
            row = 1
            if len(lines) < 2:
                lines.fail(1, "the numbers of vertices and faces are missing")
            head = lines.text[1].split()
    if not 2 <= len(head) <= 3:
        lines.fail(row, f"{quoted(b' '.join(head))} is not the numbers of vertices, faces and edges")
    vertex_count, face_count = parse_ints(lines, row, head[:2], "header")
    if vertex_count < 0 or face_count < 0:
        lines.fail(row, "the numbers of vertices and faces must not be negative")
    start = row + 1
    table = lines.table(start, vertex_count, "vertices", 3 + 3 * has_normals + 2 * has_uvs)
    sizes, corners = _faces(lines, start + vertex_count, face_count, vertex_count)
    # Plain OFF with four numbers more, or three, is in use for colours too.
    extra = table.shape[1] - 3 - 3 * has_normals - 2 * has_uvs
    colors = _colors(table[:, 3 + 3 * has_normals :][:, :extra]) if has_colors or extra in (3, 4) else None
    return Polygons(
        vertices=np.ascontiguousarray(table[:, :3]),
        sizes=sizes,
        corners=corners,
        colors=colors,
        uvs=np.ascontiguousarray(table[:, -2:]) if has_uvs else None,
        uv_index=corners.copy() if has_uvs else None,
    )


def _faces(lines: Lines, start: int, count: int, vertices: int) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    values, counts = lines.ragged(start, count, "faces")
    first = np.cumsum(counts) - counts
    sizes = values[first]
    wrong = np.flatnonzero(~(whole(sizes) & (sizes >= 0)))
    if wrong.size:
        lines.fail(start + int(wrong[0]), f"face: {sizes[wrong[0]]:g} is no number of corners")
    sizes = sizes.astype(np.int64)
    short = np.flatnonzero(counts <= sizes)
    if short.size:
        row = int(short[0])
        lines.fail(start + row, f"face: {counts[row] - 1} corners, its count says {sizes[row]}")
    within = np.arange(int(sizes.sum())) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    corners = values[np.repeat(first + 1, sizes) + within]
    bad = np.flatnonzero(~(whole(corners) & (corners >= 0) & (corners < vertices)))
    if bad.size:
        face = int(np.searchsorted(np.cumsum(sizes), bad[0], side="right"))
        lines.fail(start + face, f"face: corner {corners[bad[0]]:g} is no vertex, the file has {vertices}")
    return sizes.astype(np.int32), corners.astype(np.int32)


def _colors(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | None:
    """Whole numbers up to 255, or fractions up to 1; None if the columns are neither."""
    if values.shape[1] not in (3, 4) or not len(values) or values.min() < 0 or values.max() > 255:
        return None
    if values.max() <= 1.0:
        return np.ascontiguousarray(values)
    return np.ascontiguousarray(values / 255.0)
