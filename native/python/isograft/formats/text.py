# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of numbers, parsed many at a time; the slow way is gone only to find the line to blame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput


class Lines:
    """The lines of a text that hold something, comments cut off, each with its number in the file."""

    def __init__(self, path: str, data: bytes, first_number: int = 1, comment: bytes | None = b"#") -> None:
        self.path = path
        raw = data.splitlines()
        if comment is not None and comment in data:
            raw = [line.split(comment, 1)[0] for line in raw]
        self.numbers = [number for number, line in enumerate(raw, first_number) if line and not line.isspace()]
        self.text = [raw[number - first_number] for number in self.numbers]
        self.last_number = first_number + max(len(raw) - 1, 0)

    def __len__(self) -> int:
        return len(self.text)

    def fail(self, row: int, problem: str) -> NoReturn:
        """Blame one line; one past the end means that the file is truncated."""
        if row >= len(self.numbers):
            raise InvalidInput(f"{self.path}: line {self.last_number}: the file ends here, but {problem}")
        raise InvalidInput(f"{self.path}: line {self.numbers[row]}: {problem}")

    def need(self, start: int, count: int, what: str) -> None:
        """Raise InvalidInput unless `count` lines follow from row `start` on."""
        if start + count > len(self):
            self.fail(len(self), f"{what} should fill {count} lines and fill only {max(len(self) - start, 0)}")

    def table(self, start: int, count: int, what: str, minimum: int = 1) -> npt.NDArray[np.float64]:
        """Rows of numbers, as many columns as the first row has; longer rows are refused, and so are shorter ones."""
        self.need(start, count, what)
        rows = self.text[start : start + count]
        if count == 0:
            return np.empty((0, minimum))
        columns = len(rows[0].split())
        if columns < minimum:
            self.fail(start, f"{what}: {columns} numbers where {minimum} are needed")
        tokens = b" ".join(rows).split()
        if len(tokens) == count * columns:
            try:
                table = np.array(list(map(float, tokens))).reshape(count, columns)
            except ValueError:
                pass
            else:
                # Two rows of unequal length may add up; the sum over all rows alone does not show that.
                if columns == 1 or all(row.count(b" ") + row.count(b"\t") >= columns - 1 for row in rows):
                    return table
        for row, line in enumerate(rows, start):
            parts = line.split()
            if len(parts) != columns:
                self.fail(row, f"{what}: {len(parts)} numbers where {columns} are needed")
            parse_floats(self, row, parts, what)
        return np.array([[float(part) for part in line.split()] for line in rows])


def parse_floats(lines: Lines, row: int, parts: Sequence[bytes], what: str) -> list[float]:
    """The numbers of one line. Raises InvalidInput naming the line and the text that is no number."""
    values = []
    for part in parts:
        try:
            values.append(float(part))
        except ValueError:
            lines.fail(row, f"{what}: {quoted(part)} is not a number")
    return values


def parse_ints(lines: Lines, row: int, parts: Sequence[bytes], what: str) -> list[int]:
    """The whole numbers of one line. Raises InvalidInput naming the line and the text that is none."""
    values = []
    for part in parts:
        try:
            values.append(int(part))
        except ValueError:
            lines.fail(row, f"{what}: {quoted(part)} is not a whole number")
    return values


def quoted(part: bytes) -> str:
    """A piece of a file, fit for a message."""
    text = part[:40].decode("ascii", "backslashreplace")
    return f'"{text}{"..." if len(part) > 40 else ""}"'
