# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: renders the scenes that worst.scene_of() describes, each from both sides.

blender -b --factory-startup -P blender_pictures.py -- SCENE.npz PICTURE.png [SCENE.npz PICTURE.png ...]
"""

from __future__ import annotations

import sys
from typing import Any

import bpy
import numpy as np

PANELS = (
    ("target", "target_colour"),
    ("source", "true_colour"),
    ("source", "matched_colour"),
    ("source", "error_colour"),
)
WIDTH = 1200
#: Workbench's light takes this much away again.
EXPOSURE = 0.9
GAP = 0.06


def main(arguments: list[str]) -> None:
    for scene_path, picture in zip(arguments[::2], arguments[1::2], strict=True):
        with np.load(scene_path) as arrays:
            render({name: arrays[name] for name in arrays.files}, picture)


def render(arrays: dict[str, Any], picture: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    size = max(float(np.ptp(arrays[name][:, k])) for name in ("target", "source") for k in (0, 2))
    across = max(float(np.ptp(arrays[name][:, 0])) for name in ("target", "source")) + GAP * size
    up = max(float(np.ptp(arrays[name][:, 2])) for name in ("target", "source")) + GAP * size
    for column, (name, colour) in enumerate(PANELS):
        mesh = coloured_mesh(arrays[name], arrays[f"{name}_faces"], arrays[colour])
        for row in range(2):
            item = bpy.data.objects.new(f"{colour}{row}", mesh)
            item.rotation_euler = (0.0, 0.0, np.pi * row)
            centre = 0.5 * (arrays[name].min(axis=0) + arrays[name].max(axis=0))
            side = -1.0 if row else 1.0
            item.location = (
                column * across - side * centre[0], -side * centre[1], -row * up - centre[2],
            )  # fmt: skip
            bpy.context.scene.collection.objects.link(item)
    shoot(len(PANELS) * across, 2.0 * up, (1.5 * across, -0.5 * up), size, picture)


def coloured_mesh(vertices: Any, faces: Any, colours: Any) -> bpy.types.Mesh:
    """A mesh with a colour per vertex; of a cloud, a small tetrahedron per point."""
    if not len(faces):
        vertices, faces, colours = tetrahedra(vertices, colours)
    mesh = bpy.data.meshes.new("Surface")
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(vertices, np.float32).ravel())
    mesh.loops.add(3 * len(faces))
    mesh.loops.foreach_set("vertex_index", np.ascontiguousarray(faces, np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(len(faces), 3, np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(faces), bool))
    mesh.update(calc_edges=True)
    mesh.validate()
    layer = mesh.color_attributes.new("Colour", "FLOAT_COLOR", "POINT")
    linear = np.where(colours <= 0.04045, colours / 12.92, ((colours + 0.055) / 1.055) ** 2.4)
    layer.data.foreach_set("color", np.column_stack([linear, np.ones(len(linear))]).astype(np.float32).ravel())
    mesh.color_attributes.active_color = layer
    return mesh


def tetrahedra(points: Any, colours: Any) -> tuple[Any, Any, Any]:
    radius = 0.004 * float(np.ptp(points, axis=0).max())
    corners = radius * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float)
    sides = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    vertices = (points[:, None] + corners).reshape(-1, 3)
    faces = (4 * np.arange(len(points))[:, None, None] + sides).reshape(-1, 3)
    return vertices, faces, np.repeat(colours, 4, axis=0)


def shoot(width: float, height: float, centre: tuple[float, float], depth: float, picture: str) -> None:
    """An orthographic picture along y with Workbench, transparent where nothing is."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    scene.collection.objects.link(camera)
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = max(width, height)
    camera.data.clip_end = 20.0 * depth
    camera.location = (centre[0], -8.0 * depth, centre[1])
    camera.rotation_euler = (np.pi / 2.0, 0.0, 0.0)
    scene.camera = camera
    scene.render.engine = "BLENDER_WORKBENCH"
    scene.render.resolution_x = WIDTH
    scene.render.resolution_y = max(1, round(WIDTH * height / width))
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.display.shading.light = "STUDIO"
    scene.display.shading.color_type = "VERTEX"
    scene.display.shading.show_specular_highlight = False
    scene.view_settings.exposure = EXPOSURE
    scene.display.render_aa = "8"
    scene.render.filepath = picture
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1 :])
