# SPDX-License-Identifier: GPL-3.0-or-later
"""The rows of a PLY file's elements as columns: one array operation an element wherever the rows are alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.ply_header import Element, Property
from isograft.formats.text import Lines, whole


@dataclass(frozen=True, eq=False)
class ListColumn:
    """`sizes` (rows,) and the items of all rows, one after another. `places`: line or byte of every row, or None."""

    sizes: npt.NDArray[np.int64]
    items: npt.NDArray[Any]
    places: npt.NDArray[np.int64] | None


Column = npt.NDArray[Any] | ListColumn


class BinaryBody:
    """Reads the elements in the order of the file."""

    def __init__(self, path: str, data: bytes, start: int, byte_order: str) -> None:
        self._path = path
        self._data = data
        self._position = start
        self._order = byte_order

    def place(self, column: ListColumn, row: int) -> str:
        return f"byte {column.places[row]}" if column.places is not None else f"row {row}"

    def read(self, element: Element) -> dict[str, Column]:
        least = sum(np.dtype(p.count_code or p.code).itemsize for p in element.properties)
        if element.count and not least:
            raise InvalidInput(f"{self._path}: the element {element.name} has no properties")
        self._need(element, least * element.count)
        if not any(p.count_code for p in element.properties):
            return self._plain(element)
        columns = self._alike(element)
        return self._unlike(element) if columns is None else columns

    def _need(self, element: Element, size: int) -> None:
        if self._position + size > len(self._data):
            raise InvalidInput(
                f"{self._path}: byte {len(self._data)}: the file ends inside the element {element.name}, "
                f"which starts at byte {self._position} and has {element.count} rows"
            )

    def _plain(self, element: Element) -> dict[str, Column]:
        row = np.dtype([(f"p{i}", self._order + p.code) for i, p in enumerate(element.properties)])
        table = np.frombuffer(self._data, row, element.count, self._position)
        self._position += row.itemsize * element.count
        return {p.name: table[f"p{i}"] for i, p in enumerate(element.properties)}

    def _alike(self, element: Element) -> dict[str, Column] | None:
        """All rows at once if every list is as long as the first row's; None if not."""
        if element.count == 0:
            return {p.name: _empty(p) for p in element.properties}
        fields: list[Any] = []
        position = self._position
        lengths = []
        for i, p in enumerate(element.properties):
            length = None
            if p.count_code:
                length = self._length(element, p, position, 0)
                fields.append((f"n{i}", self._order + p.count_code))
                position += np.dtype(p.count_code).itemsize
                fields.append((f"p{i}", self._order + p.code, (length,)))
            else:
                fields.append((f"p{i}", self._order + p.code))
            lengths.append(length)
            position += np.dtype(p.code).itemsize * (1 if length is None else length)
        row = np.dtype(fields)
        if self._position + row.itemsize * element.count > len(self._data):
            return None
        table = np.frombuffer(self._data, row, element.count, self._position)
        if any(length is not None and (table[f"n{i}"] != length).any() for i, length in enumerate(lengths)):
            return None
        places = self._position + row.itemsize * np.arange(element.count)
        self._position += row.itemsize * element.count
        columns: dict[str, Column] = {}
        for i, (p, length) in enumerate(zip(element.properties, lengths, strict=True)):
            if length is None:
                columns[p.name] = table[f"p{i}"]
            else:
                sizes = np.full(element.count, length, np.int64)
                columns[p.name] = ListColumn(sizes, table[f"p{i}"].ravel(), places)
        return columns

    def _unlike(self, element: Element) -> dict[str, Column]:
        """One pass finds where each row's lists begin; their items are then gathered at once."""
        data, order = self._data, "little" if self._order == "<" else "big"
        places = np.empty(element.count, np.int64)
        starts = np.empty((len(element.properties), element.count), np.int64)
        sizes = np.ones((len(element.properties), element.count), np.int64)
        layout = [
            (i, np.dtype(p.count_code).itemsize if p.count_code else 0, np.dtype(p.code).itemsize)
            for i, p in enumerate(element.properties)
        ]
        position = self._position
        for row in range(element.count):
            places[row] = position
            for i, count_size, item_size in layout:
                length = 1
                if count_size == 1 and position < len(data):
                    length = data[position]
                elif count_size:
                    length = int.from_bytes(data[position : position + count_size], order)  # type: ignore[arg-type]
                position += count_size
                starts[i, row] = position
                sizes[i, row] = length
                position += length * item_size
            if position > len(data):
                raise InvalidInput(
                    f"{self._path}: byte {places[row]}: row {row} of {element.count} of the element {element.name} "
                    f"ends at byte {position}, the file at {len(data)}"
                )
        self._position = position
        columns: dict[str, Column] = {}
        for i, p in enumerate(element.properties):
            items = self._gather(starts[i], sizes[i], p)
            columns[p.name] = ListColumn(sizes[i], items, places) if p.count_code else items
        return columns

    def _length(self, element: Element, p: Property, position: int, row: int) -> int:
        size = np.dtype(p.count_code).itemsize
        length = int.from_bytes(self._data[position : position + size], "little" if self._order == "<" else "big")
        if position + size + length * np.dtype(p.code).itemsize > len(self._data):
            raise InvalidInput(
                f"{self._path}: byte {position}: the list {p.name} of row {row} of the element {element.name} has "
                f"{length} items, more than the file holds"
            )
        return length

    def _gather(self, starts: npt.NDArray[np.int64], sizes: npt.NDArray[np.int64], p: Property) -> npt.NDArray[Any]:
        dtype = np.dtype(self._order + p.code)
        offsets = np.repeat(starts, sizes) + steps(sizes) * dtype.itemsize
        raw = np.frombuffer(self._data, np.uint8)[offsets[:, None] + np.arange(dtype.itemsize)]
        return np.ascontiguousarray(raw).view(dtype).ravel()


