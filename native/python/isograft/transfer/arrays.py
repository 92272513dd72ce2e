# SPDX-License-Identifier: GPL-3.0-or-later
"""What the transfers share: the types they take and give, and the checks of what a caller passes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from isograft import _native

Mode = Literal["auto", "barycentric", "nearest"]
Array = npt.NDArray[Any]
Progress = Callable[[str, float], Any]


class CorrespondenceArrays(Protocol):
    """What is read of a Correspondence: any object with these arrays will do."""

    @property
    def face(self) -> Any:
        """(n,) index into the donor's triangles, -1 = unmatched."""

    @property
    def barycentric(self) -> Any:
        """(n, 3) weights of that triangle's corners."""

    @property
    def vertex(self) -> Any:
        """(n,) nearest donor vertex or -1."""


class TransferredValues(NamedTuple):
    """Values moved along a correspondence."""

    values: Array
    """One row per receiver vertex (transfer_point) or corner (transfer_corner), of the donor values' dtype. Where
    unmatched: NaN in floats per vertex, else 0, False or an empty string."""
    mask: npt.NDArray[np.bool_]
    """True where matched: one entry per receiver vertex (transfer_point) or triangle (transfer_corner)."""


def correspondence_arrays(correspondence: CorrespondenceArrays) -> tuple[Array, Array, Array]:
    """face, barycentric and vertex as the compiled part takes them."""
    face = np.ascontiguousarray(correspondence.face, dtype=np.int32)
    barycentric = np.ascontiguousarray(correspondence.barycentric, dtype=np.float64)
    vertex = np.ascontiguousarray(correspondence.vertex, dtype=np.int32)
    if face.ndim != 1 or vertex.shape != face.shape or barycentric.shape != (len(face), 3):
        raise _native.InvalidInput(
            "correspondence: expected face (n,), barycentric (n, 3) and vertex (n,), "
            f"got {face.shape}, {barycentric.shape} and {vertex.shape}"
        )
    return face, barycentric, vertex


def point_rows(points: Any, name: str) -> Array:
    array = np.ascontiguousarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 3:
        raise _native.InvalidInput(f"{name}: expected shape (n, 3), got {array.shape}")
    return array


def triangle_rows(faces: Any, name: str) -> Array:
    if faces is None:
        return np.zeros((0, 3), dtype=np.int32)
    array = np.asarray(faces)
    if array.ndim != 2 or array.shape[1] != 3 or (array.size and array.dtype.kind not in "iu"):
        raise _native.InvalidInput(f"{name}: expected integers of shape (n, 3), got {array.dtype} {array.shape}")
    if array.size and (array.max() > np.iinfo(np.int32).max or array.min() < np.iinfo(np.int32).min):
        raise _native.InvalidInput(f"{name}: indices do not fit 32 bits")
    return np.ascontiguousarray(array, dtype=np.int32)


def polygon_ids(polygons: Any, name: str = "receiver_polygons") -> Array:
    array = np.zeros(0, dtype=np.int32) if polygons is None else np.asarray(polygons)
    if array.ndim != 1 or array.dtype.kind not in "iu":
        raise _native.InvalidInput(f"{name}: expected integers of shape (n,), got {array.dtype} {array.shape}")
    return np.ascontiguousarray(array, dtype=np.int32)


def corner_rows(values: Any, count: int, name: str) -> Array:
    """Corner values as 3 `count` rows, whatever of the two layouts they came in."""
    array = np.asarray(values)
    if array.ndim >= 1 and len(array) == 3 * count:
        return array
    if array.ndim >= 2 and array.shape[:2] == (count, 3):
        return array.reshape(3 * count, *array.shape[2:])
    raise _native.InvalidInput(
        f"{name}: expected {3 * count} rows, one per corner of {count} triangles, got shape {array.shape}"
    )


def value_columns(data: Array) -> Array:
    return np.ascontiguousarray(data.reshape(len(data), int(np.prod(data.shape[1:]))), dtype=np.float64)


def row_codes(data: Array) -> Array:
    """Numbers that are equal exactly where whole rows are: compared instead of integers, booleans and strings."""
    codes = np.zeros(len(data), dtype=np.int64)
    for column in data.reshape(len(data), int(np.prod(data.shape[1:]))).T:
        values, code = np.unique(column, return_inverse=True)
        _, codes = np.unique(codes * len(values) + code, return_inverse=True)
    return codes.astype(np.float64).reshape(-1, 1)


def is_nearest(data: Array, mode: str) -> bool:
    if mode not in ("auto", "barycentric", "nearest"):
        raise _native.InvalidInput(f"mode: expected auto, barycentric or nearest, got {mode!r}")
    if mode == "barycentric" and data.dtype.kind not in "fiu":
        raise _native.InvalidInput(f"mode: values of type {data.dtype} have no mean, use nearest")
    return mode == "nearest" or (mode == "auto" and data.dtype.kind != "f")


def pick_rows(data: Array, rows: Array, mask: Array, missing: float | None = None) -> Array:
    picked = np.zeros((len(mask), *data.shape[1:]), dtype=data.dtype)
    if missing is not None:
        picked[~mask] = missing
    picked[mask] = data[rows[mask].astype(np.intp)]
    return picked


def as_type(moved: Array, data: Array, count: int) -> Array:
    if data.dtype.kind in "iu":
        limits = np.iinfo(data.dtype)
        moved = np.clip(np.rint(moved), limits.min, limits.max)
    return moved.astype(data.dtype).reshape(count, *data.shape[1:])


def check_indices(indices: Array, count: int, name: str) -> None:
    bad = (indices < 0) | (indices >= count)
    if bad.any():
        row = int(bad.any(axis=1).argmax())
        raise _native.InvalidInput(f"{name} row {row} is {indices[row].tolist()}: there are {count} vertices")
