# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as arrays whose first row is the lowest: .npy in the base install, everything else through Pillow."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing

PathLike = str | os.PathLike[str]


def _pillow(path: PathLike) -> Any:
    try:
        from PIL import Image
    except ImportError:
        raise InvalidInput(
            f"{path}: reading and writing images needs Pillow: install it with pip install isograft[textures], or use "
            "an .npy file"
        ) from None
    return Image


def check_image_output(path: PathLike) -> None:
    """Raises InvalidInput now rather than after long work if an image of this name could not be written."""
    if Path(path).suffix.lower() != ".npy":
        _kind(path)


def _kind(path: PathLike) -> str:
    """Pillow's name of the format that the suffix stands for."""
    image_module = _pillow(path)
    kind = image_module.registered_extensions().get(Path(path).suffix.lower())
    if kind is None or kind not in image_module.SAVE:
        raise InvalidInput(f"{path}: images of this kind cannot be written: use .png")
    return str(kind)


def read_image(path: PathLike) -> npt.NDArray[Any]:
    """(height, width, components) of uint8 or float32 (16-bit and float images), the first row the lowest.

    Raises:
        InvalidInput: not an image, a kind that is not known, or Pillow is missing.
        OSError: it cannot be opened.
    """
    if Path(path).suffix.lower() == ".npy":
        return _read_npy(path)
    image_module = _pillow(path)
    try:
        with image_module.open(path) as file:
            if file.mode.startswith("I;16"):
                pixels = np.asarray(file, np.float32) / np.float32(65535)
            elif file.mode == "F":
                pixels = np.asarray(file, np.float32)
            elif file.mode in ("L", "LA", "RGB", "RGBA"):
                pixels = np.asarray(file)
            elif file.mode in ("1", "P", "CMYK", "YCbCr", "PA"):
                pixels = np.asarray(file.convert("RGBA" if "transparency" in file.info or file.mode == "PA" else "RGB"))
            else:
                raise InvalidInput(f"{path}: pixels of the kind {file.mode} are not supported")
    except (image_module.UnidentifiedImageError, SyntaxError, ValueError) as error:
        raise InvalidInput(f"{path}: not an image that can be read: {error}") from None
    if pixels.ndim == 2:
        pixels = pixels[:, :, None]
    return np.ascontiguousarray(pixels[::-1])


def _read_npy(path: PathLike) -> npt.NDArray[Any]:
    try:
        pixels: npt.NDArray[Any] = np.load(path, allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise InvalidInput(f"{path}: not an .npy file: {error}") from None
    if not isinstance(pixels, np.ndarray) or pixels.ndim not in (2, 3) or pixels.dtype not in (np.uint8, np.float32):
        raise InvalidInput(f"{path}: must hold uint8 or float32, (height, width) or (height, width, components)")
    return pixels if pixels.ndim == 3 else pixels[:, :, None]


def write_image(path: PathLike, pixels: npt.NDArray[Any]) -> None:
    """Write an array as read_image() gives it; floats as 8 bits unless to .npy. Whole or not at all."""
    suffix = Path(path).suffix.lower()
    if suffix == ".npy":
        with replacing(path) as file:
            np.save(file, pixels, allow_pickle=False)
        return
    kind = _kind(path)
    levels = pixels if pixels.dtype == np.uint8 else np.rint(255 * np.clip(pixels, 0, 1)).astype(np.uint8)
    if levels.shape[2] == 2 and suffix != ".png":
        levels = levels[:, :, :1]
    if kind == "JPEG":
        levels = levels[:, :, :3]
    levels = levels[::-1, :, 0] if levels.shape[2] == 1 else levels[::-1]
    with replacing(path) as file:
        _pillow(path).fromarray(np.ascontiguousarray(levels)).save(file, format=kind)
