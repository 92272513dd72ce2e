# SPDX-License-Identifier: GPL-3.0-or-later
"""STL, binary and text. The format repeats a vertex in every triangle: equal positions become one vertex again."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.mesh import Polygons
from isograft.formats.text import Lines, parse_floats

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: str, data: bytes) -> Polygons:
    """Vertices in the order of their first use; bit-equal positions are one vertex. Raises InvalidInput."""
    if re.match(rb"\s*solid\b", data) and b"facet" in data[:4096] and not _is_binary(data):
        positions = _read_text(path, data)
    else:
        positions = _read_binary(path, data)
    flat = positions.reshape(-1, 3) + 0.0  # -0 and 0 are the same place
    _, first, inverse = np.unique(flat, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return Polygons(
        vertices=np.ascontiguousarray(flat[first[order]]),
        sizes=np.full(len(positions), 3, np.int32),
        corners=rank[inverse.ravel()].astype(np.int32),
    )


def _is_binary(data: bytes) -> bool:
    return len(data) >= _HEADER and len(data) == _HEADER + _RECORD.itemsize * int.from_bytes(data[80:84], "little")


def _read_binary(path: str, data: bytes) -> npt.NDArray[np.float64]:
    if len(data) < _HEADER:
        raise InvalidInput(f"{path}: byte {len(data)}: the file ends inside the header of 84 bytes")
    count = int.from_bytes(data[80:84], "little")
    whole = (len(data) - _HEADER) // _RECORD.itemsize
    if whole < count:
        raise InvalidInput(
            f"{path}: byte {len(data)}: the file ends in triangle {whole}, its header says {count} triangles"
        )
    records = np.frombuffer(data, _RECORD, count, _HEADER)
    return records["corners"].astype(np.float64)


def _read_text(path: str, data: bytes) -> npt.NDArray[np.float64]:
    lines = Lines(path, data, comment=None)
    rows = [row for row, line in enumerate(lines.text) if line.split(None, 1)[0].lower() == b"vertex"]
    if not any(line.split(None, 1)[0].lower() == b"endsolid" for line in lines.text[-1:]):
        lines.fail(len(lines), "endsolid is missing")
    if len(rows) % 3:
        lines.fail(rows[-1], f"{len(rows)} vertex lines are not three for every facet")
    parts = [lines.text[row].split()[1:] for row in rows]
    for row, part in zip(rows, parts, strict=True):
        if len(part) != 3:
            lines.fail(row, f"vertex: {len(part)} numbers where 3 are needed")
    try:
        flat = [float(token) for part in parts for token in part]
    except ValueError:
        for row, part in zip(rows, parts, strict=True):
            parse_floats(lines, row, part, "vertex")
        raise
    return np.array(flat).reshape(-1, 3, 3)
