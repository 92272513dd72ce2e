# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a row of coloured meshes, rendered. Called with a .npz of the meshes and the picture's name."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from demo import scene

#: Rotations that make the named direction +Z.
UPRIGHT = {"x": Matrix.Rotation(-np.pi / 2, 4, "Y"), "y": Matrix.Rotation(np.pi / 2, 4, "X"), "z": Matrix.Identity(4)}


def add(name: str, arrays: dict[str, np.ndarray], upright: Matrix) -> bpy.types.Object:
    faces = arrays["faces"]
    item = scene.add_mesh(name, arrays["vertices"], faces)
    layer = item.data.color_attributes.new("Shown", "FLOAT_COLOR", "POINT")
    colours = np.column_stack([arrays["colours"], np.ones(len(arrays["colours"]))])
    layer.data.foreach_set("color", colours.astype(np.float32).ravel())
    item.data.materials.append(scene.attribute_material(f"{name} shown", layer.name, 0.8))
    item.matrix_world = upright
    bpy.context.view_layer.update()
    return item


def main() -> None:
    meshes, out = sys.argv[sys.argv.index("--") + 1 :]
    with np.load(meshes) as file:
        arrays = dict(file)
    told = json.loads(str(arrays["told"]))
    scene.clear()
    size = max(float(np.ptp(arrays[f"vertices{i}"], axis=0).max()) for i in range(len(told["names"])))
    scene.studio(told["samples"], size)
    upright = Matrix.Rotation(np.radians(told["turn"]), 4, "Z") @ UPRIGHT[told["up"]]
    items = []
    edge = 0.0
    for i, name in enumerate(told["names"]):
        parts = {key: arrays[f"{key}{i}"] for key in ("vertices", "faces", "colours")}
        item = add(name, parts, upright)
        points = scene.world_points([item])
        low, high = points.min(axis=0), points.max(axis=0)
        # A hair above the ground, which a flat one would else lie in.
        above = 0.01 * float(np.ptp(points, axis=0).max())
        shift = Vector((edge - low[0], -0.5 * (low[1] + high[1]), above - low[2]))
        item.matrix_world = Matrix.Translation(shift) @ item.matrix_world
        edge += float(high[0] - low[0]) + 0.12 * float(np.ptp(points, axis=0).max())
        items.append(item)
    bpy.context.view_layer.update()
    # The ground is for things that stand on it; flat ones are seen from above.
    scene.frame(items, 0.0, told["elevation"], told["pixels"], below=0.16)
    heights = np.ptp(scene.world_points(items), axis=0)
    # Of a row of flat things the width decides whether captions can be read.
    size = float(max(0.05 * heights[2], 0.018 * heights[0]))
    scene.level([scene.caption(name, item, size) for name, item in zip(told["names"], items, strict=True)])
    bpy.context.scene.render.image_settings.file_format = "JPEG"
    bpy.context.scene.render.image_settings.quality = 82
    scene.render(out)


main()
