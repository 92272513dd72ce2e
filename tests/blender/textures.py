# SPDX-License-Identifier: GPL-3.0-or-later
"""Images whose truth is known: the atlas of shapes.cube_uv painted with the colour of every direction."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import shapes

Array = np.ndarray[Any, Any]


def atlas(size: int) -> Array:
    """(size, size, 4) RGBA, row 0 at the bottom: what cube_uv leads to each texel has that direction's colour."""
    ticks = (np.arange(size) + 0.5) / size
    uv = np.stack(np.meshgrid(ticks, ticks), axis=-1) * np.array([3.0, 2.0])
    axis, side = np.floor(uv[..., 0]).astype(int), np.floor(uv[..., 1]).astype(int)
    first, second = np.moveaxis((uv - np.floor(uv) - 0.5) / 0.25, -1, 0)
    direction = np.empty((size, size, 3))
    np.put_along_axis(direction, axis[..., None], (2.0 * side - 1.0)[..., None], axis=2)
    np.put_along_axis(direction, ((axis + 1) % 3)[..., None], first[..., None], axis=2)
    np.put_along_axis(direction, ((axis + 2) % 3)[..., None], second[..., None], axis=2)
    direction /= np.linalg.norm(direction, axis=2, keepdims=True)
    return shapes.point_color(direction)


def new_image(name: str, pixels: Array, is_float: bool = False, space: str = "") -> Any:
    """A packed image of (h, w, 4)."""
    image = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0], alpha=True, float_buffer=is_float)
    if space:
        image.colorspace_settings.name = space
    image.pixels.foreach_set(np.ascontiguousarray(pixels, dtype=np.float32).ravel())
    image.update()
    image.pack()
    return image


def tiled_image(folder: Path, tiles: dict[int, Array], is_packed: bool) -> Any:
    """An image "Tiles" of UDIM tiles by their numbers, read from files that are gone if it is packed."""
    paths = []
    for number, pixels in tiles.items():
        image = new_image("Tile", pixels)
        paths.append(folder / f"tiles.{number}.png")
        image.filepath_raw, image.file_format = str(paths[-1]), "PNG"
        image.save()
        bpy.data.images.remove(image)
    image = bpy.data.images.load(str(paths[0]))
    image.name, image.source = "Tiles", "TILED"
    image.filepath = str(folder / "tiles.<UDIM>.png")
    image.reload()
    for number in tiles:
        if number not in [tile.number for tile in image.tiles]:
            image.tiles.new(number)
    if is_packed:
        image.pack()
        for path in paths:
            path.unlink()
    return image


def pixels_of(image: Any) -> Array:
    """(h, w, 4) as stored."""
    flat = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(image.size[1], image.size[0], image.channels)


def material(name: str) -> tuple[Any, Any]:
    """A Principled material and its shader."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, made.node_tree.nodes["Principled BSDF"]


def texture(made: Any, image: Any, socket: Any, through: str = "") -> Any:
    """An image texture node that leads to `socket`, through a node of type `through` if that is named."""
    nodes, links = made.node_tree.nodes, made.node_tree.links
    node = nodes.new("ShaderNodeTexImage")
    node.image = image
    if through:
        between = nodes.new(through)
        links.new(node.outputs["Color"], next(s for s in between.inputs if s.name in {"Color", "Height"}))
        links.new(between.outputs[0], socket)
    else:
        links.new(node.outputs["Color"], socket)
    return node


def image_at(made: Any, name: str) -> Any:
    """The image that leads to an input of the material's shader, or None."""
    socket = made.node_tree.nodes["Principled BSDF"].inputs[name]
    if not socket.is_linked:
        return None
    node = socket.links[0].from_node
    if node.type != "TEX_IMAGE":
        node = next(s for s in node.inputs if s.is_linked).links[0].from_node
    return node.image
