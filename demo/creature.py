# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the creature as a rigged, unwrapped mesh object and its two poses."""

from __future__ import annotations

import math

import bmesh
import bpy
import numpy as np
from mathutils import Euler, Matrix

from demo.creature_mesh import components, neighbour_mean, polygonize
from demo.creature_shape import FORE, HIND, bones, creature, horn_side
from demo.implicit import Array

GRID_SPACING = 0.02
VERTICES = 18_000

# Degrees about X (pitch), Y (roll), Z (yaw) of the rest pose's axes, per bone.
STANDING = {
    "neck.1": (-5, 0, -6), "neck.2": (-4, 0, -6), "head": (4, 0, -4),
    "tail.2": (1, 0, -3), "tail.3": (1, 0, -3), "tail.4": (1, 0, -3), "tail.5": (1, 0, -3),
}  # fmt: skip
STRIDING = {
    "spine.2": (0, 2, 5), "spine.3": (2, 2, 6), "spine.4": (2, 0, 6),
    "neck.1": (10, 0, 14), "neck.2": (8, 4, 14), "head": (4, 8, 12),
    "tail.1": (1, 0, 3), "tail.2": (2, 0, 4), "tail.3": (2, 0, 4), "tail.4": (2, 0, 4), "tail.5": (2, 0, 4),
    "tail.6": (2, 0, 3),
    "upper_arm.L": (-22, 0, 3), "forearm.L": (-15, 0, 0), "wrist.L": (14, 0, 0), "paw.L": (10, 0, 0),
    "upper_arm.R": (18, 0, 0), "forearm.R": (-8, 0, 0), "wrist.R": (8, 0, 0), "paw.R": (-12, 0, 0),
    "thigh.L": (16, 0, 0), "shin.L": (-10, 0, 0), "hock.L": (12, 0, 0), "foot.L": (10, 0, 0),
    "thigh.R": (-17, 0, 0), "shin.R": (8, 0, 0), "hock.R": (-6, 0, 0), "foot.R": (8, 0, 0),
}  # fmt: skip


def build_mesh() -> bpy.types.Mesh:
    """Closed manifold triangle mesh with about VERTICES vertices in the rest pose."""
    vertices, quads = polygonize(creature(), GRID_SPACING)
    dense = bpy.data.meshes.new("dense")
    dense.from_pydata(vertices.tolist(), [], quads.tolist())
    holder = bpy.data.objects.new("dense", dense)
    bpy.context.scene.collection.objects.link(holder)
    holder.modifiers.new("triangles", "TRIANGULATE")
    holder.modifiers.new("fewer", "DECIMATE").ratio = VERTICES / len(vertices)
    evaluated = holder.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = bpy.data.meshes.new_from_object(evaluated)
    mesh.name = "Creature"
    bpy.data.objects.remove(holder)
    bpy.data.meshes.remove(dense)
    check_closed(mesh)
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), bool))
    return mesh


def check_closed(mesh: bpy.types.Mesh) -> None:
    """Raise RuntimeError unless the mesh is triangles, closed and manifold."""
    work = bmesh.new()
    work.from_mesh(mesh)
    bad = sum(not e.is_manifold for e in work.edges) + sum(not v.is_manifold for v in work.verts)
    bad += sum(len(f.verts) != 3 for f in work.faces)
    work.free()
    if bad:
        raise RuntimeError(f"the creature's mesh has {bad} elements that are not closed-manifold triangles")


def build_rig(mesh: bpy.types.Mesh) -> tuple[bpy.types.Object, bpy.types.Object]:
    """The mesh as an object bound to an armature by smooth heat weights: (object, armature object)."""
    scene = bpy.context.scene
    body = bpy.data.objects.new("Creature", mesh)
    rig = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    for item in (body, rig):
        scene.collection.objects.link(item)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (parent, head, tail) in bones().items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = head, tail
        if parent:
            bone.parent = rig.data.edit_bones[parent]
    bpy.ops.object.mode_set(mode="OBJECT")
    for item in bpy.data.objects:
        item.select_set(item in (body, rig))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    weights = read_weights(body, list(bones()))
    if (weights.sum(axis=1) < 1e-3).any():
        raise RuntimeError("bone heat left vertices of the creature without weights")
    write_weights(body, list(bones()), smooth_weights(weights, triangles_of(mesh)))
    modifier = next(m for m in body.modifiers if m.type == "ARMATURE")
    modifier.use_deform_preserve_volume = True
    return body, rig


def smooth_weights(weights: Array, triangles: Array, rounds: int = 12) -> Array:
    """Weights spread along the surface, so that joints bend over a length rather than at a line."""
    for _ in range(rounds):
        weights = 0.5 * weights + 0.5 * neighbour_mean(weights, triangles)
    return weights / weights.sum(axis=1, keepdims=True)


def read_weights(body: bpy.types.Object, names: list[str]) -> Array:
    column = {body.vertex_groups[name].index: i for i, name in enumerate(names)}
    weights = np.zeros((len(body.data.vertices), len(names)))
    for vertex in body.data.vertices:
        for group in vertex.groups:
            weights[vertex.index, column[group.group]] = group.weight
    return weights


