# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront OBJ: v (with colours), vt, vn, f with negative indices and any number of corners, usemtl as the layer
material of faces. All else is passed over."""

from __future__ import annotations

from itertools import chain

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.layers import MATERIAL, Layers
from isograft.formats.mesh import Polygons
from isograft.formats.text import Lines, parse_floats, parse_ints, parse_numbers, quoted, token_counts

Ints64 = npt.NDArray[np.int64]


def read_obj(path: str, data: bytes) -> Polygons:
    """Raises InvalidInput naming the line."""
    lines = Lines(path, data)
    if b"\\" in data:
        _join(lines)
    rows = _rows_by_keyword(lines.text)
    if not rows[b"v"]:
        raise InvalidInput(f"{path}: line {lines.last_number}: the file ends here and holds no vertices")
    vertices = _numbers(lines, rows, b"v", "vertex", 3)
    uvs = _numbers(lines, rows, b"vt", "texture coordinate", 1)
    if uvs.shape[1] == 1:
        uvs = np.hstack([uvs, np.zeros_like(uvs)])
    normals = _numbers(lines, rows, b"vn", "normal", 3)
    sizes, corners, uv_index, normal_index = _faces(lines, rows)
    layers = _materials(lines, rows)
    if (normal_index >= 0).any():
        layers.normals = np.vstack([normals[:, :3], np.zeros((1, 3))])[normal_index]
    return Polygons(
        vertices=np.ascontiguousarray(vertices[:, :3]),
        sizes=sizes,
        corners=corners,
        # x y z w has one more number, x y z r g b three.
        colors=np.ascontiguousarray(vertices[:, 3:6]) if vertices.shape[1] >= 6 else None,
        uvs=np.ascontiguousarray(uvs[:, :2]) if (uv_index >= 0).any() else None,
        uv_index=uv_index if (uv_index >= 0).any() else None,
        layers=layers,
    )


def _materials(lines: Lines, rows: dict[bytes, list[int]]) -> Layers:
    used = rows[b"usemtl"]
    if not used or not rows[b"f"]:
        return Layers()
    names = [name.strip().decode("utf-8", "replace") for name in _behind_keyword(lines, used, b"usemtl")]
    return Layers(face={MATERIAL: np.array(["", *names])[np.searchsorted(used, rows[b"f"])]})


def _rows_by_keyword(text: list[bytes]) -> dict[bytes, list[int]]:
    rows: dict[bytes, list[int]] = {b"v": [], b"vt": [], b"vn": [], b"f": [], b"usemtl": []}
    # Nearly every line begins so; the few others are looked at in full.
    known = {b"v ": rows[b"v"], b"vt": rows[b"vt"], b"f ": rows[b"f"], b"vn": rows[b"vn"]}
    for row, line in enumerate(text):
        head = line[:2]
        if head not in known:
            keyword = line.split(None, 1)[0]
            if keyword in rows:
                rows[keyword].append(row)
        else:
            known[head].append(row)
    return rows


def _join(lines: Lines) -> None:
    """A line that ends with a backslash goes on in the next one; both keep the first one's number."""
    row = 0
    while row < len(lines.text):
        if lines.text[row].endswith(b"\\") and row + 1 < len(lines.text):
            lines.text[row] = lines.text[row][:-1] + b" " + lines.text.pop(row + 1)
            lines.numbers.pop(row + 1)
        else:
            row += 1


def _numbers(
    lines: Lines, rows_by_keyword: dict[bytes, list[int]], keyword: bytes, what: str, minimum: int
) -> npt.NDArray[np.float64]:
    """The numbers behind the keyword; the fewest of any row decide how many are kept."""
    rows = rows_by_keyword[keyword]
    if not rows:
        return np.empty((0, minimum))
    numbers = _behind_keyword(lines, rows, keyword)
    counts = token_counts(numbers)
    columns = int(counts.min())
    if columns < minimum:
        lines.fail(rows[int(counts.argmin())], f"{what}: {columns} numbers where {minimum} are needed")
    flat = parse_numbers(b"\n".join(numbers), np.float64, int(counts.sum()))
    if flat is None:
        parts = [parse_floats(lines, row, part.split(), what) for row, part in zip(rows, numbers, strict=True)]
        flat = np.array(list(chain.from_iterable(parts)))
    kept: npt.NDArray[np.float64] = flat[(np.cumsum(counts) - counts)[:, None] + np.arange(columns)]
    return kept


