# SPDX-License-Identifier: GPL-3.0-or-later
"""A new unwrap by Blender's Smart UV Project, made on a copy: the object itself is not touched."""

from typing import Any

import bpy
import numpy as np

from .meshes import Array, RefusedError, get_array

ANGLE = np.radians(66.0)


def smart_unwrap(obj: Any, island_margin: float) -> Array:
    """(l, 2) UVs of the object's own mesh.

    Raises:
        RefusedError: Blender cannot unwrap here.
    """
    context = bpy.context
    active, selected = context.view_layer.objects.active, list(context.selected_objects)
    mesh = obj.data.copy()
    while mesh.uv_layers:
        mesh.uv_layers.remove(mesh.uv_layers[0])
    name = mesh.uv_layers.new(name="Unwrap").name
    for polygons in (mesh.polygons,):
        polygons.foreach_set("select", np.ones(len(polygons), dtype=bool))
    copy = bpy.data.objects.new(f"{obj.name} unwrap", mesh)
    context.scene.collection.objects.link(copy)
    try:
        for item in selected:
            item.select_set(False)
        copy.select_set(True)
        context.view_layer.objects.active = copy
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.uv.smart_project(angle_limit=ANGLE, island_margin=island_margin)
        bpy.ops.object.mode_set(mode="OBJECT")
        return get_array(mesh.uv_layers[name].data, "uv", np.float32, 2).astype(np.float64)
    except RuntimeError as error:
        raise RefusedError(f"{obj.name}: Blender could not unwrap it ({error}); unwrap it yourself first") from error
    finally:
        bpy.data.objects.remove(copy)
        bpy.data.meshes.remove(mesh)
        for item in selected:
            item.select_set(True)
        context.view_layer.objects.active = active
