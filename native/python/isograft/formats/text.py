# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of numbers, parsed many at a time; the slow way is gone only to find the line to blame."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, NoReturn

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
        if any(not line or line.isspace() for line in raw):
            self.numbers = [number for number, line in enumerate(raw, first_number) if line and not line.isspace()]
            self.text = [raw[number - first_number] for number in self.numbers]
        else:
            self.numbers = list(range(first_number, first_number + len(raw)))
            self.text = raw
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
        if count == 0:
            return np.empty((0, minimum))
        values, counts = self.ragged(start, count, what)
        columns = int(counts[0])
        if columns < minimum:
            self.fail(start, f"{what}: {columns} numbers where {minimum} are needed")
        unequal = np.flatnonzero(counts != columns)
        if unequal.size:
            row = int(unequal[0])
            self.fail(start + row, f"{what}: {counts[row]} numbers where {columns} are needed")
        return values.reshape(count, columns)

    def ragged(self, start: int, count: int, what: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
        """All numbers of some rows, one row after another, and how many each row has."""
        self.need(start, count, what)
        rows = self.text[start : start + count]
        counts = token_counts(rows)
        values = parse_numbers(b"\n".join(rows), np.float64, int(counts.sum()))
        if values is None:
            for row, line in enumerate(rows, start):
                parse_floats(self, row, line.split(), what)
            # Python reads a few spellings that numpy does not.
            values = np.array([float(part) for line in rows for part in line.split()])
        return values, counts


def parse_numbers(text: bytes, dtype: type[np.generic], count: int) -> npt.NDArray[Any] | None:
    """Exactly `count` numbers between white space, or None if the text is anything else."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            values: npt.NDArray[Any] = np.fromstring(text, dtype, sep=" ")
        except (ValueError, DeprecationWarning):
            return None
    return values if len(values) == count else None


def token_counts(rows: Sequence[bytes]) -> npt.NDArray[np.int64]:
    """How many pieces between white space every row has; no row may hold a line feed."""
    if not rows:
        return np.empty(0, np.int64)
    text = np.frombuffer(b"\n".join(rows) + b"\n", np.uint8)
    space = (text == 32) | ((text >= 9) & (text <= 13))
    starts = ~space
    starts[1:] &= space[:-1]
    total: npt.NDArray[np.int64] = np.cumsum(starts)[text == 10]
    counts: npt.NDArray[np.int64] = np.diff(total, prepend=0)
    return counts


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


def whole(values: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """True where a number is whole and fits 32 bits."""
    fits: npt.NDArray[np.bool_] = (values == np.floor(values)) & (np.abs(values) < 2.0**31)
    return fits