def write_weights(body: bpy.types.Object, names: list[str], weights: Array) -> None:
    for i, name in enumerate(names):
        group = body.vertex_groups[name]
        group.remove(range(len(weights)))
        for vertex in np.flatnonzero(weights[:, i] > 1e-3):
            group.add([int(vertex)], float(weights[vertex, i]), "REPLACE")


def set_pose(rig: bpy.types.Object, pose: dict[str, tuple[float, float, float]]) -> None:
    """Turn each named bone about the rest pose's axes; the others return to rest."""
    for bone in rig.pose.bones:
        turn = Euler([math.radians(a) for a in pose.get(bone.name, (0, 0, 0))]).to_quaternion()
        rest = bone.bone.matrix_local.to_quaternion()
        bone.matrix_basis = (rest.inverted() @ turn @ rest).to_matrix().to_4x4()
    bpy.context.view_layer.update()


def posed_vertices(body: bpy.types.Object) -> Array:
    """Evaluated vertices (n, 3) in world space."""
    evaluated = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    flat = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", flat)
    evaluated.to_mesh_clear()
    matrix = np.array(body.matrix_world)
    return flat.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3]


def stand_on_ground(body: bpy.types.Object, rig: bpy.types.Object) -> None:
    """Lift or lower the rig so that the lowest vertex touches the ground."""
    rig.matrix_world = Matrix.Translation((0.0, 0.0, -float(posed_vertices(body)[:, 2].min()))) @ rig.matrix_world
    bpy.context.view_layer.update()


def triangles_of(mesh: bpy.types.Mesh) -> Array:
    """Loop triangles (m, 3): the triangles that the add-on's `isograft_face` counts."""
    mesh.calc_loop_triangles()
    flat = np.empty(3 * len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", flat)
    return flat.reshape(-1, 3)


def uv_regions(mesh: bpy.types.Mesh) -> Array:
    """Region per polygon for the seams: body halves, each limb outside and inside, horns front and back."""
    centres = np.empty(3 * len(mesh.polygons), np.float32)
    mesh.polygons.foreach_get("center", centres)
    x, forward, up = centres[0::3], -centres[1::3], centres[2::3]
    side = np.where(x > 0, 0, 1)
    region = side.copy()
    for number, joints, low, high in ((2, FORE, -0.1, 1.15), (6, HIND, -1.3, -0.05)):
        _, s, u = np.array(joints).T
        top = up < (0.74 if number == 2 else 0.82)
        limb = top & (forward > low) & (forward < high) & (np.abs(x) > 0.17)
        middle = np.interp(up, u[::-1], s[::-1])
        region[limb] = (number + 2 * side + (np.abs(x) > middle))[limb]
    points = np.stack([x, -forward, up], axis=1).astype(float)
    distance = creature().nearest_label(points, ["horn", "body"])
    horn = (distance[:, 0] < distance[:, 1] - 0.01) & (up > 1.9) & (forward > 0.5)
    region[horn] = (10 + 2 * side + horn_side(points))[horn]
    return region


def unwrap(body: bpy.types.Object, margin: float = 0.006) -> None:
    """UV map with one island per piece of a region."""
    mesh = body.data
    region = tidy_regions(uv_regions(mesh), mesh)
    work = bmesh.new()
    work.from_mesh(mesh)
    for edge in work.edges:
        edge.seam = len({region[f.index] for f in edge.link_faces}) > 1
    work.to_mesh(mesh)
    work.free()
    mesh.uv_layers.new(name="UVMap")
    for item in bpy.data.objects:
        item.select_set(item is body)
    bpy.context.view_layer.objects.active = body
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.uv.unwrap(method="ANGLE_BASED", margin=margin)
    bpy.ops.uv.select_all(action="SELECT")
    bpy.ops.uv.average_islands_scale()
    bpy.ops.uv.pack_islands(margin=margin)
    bpy.ops.object.mode_set(mode="OBJECT")


def tidy_regions(region: Array, mesh: bpy.types.Mesh, smallest: int = 60) -> Array:
    """Pieces of fewer than `smallest` polygons join the neighbour region they share most edges with."""
    edge_faces: dict[tuple[int, int], list[int]] = {}
    for polygon in mesh.polygons:
        for key in polygon.edge_keys:
            edge_faces.setdefault(key, []).append(polygon.index)
    pairs = np.array([f for f in edge_faces.values() if len(f) == 2])
    region = region.copy()
    for _ in range(6):
        same = region[pairs[:, 0]] == region[pairs[:, 1]]
        piece = components(len(region), pairs[same])
        sizes = np.bincount(piece, minlength=len(region))
        small = np.flatnonzero((sizes > 0) & (sizes < smallest))
        if not len(small):
            break
        for label in small:
            touching = pairs[(piece[pairs] == label).sum(axis=1) == 1]
            others = region[touching[piece[touching] != label]]
            if len(others):
                region[piece == label] = np.bincount(others).argmax()
    return region
