# SPDX-License-Identifier: GPL-3.0-or-later
"""The tiles of UDIM images as arrays: Blender shows add-ons the pixels of the first one only."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import bpy

from .images import read_image
from .meshes import Array, RefusedError

FIRST = 1001
"""Number of the tile at the origin; u counts by ones up to 9, v by tens."""


def read_tiles(image: Any, numbers: Iterable[int], where: str) -> dict[int, Array]:
    """The tiles of these numbers, each as read_image() reads an image, from their files or from what is packed.

    Raises:
        RefusedError: a tile is not there, not saved, or cannot be read.
    """
    name = f"{where}: the image {image.name}"
    if image.is_dirty or not (image.packed_files or image.filepath):
        raise RefusedError(
            f"{name} has UDIM tiles that are not saved; save it first (Image > Save in the Image Editor)"
        )
    there = {tile.number for tile in image.tiles}
    result = {}
    for number in numbers:
        if number not in there:
            what = f"no tile {number}" if number > 0 else "no tiles left of or below 1001, nor right of 1010"
            raise RefusedError(f"{name} has {what}, and faces lie there; add the tile, or move the faces in the UV map")
        with _alone(image, number, name) as tile:
            result[number] = read_image(tile, f"{where}: tile {number} of {image.name}")
    return result


@contextmanager
def _alone(image: Any, number: int, name: str) -> Iterator[Any]:
    """One tile as an image of its own, gone after the block."""
    packed = {item.tile_number or FIRST: item.packed_file for item in image.packed_files}
    if number in packed:
        data = packed[number].data
        tile = bpy.data.images.new(f"{image.name} {number}", 1, 1)
        tile.pack(data=data, data_len=len(data))
        tile.source = "FILE"
    else:
        path = _path(bpy.path.abspath(image.filepath, library=image.library), number)
        try:
            tile = bpy.data.images.load(path)
        except RuntimeError as error:
            raise RefusedError(
                f"{name}: its tile {number} cannot be read from {path}; find it (File > External Data > Find Missing "
                "Files), or remove the tile"
            ) from error
    try:
        # Before the pixels are loaded, which happens when they are first asked for.
        tile.colorspace_settings.name = image.colorspace_settings.name
        tile.alpha_mode = image.alpha_mode
        yield tile
    finally:
        bpy.data.images.remove(tile)


def _path(pattern: str, number: int) -> str:
    """The file of a tile; a path without a place for its number is that of the only one."""
    v, u = divmod(number - FIRST, 10)
    return pattern.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{u + 1}_v{v + 1}")
