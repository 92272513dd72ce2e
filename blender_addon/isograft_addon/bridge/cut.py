# SPDX-License-Identifier: GPL-3.0-or-later
"""Edges split and faces cut in place, with all their layers; a mesh to try things on."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import bmesh
import bpy
import numpy as np

from .layers import read_corner_normals, write_corner_normals
from .meshes import PROPERTY, Array, get_array

_LAYER = "isograft_cut"


def cut_faces(obj: bpy.types.Object, edges: Array, starts: Array, fractions: Array, faces: Array, ends: Array) -> Array:
    """Split edges and join their new vertices across faces; layers, groups and shape keys are interpolated.

    The vertices that were there keep their numbers.

    Args:
        edges: (c,) to split, each once.
        starts: (c,) the vertex that `fractions` (c,) counts from.
        faces: (k,) to cut; one may come several times.
        ends: (k, 2) rows of `edges` whose new vertices are joined.

    Returns:
        (c,) vertices of the cut mesh, one per row of `edges`.
    """
    mesh = bmesh.new()
    mesh.from_mesh(obj.data)
    for sequence in (mesh.verts, mesh.edges, mesh.faces):
        sequence.ensure_lookup_table()
    origin = mesh.faces.layers.int.new(_LAYER)
    for face in mesh.faces:
        face[origin] = face.index
    lean = _carry_normals(mesh, obj) if obj.data.has_custom_normals else None
    split = [(mesh.edges[edge], mesh.verts[vertex]) for edge, vertex in zip(edges, starts, strict=True)]
    vertices = [
        bmesh.utils.edge_split(edge, vertex, float(fraction))[1]
        for (edge, vertex), fraction in zip(split, fractions, strict=True)
    ]
    for index, (one, other) in zip(faces, ends, strict=True):
        first, second = vertices[one], vertices[other]
        shared = [face for face in first.link_faces if face[origin] == index and second in face.verts]
        if shared:
            bmesh.utils.face_split(shared[0], first, second)
    mesh.verts.index_update()
    rows = np.array([vertex.index for vertex in vertices], dtype=np.int64)
    normals = None
    if lean is not None:
        normals = np.array([tuple(loop[lean]) for face in mesh.faces for loop in face.loops])
        mesh.loops.layers.float_vector.remove(lean)
    mesh.faces.layers.int.remove(mesh.faces.layers.int[_LAYER])
    mesh.to_mesh(obj.data)
    mesh.free()
    if normals is not None:
        write_corner_normals(obj, normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30))
    obj.data.update()
    return rows


@contextmanager
def trial(objects: list[bpy.types.Object]) -> Iterator[None]:
    """Within the block the objects have copies of their meshes; after it their own ones again, as they were."""
    own = [(obj, obj.data, obj.get(PROPERTY)) for obj in objects]
    kept = [(obj, mesh, content.to_dict() if hasattr(content, "to_dict") else content) for obj, mesh, content in own]
    try:
        for obj, mesh, _ in kept:
            obj.data = mesh.copy()
        bpy.context.view_layer.update()
        yield
    finally:
        for obj, mesh, content in kept:
            tried, obj.data = obj.data, mesh
            if tried != mesh:
                bpy.data.meshes.remove(tried)
            if content is not None:
                obj[PROPERTY] = content
        bpy.context.view_layer.update()


def _carry_normals(mesh: Any, obj: bpy.types.Object) -> Any:
    """A layer with the custom normals: Blender keeps them relative to the faces, which are about to change."""
    layer = mesh.loops.layers.float_vector.new(_LAYER)
    normals = read_corner_normals(obj.data)
    starts = get_array(obj.data.polygons, "loop_start", np.int32)
    for face, start in zip(mesh.faces, starts, strict=True):
        for loop, normal in zip(face.loops, normals[start : start + len(face.loops)], strict=True):
            loop[layer] = normal
    return layer
