# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of what a caller passes: each returns the checked value or raises InvalidInput with what and where."""

from __future__ import annotations

import math
import operator
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput

_INT32 = np.iinfo(np.int32)


def to_array(values: npt.ArrayLike, name: str) -> npt.NDArray[Any]:
    """`values` as an array of any real dtype. Raises InvalidInput for ragged lists, text, objects and complex."""
    try:
        array = np.asarray(values)
    except (ValueError, TypeError) as error:
        raise InvalidInput(f"{name} is not an array: {error}") from None
    if array.dtype.kind not in "fiu":
        raise InvalidInput(f"{name} must hold real numbers, not {array.dtype}")
    return array


def to_points(values: npt.ArrayLike, name: str) -> npt.NDArray[np.float64]:
    """(n, 3) float64, contiguous."""
    array = to_array(values, name)
    if array.ndim != 2 or array.shape[1] != 3:
        raise InvalidInput(f"{name} must have shape (n, 3), not {array.shape}")
    return np.ascontiguousarray(array, dtype=np.float64)


def to_indices(values: npt.ArrayLike, name: str, columns: int) -> npt.NDArray[np.int32]:
    """(k, columns) int32, contiguous. Raises InvalidInput for floats and for numbers beyond 32 bits."""
    array = to_array(values, name)
    if array.ndim != 2 or array.shape[1] != columns:
        hint = ""
        if columns == 3 and array.ndim == 2 and array.shape[1] == 4:
            hint = "; triangulate quads first (isograft.files.read_mesh does)"
        raise InvalidInput(f"{name} must have shape (k, {columns}), not {array.shape}{hint}")
    if array.dtype.kind not in "iu":
        raise InvalidInput(f"{name} must hold integers, not {array.dtype}")
    outside = (array < _INT32.min) | (array > _INT32.max)
    if outside.any():
        row = int(np.flatnonzero(outside.any(axis=1))[0])
        raise InvalidInput(f"{name} row {row} is {array[row].tolist()}: indices are 32-bit")
    return np.ascontiguousarray(array, dtype=np.int32)


def to_int(value: Any, name: str, low: int, high: int) -> int:
    """An integer in [low, high]."""
    try:
        if isinstance(value, (bool, np.bool_)):
            raise TypeError
        number = operator.index(value)
    except TypeError:
        raise InvalidInput(f"{name} must be an integer, not {value!r}") from None
    if not low <= number <= high:
        raise InvalidInput(f"{name} must be from {low} to {high}, not {number}")
    return number


def to_float(value: Any, name: str) -> float:
    """A finite number."""
    if isinstance(value, (bool, np.bool_, str, bytes)):
        raise InvalidInput(f"{name} must be a number, not {value!r}")
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name} must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise InvalidInput(f"{name} must be finite, not {number}")
    return number


def to_scale(scale: Any) -> tuple[str, float]:
    """Mode and value of the scale: "auto", "fixed" (sigma = 1), or a positive number."""
    if isinstance(scale, str):
        if scale not in ("auto", "fixed"):
            raise InvalidInput(f'scale must be "auto", "fixed" or a positive number, not {scale!r}')
        return scale, 1.0
    value = to_float(scale, "scale")
    if value <= 0.0:
        raise InvalidInput(f"scale must be positive, not {value}")
    return "given", value


def to_landmarks(landmarks: Any, source_size: int, target_size: int) -> npt.NDArray[np.int32]:
    """(k, 2) pairs of a source and a target vertex.

    Accepted: None, pairs of shape (k, 2), or a mapping with two lists of equal length, "source" and "target".
    """
    if landmarks is None:
        return np.empty((0, 2), np.int32)
    if isinstance(landmarks, Mapping):
        pairs = _zip_landmarks(landmarks)
    else:
        if isinstance(landmarks, (list, tuple)) and len(landmarks) == 0:
            return np.empty((0, 2), np.int32)
        pairs = to_indices(landmarks, "landmarks", 2)
    for column, side, size in ((0, "source", source_size), (1, "target", target_size)):
        indices = pairs[:, column]
        bad = np.flatnonzero((indices < 0) | (indices >= size))
        if bad.size:
            raise InvalidInput(
                f"landmark {bad[0]}: {side} vertex {indices[bad[0]]} does not exist; the {side} has {size} vertices"
                f" ({bad.size} such landmarks)"
            )
        _, first, counts = np.unique(indices, return_index=True, return_counts=True)
        if (counts > 1).any():
            vertex = int(indices[first[np.flatnonzero(counts > 1)[0]]])
            rows = np.flatnonzero(indices == vertex).tolist()
            raise InvalidInput(f"landmarks {rows} name the same {side} vertex {vertex}; give every vertex once")
    return pairs


def _zip_landmarks(landmarks: Mapping[str, Any]) -> npt.NDArray[np.int32]:
    if set(landmarks) != {"source", "target"}:
        raise InvalidInput(f'landmarks must have the keys "source" and "target", not {sorted(map(str, landmarks))}')
    sides = []
    for side in ("source", "target"):
        array = to_array(landmarks[side], f"landmarks of the {side}")
        if array.shape == (0,):  # an empty list has no dtype of its own
            array = array.astype(np.int32)
        if array.ndim != 1:
            raise InvalidInput(f"landmarks of the {side} must be a list of vertex indices, not shape {array.shape}")
        sides.append(to_indices(array.reshape(-1, 1), f"landmarks of the {side}", 1))
    if len(sides[0]) != len(sides[1]):
        raise InvalidInput(
            f"landmarks come in pairs, but there are {len(sides[0])} of the source and {len(sides[1])} of the target"
        )
    return np.hstack(sides)
