# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups, and the armatures that use them."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import bpy
import numpy as np

from .meshes import Array

_ARMATURE_SETTINGS = (
    "object",
    "use_deform_preserve_volume",
    "use_vertex_groups",
    "use_bone_envelopes",
    "use_multi_modifier",
    "invert_vertex_group",
    "vertex_group",
    "show_viewport",
    "show_render",
    "show_in_editmode",
    "show_on_cage",
)


@dataclass(frozen=True)
class Group:
    """A vertex group without its weights."""

    name: str
    index: int
    is_locked: bool
    is_deforming: bool
    """True if it is named as a bone that deforms."""


def read_groups(obj: bpy.types.Object) -> list[Group]:
    """The vertex groups of an object, in their order."""
    bones = deforming_bones(obj)
    return [Group(group.name, group.index, group.lock_weight, group.name in bones) for group in obj.vertex_groups]


def read_weights(mesh: bpy.types.Mesh, indices: list[int]) -> Array:
    """(n, k) float32, weights in the groups `indices`, 0 where a vertex is not in the group."""
    column = {index: number for number, index in enumerate(indices)}
    rows, columns, weights = [], [], []
    # Blender has no faster way to read them.
    for row, vertex in enumerate(mesh.vertices):
        for element in vertex.groups:
            if element.group in column:
                rows.append(row)
                columns.append(column[element.group])
                weights.append(element.weight)
    result = np.zeros((len(mesh.vertices), len(indices)), dtype=np.float32)
    result[rows, columns] = weights
    return result


def write_weights(obj: bpy.types.Object, name: str, weights: Array, rows: Array) -> None:
    """Give the vertices of the mask `rows` (n,) their weight (n,) in the group `name`; 0 takes them out of it."""
    group = obj.vertex_groups.get(name) or obj.vertex_groups.new(name=name)
    out = np.flatnonzero(rows & (weights <= 0))
    if len(out):
        group.remove(out.tolist())
    inside = np.flatnonzero(rows & (weights > 0))
    values = weights[inside]
    # One call per run of equal weights: whole limbs belong to one bone alone.
    order = np.argsort(values, kind="stable")
    inside, values = inside[order], values[order]
    borders = np.flatnonzero(values[1:] != values[:-1]) + 1
    for start, end in pairwise([0, *borders.tolist(), len(values)] if len(values) else []):
        group.add(inside[start:end].tolist(), float(values[start]), "REPLACE")


def armature_modifiers(obj: bpy.types.Object) -> list[Any]:
    """The armature modifiers of an object that have an armature."""
    return [item for item in obj.modifiers if item.type == "ARMATURE" and item.object is not None]


def deforming_bones(obj: bpy.types.Object) -> set[str]:
    """Names of the bones that deform the object."""
    return {bone.name for item in armature_modifiers(obj) for bone in item.object.data.bones if bone.use_deform}


def write_armatures(obj: bpy.types.Object, sources: list[Any]) -> None:
    """Give `obj` modifiers as `sources`, or set those it has for the same armatures."""
    made = 0
    for source in sources:
        modifier = next((item for item in armature_modifiers(obj) if item.object == source.object), None)
        if modifier is None:
            modifier = obj.modifiers.new(source.name, "ARMATURE")
            # In front, as the donor's usually are: what follows works on the posed surface.
            with bpy.context.temp_override(object=obj, active_object=obj):
                bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=made)
            modifier = obj.modifiers[made]
            made += 1
        for name in _ARMATURE_SETTINGS:
            if name != "vertex_group" or source.vertex_group in obj.vertex_groups:
                setattr(modifier, name, getattr(source, name))
