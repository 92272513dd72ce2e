# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the creature's image texture and the materials of the demo."""

from __future__ import annotations

import bpy
import numpy as np

from demo.creature_shape import creature
from demo.implicit import Array
from demo.paint import openness, paint
from demo.raster import bleed, rasterize

SIZE = 2048


def corner_uvs(mesh: bpy.types.Mesh) -> Array:
    """Active UV map per corner (#loops, 2)."""
    layer = mesh.uv_layers.active.data
    flat = np.empty(2 * len(layer), np.float32)
    layer.foreach_get("uv", flat)
    return flat.reshape(-1, 2).astype(float)


def paint_texture(mesh: bpy.types.Mesh, path: str, size: int = SIZE) -> bpy.types.Image:
    """Image painted from the rest pose's places, saved as PNG: sRGB colour, relief height in alpha."""
    co = np.empty(3 * len(mesh.vertices), np.float32)
    normal = np.empty_like(co)
    mesh.vertices.foreach_get("co", co)
    mesh.vertices.foreach_get("normal", normal)
    points, normals = co.reshape(-1, 3).astype(float), normal.reshape(-1, 3).astype(float)
    shape = creature()
    crevice = openness(shape, points, normals)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    triangles = corners.reshape(-1, 3)
    texel, triangle, weights = rasterize(corner_uvs(mesh).reshape(-1, 3, 2), size)
    pixels = np.zeros((size * size, 4), np.float32)
    for part in np.array_split(np.arange(len(texel)), 12):
        spread = weights[part][:, :, None]
        owners = triangles[triangle[part]]
        n = (normals[owners] * spread).sum(axis=1)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        fold = (crevice[owners] * weights[part]).sum(axis=1)
        colour, height = paint(shape, (points[owners] * spread).sum(axis=1), n, fold)
        encoded = np.where(colour <= 0.0031308, 12.92 * colour, 1.055 * np.maximum(colour, 1e-9) ** (1 / 2.4) - 0.055)
        pixels[texel[part]] = np.concatenate([encoded, height[:, None]], axis=1)
    painted = np.zeros(size * size, bool)
    painted[texel] = True
    square = bleed(pixels.reshape(size, size, 4), painted.reshape(size, size), 24)
    image = bpy.data.images.new("Creature", size, size, alpha=True)
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(np.clip(square, 0.0, 1.0).ravel())
    image.filepath_raw, image.file_format = path, "PNG"
    image.save()
    image.pack()
    return image


def textured_material(image: bpy.types.Image, name: str = "Hide") -> bpy.types.Material:
    """Material that shows the image through the active UV map, with its alpha as relief."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader = nodes["Principled BSDF"]
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = image
    bump = nodes.new("ShaderNodeBump")
    bump.inputs["Strength"].default_value = 0.35
    bump.inputs["Distance"].default_value = 0.02
    links.new(picture.outputs["Color"], shader.inputs["Base Color"])
    links.new(picture.outputs["Alpha"], bump.inputs["Height"])
    links.new(bump.outputs["Normal"], shader.inputs["Normal"])
    shader.inputs["Roughness"].default_value = 0.42
    return material
