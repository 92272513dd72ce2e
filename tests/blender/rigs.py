# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups, an armature and shape keys for the creature of shapes.py, as functions of its directions."""

from typing import Any

import bpy
import numpy as np
from shapes import surface_points

Array = np.ndarray[Any, Any]

BONES = ("Root", "Arm", "Leg")


def true_weights(directions: Array) -> Array:
    """(n, 3) weights of BONES at unit directions: smooth, sum 1, much of the surface in one group alone."""
    arm = np.clip(1.6 * (directions @ np.array([0.83, 0.18, 0.53]) - 0.3), 0.0, 1.0)
    leg = np.clip(1.6 * (directions @ np.array([0.1, -0.95, 0.3]) - 0.3), 0.0, 1.0) * (1.0 - arm)
    return np.stack([1.0 - arm - leg, arm, leg], axis=1)


def give_weights(obj: Any, weights: Array, names: tuple[str, ...] = BONES) -> None:
    """Vertex groups of an object from (n, k); 0 leaves a vertex out."""
    for column, name in enumerate(names):
        group = obj.vertex_groups.get(name) or obj.vertex_groups.new(name=name)
        for row in np.flatnonzero(weights[:, column]):
            group.add([int(row)], float(weights[row, column]), "REPLACE")


def group_weights(obj: Any, names: tuple[str, ...] = BONES) -> Array:
    """(n, k) weights of an object's own mesh, 0 where a vertex is not in the group."""
    index = {obj.vertex_groups[name].index: column for column, name in enumerate(names)}
    result = np.zeros((len(obj.data.vertices), len(names)))
    for row, vertex in enumerate(obj.data.vertices):
        for element in vertex.groups:
            if element.group in index:
                result[row, index[element.group]] = element.weight
    return result


def add_armature(obj: Any) -> Any:
    """An armature of BONES, and its modifier on `obj`."""
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    ends = {
        "Root": ((0, 0, -1), (0, 0, 0)),
        "Arm": ((0.3, 0.1, 0.2), (1.4, 0.3, 0.9)),
        "Leg": ((0, -0.3, 0.1), (0.1, -1.4, 0.4)),
    }
    for name, (head, tail) in ends.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        if name != "Root":
            bone.parent = rig.data.edit_bones["Root"]
    bpy.ops.object.mode_set(mode="OBJECT")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    modifier.use_deform_preserve_volume = True
    return rig


def pose(rig: Any) -> None:
    """Bend arm and leg."""
    for name, angles in {"Arm": (0.5, 0.2, -0.4), "Leg": (-0.6, 0.0, 0.3)}.items():
        rig.pose.bones[name].rotation_mode = "XYZ"
        rig.pose.bones[name].rotation_euler = angles
    bpy.context.view_layer.update()


def smile(points: Array, directions: Array) -> Array:
    """Displacements of a key: a bump grows along its own direction, and leans."""
    unit = np.array([0.83, 0.18, 0.53])
    near = np.exp(-((directions - unit) ** 2).sum(axis=1) / 0.3)
    return near[:, None] * (0.25 * points + np.array([0.0, 0.2, -0.1]))


def frown(points: Array, directions: Array) -> Array:
    """Displacements of another key."""
    near = np.exp(-((directions - np.array([0.1, -0.95, 0.3])) ** 2).sum(axis=1) / 0.2)
    return near[:, None] * np.array([0.15, -0.2, 0.1])


def add_keys(obj: Any, directions: Array) -> None:
    """Basis, Smile and Frown; Frown is relative to Smile."""
    points = surface_points(directions)
    obj.shape_key_add(name="Basis", from_mix=False)
    for name, points_of_key in (
        ("Smile", points + smile(points, directions)),
        ("Frown", points + smile(points, directions) + frown(points, directions)),
    ):
        key = obj.shape_key_add(name=name, from_mix=False)
        key.data.foreach_set("co", points_of_key.astype(np.float32).ravel())
    blocks = obj.data.shape_keys.key_blocks
    blocks["Frown"].relative_key = blocks["Smile"]
    blocks["Smile"].slider_max, blocks["Smile"].slider_min = 1.5, -0.5
    blocks["Frown"].mute = True


def evaluated(obj: Any) -> Array:
    """(n, 3) vertices with modifiers and shape keys, in the object's space."""
    bpy.context.view_layer.update()
    item = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = np.array([tuple(vertex.co) for vertex in item.to_mesh().vertices])
    item.to_mesh_clear()
    return points
