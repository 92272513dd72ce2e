# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours as numbers: sRGB, and grey."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def to_linear(encoded: Array) -> Array:
    """sRGB to linear, of the same type."""
    result: Array = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return result.astype(encoded.dtype)


def to_srgb(linear: Array) -> Array:
    """Linear to sRGB; what is negative is black."""
    linear = np.clip(linear, 0.0, None)
    result: Array = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    return result


def luminance(pixels: Array) -> Array:
    """(..., 1) of pixels (..., 3 or more), of the same type; bytes are rounded."""
    grey = pixels[..., :3] @ _LUMINANCE
    rounded: Array = (np.rint(grey) if pixels.dtype == np.uint8 else grey)[..., None].astype(pixels.dtype)
    return rounded
