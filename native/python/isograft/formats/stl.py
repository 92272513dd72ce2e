# SPDX-License-Identifier: GPL-3.0-or-later
"""STL, binary and text. The format repeats a vertex in every triangle: equal positions become one vertex again."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.mesh import Polygons
from isograft.formats.text import Lines, parse_floats, parse_numbers, token_counts

_HEADER = 84
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: str, data: bytes) -> Polygons:
    """Vertices in the order of their first use; bit-equal positions are one vertex. Raises InvalidInput."""
    if re.match(rb"\s*solid\b", data) and b"facet" in data[:4096] and not _is_binary(data):
        positions = _read_text(path, data)
    else:
        positions = _read_binary(path, data)
    flat = positions.reshape(-1, 3) + 0.0  # -0 and 0 are the same place
    first, inverse = _equal_rows(flat)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return Polygons(
        vertices=np.ascontiguousarray(flat[first[order]]),
        sizes=np.full(len(positions), 3, np.int32),
        corners=rank[inverse].astype(np.int32),
    )


def _equal_rows(rows: npt.NDArray[np.float64]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """First row of every group of equal rows, and the group of every row."""
    first = np.zeros(min(len(rows), 1), np.int64)
    group = np.zeros(len(rows), np.int64)
    # A column at a time: sorting plain numbers is far faster than sorting rows.
    for column in rows.T:
        values, code = np.unique(column, return_inverse=True)
        _, first, group = np.unique(group * max(len(values), 1) + code, return_index=True, return_inverse=True)
    return first, group


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
    values = [lines.text[row].split(None, 1)[1:] for row in rows]
    numbers = [part[0] if part else b"" for part in values]
    counts = token_counts(numbers)
    wrong = np.flatnonzero(counts != 3)
    if wrong.size:
        lines.fail(rows[wrong[0]], f"vertex: {counts[wrong[0]]} numbers where 3 are needed")
    flat = parse_numbers(b"\n".join(numbers), np.float64, 3 * len(rows))
    if flat is None:
        flat = np.array(
            [parse_floats(lines, row, part.split(), "vertex") for row, part in zip(rows, numbers, strict=True)]
        )
    return flat.reshape(-1, 3, 3)
