# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps, colours, seams and material slots."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .meshes import Array, get_array

MAX_UV_LAYERS = 8
"""Blender's limit."""


@dataclass(frozen=True)
class CornerLayer:
    """Named values of a mesh: a UV map (loops by 2) or a colour attribute (vertices or loops by 4)."""

    name: str
    domain: str
    data_type: str
    values: Array
    is_render: bool = False


def read_uv_layers(mesh: bpy.types.Mesh) -> list[CornerLayer]:
    """The UV maps, values (l, 2)."""
    return [
        CornerLayer(
            layer.name, "CORNER", "UV", get_array(layer.data, "uv", np.float32, 2).astype(float), layer.active_render
        )
        for layer in mesh.uv_layers
    ]


def read_colors(obj: bpy.types.Object, mesh: bpy.types.Mesh) -> list[CornerLayer]:
    """The colour attributes of `mesh`, which is that of `obj` or its evaluated one: linear RGBA, (n, 4) or (l, 4)."""
    # Of the object's own mesh where it has colours: choosing another one does not evaluate the mesh again.
    choice = obj.data.color_attributes if len(obj.data.color_attributes) else mesh.color_attributes
    index = choice.render_color_index
    render = choice[index].name if 0 <= index < len(choice) else ""
    return [
        CornerLayer(
            layer.name,
            layer.domain,
            layer.data_type,
            get_array(layer.data, "color", np.float32, 4).astype(float),
            layer.name == render,
        )
        for layer in mesh.color_attributes
    ]


def polygon_materials(mesh: bpy.types.Mesh) -> Array:
    """(p,) int32, material slot of every polygon."""
    return get_array(mesh.polygons, "material_index", np.int32)


def write_uv_layer(obj: bpy.types.Object, name: str, values: Array, make_active: bool) -> None:
    """Write a UV map, values (l, 2), in place of one of the same name."""
    layers = obj.data.uv_layers
    active = layers.active.name if layers.active else None
    render = next((layer.name for layer in layers if layer.active_render), None)
    if layers.get(name) is None:
        # Blender may have to choose another name: UV maps and attributes share theirs from 4.0 on.
        name = layers.new(name=name, do_init=False).name
    layers[name].data.foreach_set("uv", np.ascontiguousarray(values, dtype=np.float32).ravel())
    if make_active or active is None:
        active = render = name
    layers.active = layers[active]
    if render is not None:
        layers[render].active_render = True


def write_seams(obj: bpy.types.Object, edges: Array) -> None:
    """Mark the edges of the mask `edges` (e,) as seams; other edges keep their marks."""
    collection = obj.data.edges
    collection.foreach_set("use_seam", get_array(collection, "use_seam", bool) | edges)


def activate_color(obj: bpy.types.Object, name: str) -> None:
    """Make a colour attribute the one that is shown and rendered."""
    colors = obj.data.color_attributes
    colors.active_color_index = colors.render_color_index = colors.find(name)


def copy_object_materials(obj: bpy.types.Object, source: bpy.types.Object) -> None:
    """Materials of `source` that belong to the object and not to its mesh, in the same slots of `obj`."""
    for ours, theirs in zip(obj.material_slots, source.material_slots, strict=False):
        if theirs.link == "OBJECT":
            ours.link = "OBJECT"
            ours.material = theirs.material


def write_polygon_materials(obj: bpy.types.Object, slots: list[Any], index: Array) -> None:
    """Append to the mesh's material slots those of `slots` beyond its own, and give every polygon its slot."""
    mesh = obj.data
    for material in slots[len(mesh.materials) :]:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(index, dtype=np.int32))


def read_corner_normals(mesh: bpy.types.Mesh) -> Array:
    """(l, 3) float64 normals of the face corners, custom ones where there are."""
    if hasattr(mesh, "corner_normals"):
        return get_array(mesh.corner_normals, "vector", np.float32, 3).astype(np.float64)
    mesh.calc_normals_split()
    normals = get_array(mesh.loops, "normal", np.float32, 3).astype(np.float64)
    mesh.free_normals_split()
    return normals


def write_corner_normals(obj: bpy.types.Object, normals: Array) -> None:
    """Custom normals (l, 3); where they are 0 Blender's own stay."""
    if hasattr(obj.data, "use_auto_smooth"):
        # Before Blender 4.1 custom normals are shown with this only.
        obj.data.use_auto_smooth = True
    obj.data.normals_split_custom_set(normals.tolist())
