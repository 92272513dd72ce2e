# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: v (with colours), vt, f with negative indices and any number of corners. All else is passed over."""

from __future__ import annotations

from itertools import chain
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from isograft.formats.mesh import Polygons
from isograft.formats.text import Lines, parse_floats, parse_ints, quoted

Ints64 = npt.NDArray[np.int64]


def read_obj(path: str, data: bytes) -> Polygons:
    """Raises InvalidInput naming the line."""
    lines = _joined(Lines(path, data))
    rows: dict[bytes, list[int]] = {b"v": [], b"vt": [], b"f": []}
    for row, line in enumerate(lines.text):
        keyword = line.split(None, 1)[0]
        if keyword in rows:
            rows[keyword].append(row)
    vertices = _numbers(lines, rows[b"v"], "vertex", 3)
    uvs = _numbers(lines, rows[b"vt"], "texture coordinate", 1)
    if uvs.shape[1] == 1:
        uvs = np.hstack([uvs, np.zeros_like(uvs)])
    sizes, corners, uv_index = _faces(lines, rows)
    return Polygons(
        vertices=np.ascontiguousarray(vertices[:, :3]),
        sizes=sizes,
        corners=corners,
        # x y z w has one more number, x y z r g b three.
        colors=np.ascontiguousarray(vertices[:, 3:6]) if vertices.shape[1] >= 6 else None,
        uvs=np.ascontiguousarray(uvs[:, :2]) if (uv_index >= 0).any() else None,
        uv_index=uv_index if (uv_index >= 0).any() else None,
    )


def _joined(lines: Lines) -> Lines:
    """A line that ends with a backslash goes on in the next one; both keep the first one's number."""
    row = 0
    while row < len(lines.text):
        if lines.text[row].endswith(b"\\") and row + 1 < len(lines.text):
            lines.text[row] = lines.text[row][:-1] + b" " + lines.text.pop(row + 1)
            lines.numbers.pop(row + 1)
        else:
            row += 1
    return lines


def _numbers(lines: Lines, rows: list[int], what: str, minimum: int) -> npt.NDArray[np.float64]:
    """The numbers behind the keyword; the fewest of any row decide how many are kept."""
    if not rows:
        return np.empty((0, minimum))
    parts = [lines.text[row].split()[1:] for row in rows]
    columns = min(map(len, parts))
    if columns < minimum:
        short = next(i for i, part in enumerate(parts) if len(part) == columns)
        lines.fail(rows[short], f"{what}: {columns} numbers where {minimum} are needed")
    try:
        flat = [float(token) for part in parts for token in part[:columns]]
    except ValueError:
        for row, part in zip(rows, parts, strict=True):
            parse_floats(lines, row, part[:columns], what)
        raise
    return np.array(flat).reshape(len(rows), columns)


def _faces(lines: Lines, rows: dict[bytes, list[int]]) -> tuple[npt.NDArray[np.int32], ...]:
    parts = [lines.text[row].split()[1:] for row in rows[b"f"]]
    sizes = np.fromiter(map(len, parts), np.int64, len(parts))
    tokens = list(chain.from_iterable(parts))
    owner = np.repeat(np.asarray(rows[b"f"], np.int64), sizes)
    try:
        if any(b"/" in token for token in tokens):
            corners = np.array([int(token.partition(b"/")[0]) for token in tokens], np.int64)
            uv_index = np.array([int(_second(token) or 0) for token in tokens], np.int64)
        else:
            corners = np.array(list(map(int, tokens)), np.int64)
            uv_index = np.zeros(len(tokens), np.int64)
    except (ValueError, OverflowError):
        _blame(lines, rows[b"f"], parts)
    # Negative indices count back from the newest vertex at that place in the file.
    before = np.searchsorted(rows[b"v"], owner)
    uv_before = np.searchsorted(rows[b"vt"], owner)
    corners = np.where(corners < 0, before + corners, corners - 1)
    given = uv_index != 0
    uv_index = np.where(uv_index < 0, uv_before + uv_index, uv_index - 1)
    _check(lines, owner, tokens, corners, len(rows[b"v"]), "vertices")
    _check(
        lines,
        owner[given],
        [t for t, g in zip(tokens, given, strict=True) if g] if given.any() else [],
        uv_index[given],
        len(rows[b"vt"]),
        "texture coordinates",
    )
    return sizes.astype(np.int32), corners.astype(np.int32), np.where(given, uv_index, -1).astype(np.int32)


def _second(token: bytes) -> bytes:
    return token.split(b"/", 2)[1] if b"/" in token else b""


def _blame(lines: Lines, rows: list[int], parts: list[list[bytes]]) -> NoReturn:
    for row, tokens in zip(rows, parts, strict=True):
        for token in tokens:
            pieces = token.split(b"/")
            for index in parse_ints(lines, row, [pieces[0], *(p for p in pieces[1:2] if p)], "face"):
                if abs(index) >= 2**31:
                    lines.fail(row, f"face: {quoted(token)} is beyond 32 bits")
    raise AssertionError("a face was refused, but none of its parts")


def _check(lines: Lines, owner: Ints64, tokens: list[bytes], index: Ints64, count: int, what: str) -> None:
    bad = np.flatnonzero((index < 0) | (index >= count))
    if bad.size:
        token = quoted(tokens[bad[0]])
        lines.fail(int(owner[bad[0]]), f"face: corner {token} is out of range, the file has {count} {what}")
