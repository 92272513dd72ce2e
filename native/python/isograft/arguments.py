# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of what a caller passes: each returns the checked value or raises InvalidInput with what and where."""

from __future__ import annotations

import math
import operator
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
