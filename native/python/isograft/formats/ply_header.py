# SPDX-License-Identifier: GPL-3.0-or-later
"""The header of a PLY file."""

from __future__ import annotations

from dataclasses import dataclass, field

from isograft.errors import InvalidInput
from isograft.formats.text import quoted

#: numpy's type for every name of one.
CODES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2", "ushort": "u2",
    "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4", "float": "f4", "float32": "f4",
    "double": "f8", "float64": "f8",
}  # fmt: skip
_ORDERS = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
#: A header that is longer than this is none.
_LONGEST = 1 << 20


@dataclass(frozen=True)
class Property:
    """`code` is numpy's type of the value, or of a list's items; `count_code` that of a list's length."""

    name: str
    code: str
    count_code: str | None = None


@dataclass
class Element:
    name: str
    count: int
    properties: list[Property] = field(default_factory=list)


@dataclass(frozen=True)
class Header:
    #: None for text, "<" or ">" for binary.
    byte_order: str | None
    elements: list[Element]
    #: Offset of the first byte behind the header, and number of the header's lines.
    end: int
    lines: int


def read_header(path: str, data: bytes) -> Header:  # noqa: PLR0912  (one branch a keyword)
    """Raises InvalidInput naming the line."""
    elements: list[Element] = []
    order: str | None = None
    has_format = False
    position = number = 0
    while position < min(len(data), _LONGEST):
        line, position = _next_line(data, position)
        number += 1
        where = f"{path}: line {number}"
        words = line.decode("utf-8", "replace").split()
        if number == 1:
            if words != ["ply"]:
                raise InvalidInput(f'{where}: the first line must be "ply", not {quoted(line)}')
        elif not words or words[0] in ("comment", "obj_info"):
            continue
        elif words[0] == "format":
            if len(words) < 2 or words[1] not in _ORDERS:
                raise InvalidInput(f"{where}: {quoted(line)} is none of the formats {', '.join(_ORDERS)}")
            order, has_format = _ORDERS[words[1]], True
        elif words[0] == "element":
            if len(words) != 3 or not words[2].isdecimal():
                raise InvalidInput(f"{where}: {quoted(line)} is no element with a name and a number")
            elements.append(Element(words[1], int(words[2])))
        elif words[0] == "property":
            if not elements:
                raise InvalidInput(f"{where}: a property stands before the first element")
            elements[-1].properties.append(_property(words, line, where))
        elif words[0] == "end_header":
            if not has_format:
                raise InvalidInput(f"{where}: the header names no format")
            return Header(order, elements, position, number)
        else:
            raise InvalidInput(f"{where}: {quoted(line)} is no line of a PLY header")
    raise InvalidInput(f"{path}: line {max(number, 1)}: the file ends before end_header")


def texture_files(data: bytes) -> list[str]:
    """The images that comments of the header name, in MeshLab's manner."""
    lines = data[:_LONGEST].partition(b"end_header")[0].decode("utf-8", "replace").splitlines()
    parts = [line.split(None, 2) for line in lines]
    return [part[2].strip() for part in parts if len(part) == 3 and part[:2] == ["comment", "TextureFile"]]


def _next_line(data: bytes, start: int) -> tuple[bytes, int]:
    """One line and the offset of the next: line feeds, carriage returns, or both end it."""
    feed = data.find(b"\n", start)
    carriage = data.find(b"\r", start, feed if feed >= 0 else len(data))
    if carriage < 0:
        return (data[start:], len(data)) if feed < 0 else (data[start:feed], feed + 1)
    return data[start:carriage], carriage + (2 if data[carriage + 1 : carriage + 2] == b"\n" else 1)


def _property(words: list[str], line: bytes, where: str) -> Property:
    if len(words) == 5 and words[1] == "list" and words[2] in CODES and words[3] in CODES:
        if CODES[words[2]].startswith("f"):
            raise InvalidInput(f"{where}: the length of a list must be a whole number, not {words[2]}")
        return Property(words[4], CODES[words[3]], CODES[words[2]])
    if len(words) == 3 and words[1] in CODES:
        return Property(words[2], CODES[words[1]])
    raise InvalidInput(f"{where}: {quoted(line)} is no property with a known type")