class TextBody:
    """Reads the elements in the order of the file, a line a row."""

    def __init__(self, path: str, data: bytes, header_lines: int) -> None:
        self._lines = Lines(path, data, header_lines + 1, comment=None)
        self._row = 0

    def place(self, column: ListColumn, row: int) -> str:
        return f"line {column.places[row]}" if column.places is not None else f"row {row}"

    def read(self, element: Element) -> dict[str, Column]:
        start, count = self._row, element.count
        self._lines.need(start, count, f"the element {element.name}")
        self._row += count
        if count == 0:
            return {p.name: _empty(p) for p in element.properties}
        places = np.asarray(self._lines.numbers[start : start + count], np.int64)
        if not any(p.count_code for p in element.properties):
            table = self._lines.table(start, count, element.name, len(element.properties))
            return {p.name: table[:, i] for i, p in enumerate(element.properties)}
        values, counts = self._lines.ragged(start, count, element.name)
        ends = np.cumsum(counts)
        at = ends - counts
        columns: dict[str, Column] = {}
        for p in element.properties:
            sizes = np.ones(count, np.int64)
            if p.count_code:
                sizes = self._list_lengths(values, at, ends, p, start)
                at = at + 1
            short = np.flatnonzero(at + sizes > ends)
            if short.size:
                row = int(short[0])
                self._lines.fail(start + row, f"{element.name}: {counts[row]} numbers, too few for {p.name}")
            items = values[np.repeat(at, sizes) + steps(sizes)]
            columns[p.name] = ListColumn(sizes, items, places) if p.count_code else items
            at = at + sizes
        return columns

    def _list_lengths(
        self, values: npt.NDArray[np.float64], at: npt.NDArray[np.int64], ends: npt.NDArray[np.int64], p: Property,
        start: int,
    ) -> npt.NDArray[np.int64]:  # fmt: skip
        present = at < ends
        lengths = np.where(present, values[np.minimum(at, len(values) - 1)], -1.0)
        bad = np.flatnonzero(~(whole(lengths) & (lengths >= 0)))
        if bad.size:
            self._lines.fail(start + int(bad[0]), f"the list {p.name} has no valid length")
        return lengths.astype(np.int64)


def steps(sizes: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """0, 1, ... sizes[0] - 1, 0, 1, ... sizes[1] - 1, and so on."""
    return np.arange(int(sizes.sum())) - np.repeat(np.cumsum(sizes) - sizes, sizes)


def _empty(p: Property) -> Column:
    items = np.empty(0, np.dtype(p.code))
    return ListColumn(np.empty(0, np.int64), items, None) if p.count_code else items