def _behind_keyword(lines: Lines, rows: list[int], keyword: bytes) -> list[bytes]:
    length = len(keyword)
    return [lines.text[row].lstrip()[length:] for row in rows]


def _faces(lines: Lines, rows: dict[bytes, list[int]]) -> tuple[npt.NDArray[np.int32], ...]:
    texts = _behind_keyword(lines, rows[b"f"], b"f")
    sizes = token_counts(texts)
    owner = np.repeat(np.asarray(rows[b"f"], np.int64), sizes)
    parsed = _alike_corners(b"\n".join(texts), int(sizes.sum()))
    corners, uv_index, normal_index = _unlike_corners(lines, rows[b"f"], texts) if parsed is None else parsed
    if not rows[b"vn"]:
        # Some programs number normals that they do not write.
        normal_index = np.zeros_like(normal_index)
    found = []
    for index, keyword, what in (
        (corners, b"v", "vertices"),
        (uv_index, b"vt", "texture coordinates"),
        (normal_index, b"vn", "normals"),
    ):
        given = index != 0 if keyword != b"v" else np.ones(len(index), bool)
        # Negative indices count back from the newest row at that place in the file.
        row = np.where(index < 0, np.searchsorted(rows[keyword], owner) + index, index - 1)
        _check(lines, texts, sizes, owner, given & ((row < 0) | (row >= len(rows[keyword]))), len(rows[keyword]), what)
        found.append(np.where(given, row, -1).astype(np.int32))
    return sizes.astype(np.int32), *found


def _alike_corners(text: bytes, count: int) -> tuple[Ints64, Ints64, Ints64] | None:
    """Vertex, texture and normal index (0 for none) of all corners if all are written in one way, None if not."""
    none = np.zeros(count, np.int64)
    slashes = text.count(b"/")
    if slashes == 0:
        corners = parse_numbers(text, np.int64, count)
        return None if corners is None else (corners, none, none)
    if slashes not in (count, 2 * count):
        return None
    double = text.count(b"//")
    if double not in (0, count) or (double and slashes == count):
        return None
    # Evenly many slashes are not yet one in every corner: a/b/c beside a would go unseen.
    if not _evenly_slashed(text, slashes // count):
        return None
    columns = 3 if slashes == 2 * count and not double else 2
    table = parse_numbers(text.replace(b"//", b" ").replace(b"/", b" "), np.int64, columns * count)
    if table is None:
        return None
    first, second, *last = table.reshape(count, columns).T
    return (first, none, second) if double else (first, second, last[0] if last else none)


def _evenly_slashed(text: bytes, each: int) -> bool:
    """True if every piece between white space has `each` slashes."""
    letters = np.frombuffer(text, np.uint8)
    places = np.flatnonzero(letters == ord("/"))
    space = (letters == 32) | ((letters >= 9) & (letters <= 13))
    pieces = np.cumsum(space)[places].reshape(-1, each)
    return bool((pieces == pieces[:, :1]).all() and (pieces[1:, 0] != pieces[:-1, 0]).all())


def _unlike_corners(lines: Lines, rows: list[int], texts: list[bytes]) -> tuple[Ints64, Ints64, Ints64]:
    """The same for corners written in several ways, or wrongly."""
    found: list[list[int]] = []
    for row, text in zip(rows, texts, strict=True):
        for token in text.split():
            vertex, *others = [*token.split(b"/"), b"", b""][:3]
            indices = parse_ints(lines, row, [vertex, *(other or b"0" for other in others)], "face")
            if max(map(abs, indices)) >= 2**31:
                lines.fail(row, f"face: {quoted(token)} is beyond 32 bits")
            found.append(indices)
    corners, uvs, normals = np.array(found, np.int64).reshape(-1, 3).T
    return corners, uvs, normals


def _check(
    lines: Lines, texts: list[bytes], sizes: Ints64, owner: Ints64, bad: npt.NDArray[np.bool_], count: int, what: str
) -> None:
    """Fail at the first corner that is `bad`: there are `count` rows of `what`."""
    if bad.any():
        first = int(bad.argmax())
        face = int(np.searchsorted(np.cumsum(sizes), first, side="right"))
        token = texts[face].split()[first - int(sizes[:face].sum())]
        problem = f"face: corner {quoted(token)} is out of range, the file has {count} {what}"
        lines.fail(int(owner[first]), problem)
