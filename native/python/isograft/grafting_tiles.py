# SPDX-License-Identifier: GPL-3.0-or-later
"""Which UDIM tiles of an image faces are read in, and these read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from isograft.errors import InvalidInput
from isograft.formats.tiles import FIRST, tile_path
from isograft.transfer.arrays import Array

_EDGE = 1e-4
"""UVs this far beyond a tile lie on its edge."""


def tiles_of(uv: Array, polygon: Array, chosen: Array) -> tuple[Array, int]:
    """The tile that every polygon is read in, that of its middle, and how many polygons reach beyond theirs.

    Args:
        uv: (G, 3, 2) of the triangles.
        polygon: (G,) polygon of every triangle.
        chosen: (G,) True for the triangles that are asked for, whole polygons.

    Returns:
        (G,) numbers, 0 where not chosen, -1 where there can be no tile.
    """
    count = int(polygon.max(initial=-1)) + 1
    size = np.maximum(np.bincount(polygon, minlength=count), 1)
    middle = [np.bincount(polygon, weights=uv[:, :, k].mean(axis=1), minlength=count) / size for k in range(2)]
    low = np.floor(np.stack(middle, axis=1))
    inside = (low >= 0.0).all(axis=1) & (low[:, 0] < 10.0)
    number = np.where(inside, FIRST + low @ [1, 10], -1).astype(np.int64)
    corner_low = low[polygon][:, None]
    beyond = ((uv < corner_low - _EDGE) | (uv > corner_low + 1.0 + _EDGE)).any(axis=(1, 2))
    return np.where(chosen, number[polygon], 0), len(np.unique(polygon[beyond & chosen]))


def read_tiles(path: Path, numbers: Array, where: str, read: Callable[[Path], Array]) -> dict[int, Array]:
    """The tiles of these numbers, each as `read` opens an image.

    Raises:
        InvalidInput: a tile is not there; names the file and what to do.
    """
    tiles = {}
    for number in np.unique(numbers[numbers != 0]).tolist():
        if number < 0:
            raise InvalidInput(
                f"{where} has UDIM tiles ({path.name}), and faces lie left of or below tile 1001, or right of 1010, "
                "where there are none; move their texture coordinates"
            )
        file = tile_path(path, number)
        if not file.is_file():
            raise InvalidInput(
                f"{where} has no tile {number} ({file.name}), and faces lie there; put it there, or move their "
                "texture coordinates"
            )
        tiles[number] = read(file)
    return tiles
