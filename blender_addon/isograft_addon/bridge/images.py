# SPDX-License-Identifier: GPL-3.0-or-later
"""Images as arrays, row 0 at the bottom; new images and the material that shows them."""

from typing import Any

import bpy
import numpy as np

from .meshes import Array, RefusedError
from .shading import Input, principled

_DATA_SPACES = {"Non-Color", "Raw", "Linear", "Linear Rec.709", "Generic Data", "Utility - Raw", "Utilities - Raw"}


def read_image(image: Any, where: str) -> Array:
    """(h, w, 4): uint8 as stored, or float32, linear.

    Raises:
        RefusedError: the file is missing or unreadable, or the image is no single picture.
    """
    name = f"{where}: the image {image.name}"
    if image.source in {"SEQUENCE", "MOVIE"}:
        raise RefusedError(f"{name} is a {image.source.lower()}, which is not read; choose a single image")
    if image.source == "VIEWER":
        raise RefusedError(f"{name} is a render result, which is not read; save it as an image first")
    # Size and pixels are loaded when they are first asked for.
    width, height = image.size
    count = len(image.pixels)
    if not width or not height or count != width * height * image.channels:
        if image.packed_file is not None:
            raise RefusedError(f"{name} is packed in a format that Blender cannot read; replace it (Image > Replace)")
        raise RefusedError(
            f"{name} cannot be read from {image.filepath or 'nowhere'}; find it "
            "(File > External Data > Find Missing Files), or choose another"
        )
    flat = np.empty(count, dtype=np.float32)
    image.pixels.foreach_get(flat)
    pixels = _four(flat.reshape(height, width, image.channels))
    return pixels if image.is_float else np.rint(pixels * 255.0).astype(np.uint8)


def read_old_image(name: str, space: str) -> Array | None:
    """As read_image(), of an image that write_image() has made in this colour space; None if there is none."""
    image = bpy.data.images.get(name)
    if image is None or (space and color_space(image) != space):
        return None
    try:
        return read_image(image, name)
    except RefusedError:
        return None


def is_data(image: Any) -> bool:
    """True if the image's numbers are no colours as the eye sees them."""
    return image.is_float or image.colorspace_settings.name in _DATA_SPACES or image.colorspace_settings.is_data


def color_space(image: Any) -> str:
    """Name of the image's colour space."""
    return str(image.colorspace_settings.name)


def write_image(name: str, pixels: Array, space: str, overwrite: bool) -> Any:
    """A new packed image of `pixels` (h, w, 1, 3 or 4), in place of that of the same name if `overwrite`."""
    height, width = pixels.shape[:2]
    is_float = pixels.dtype != np.uint8
    old = bpy.data.images.get(name) if overwrite else None
    image = bpy.data.images.new(name, width, height, alpha=pixels.shape[2] == 4, float_buffer=is_float)
    if space:
        image.colorspace_settings.name = space
    buffer = _four(pixels if is_float else pixels.astype(np.float32) / np.float32(255.0))
    image.pixels.foreach_set(np.ascontiguousarray(buffer, dtype=np.float32).ravel())
    image.update()
    image.pack()
    if old is not None:
        old.user_remap(image)
        bpy.data.images.remove(old)
        image.name = name
    return image


def write_material(
    name: str, inputs: list[tuple[Input, Any]], ways: dict[str, str], uv_map: str, overwrite: bool
) -> Any:
    """A Principled material of constants and images, which are looked up by the UV map `uv_map`; `ways` of
    read_ways()."""
    old = bpy.data.materials.get(name) if overwrite else None
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    made = principled(material)
    assert made is not None
    shader = made.node
    for way, chosen in ways.items():
        setattr(shader, way, chosen)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    place = nodes.new("ShaderNodeUVMap")
    place.uv_map = uv_map
    place.location = (-1100, 0)
    row = 0
    for item, image in inputs:
        socket = shader.inputs[item.name]
        if image is None:
            if item.kind in {"color", "value", "vector"}:
                socket.default_value = item.value[0] if len(item.value) == 1 else item.value
            continue
        node = nodes.new("ShaderNodeTexImage")
        node.image, node.label, node.location = image, item.name, (-800, 300 - 300 * row)
        row += 1
        links.new(place.outputs["UV"], node.inputs["Vector"])
        between = _between(nodes, item, uv_map)
        if between is None:
            links.new(node.outputs["Color"], socket)
        else:
            between.location = (-400, node.location[1])
            links.new(node.outputs["Color"], between.inputs["Color" if item.kind == "normal" else "Height"])
            links.new(between.outputs["Normal"], socket)
    if old is not None:
        old.user_remap(material)
        bpy.data.materials.remove(old)
        material.name = name
    return material


def _between(nodes: Any, item: Input, uv_map: str) -> Any:
    """The node between an image and a normal input."""
    if item.kind == "normal":
        node = nodes.new("ShaderNodeNormalMap")
        node.uv_map = uv_map
    elif item.kind == "bump":
        node = nodes.new("ShaderNodeBump")
        node.inputs["Distance"].default_value, node.invert = item.distance, item.is_inverted
    else:
        return None
    node.inputs["Strength"].default_value = item.strength
    return node


def _four(pixels: Array) -> Array:
    """RGBA of 1, 2, 3 or 4 channels."""
    channels = pixels.shape[2]
    if channels == 4:
        return pixels
    result = np.ones((*pixels.shape[:2], 4), dtype=pixels.dtype)
    result[..., :3] = pixels[..., :3] if channels == 3 else pixels[..., :1]
    if channels == 2:
        result[..., 3] = pixels[..., 1]
    return result
