# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as arrays, and the property that tells what a receiver was matched with."""

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import bpy
import numpy as np

Array = np.ndarray[Any, Any]

PROPERTY = "isograft"
"""Name of the id property that tells what a receiver was matched with."""


class RefusedError(Exception):
    """An object cannot take part; the text names it and says what to do."""


@dataclass(frozen=True)
class MeshArrays:
    """A mesh as arrays, in its object's space. n vertices, e edges, l loops, k loop triangles, p polygons."""

    vertices: Array
    """(n, 3) float64."""
    triangles: Array
    """(k, 3) int32, vertices of the loop triangles, in Blender's order."""
    triangle_loops: Array
    """(k, 3) int32."""
    triangle_polygons: Array
    """(k,) int32."""
    loop_polygons: Array
    """(l,) int32."""
    loop_vertices: Array
    """(l,) int32."""
    loop_edges: Array
    """(l,) int32."""
    edges: Array
    """(e, 2) int32, vertices of the edges."""
    rest: Array
    """(m, 3) float64, the object's own vertices, without modifiers and shape keys; m = n while modifiers keep it."""
    linear: Array
    """(3, 3), the object's scale and shear, rotation taken out."""
    warnings: list[str] = field(default_factory=list)

    @property
    def polygon_count(self) -> int:
        """Polygons, those without an area too."""
        return int(self.loop_polygons.max()) + 1

    @property
    def is_mirrored(self) -> bool:
        """True if the object's scale turns the surface inside out."""
        return bool(np.linalg.det(self.linear) < 0)

    def surface(self) -> tuple[Array, Array]:
        """Vertices and triangles as they look in the scene, up to position and rotation, wound outward."""
        triangles = self.triangles[:, [0, 2, 1]] if self.is_mirrored else self.triangles
        return self.vertices @ self.linear.T, np.ascontiguousarray(triangles)

    def in_surface_order(self, corners: Array) -> Array:
        """(k, 3) or (n, 3) of the loop triangles' corners in the order of surface()'s triangles. Its own inverse."""
        return np.ascontiguousarray(corners[:, [0, 2, 1]]) if self.is_mirrored else corners

    def in_loop_order(self, barycentric: Array) -> Array:
        """Weights of surface()'s triangles as weights of the loop triangles' corners."""
        return self.in_surface_order(barycentric)

    @cached_property
    def content_hash(self) -> str:
        """Changes with any vertex of the object's own mesh and with any face.

        Not with its transform or its layers, nor with a pose or a value of a shape key: a match outlives those.
        """
        digest = hashlib.sha256()
        for array, dtype in ((self.rest, "<f4"), (self.triangles, "<i4"), (self.triangle_loops, "<i4")):
            digest.update(np.int64(array.shape).tobytes())
            digest.update(np.ascontiguousarray(array, dtype=dtype).tobytes())
        return digest.hexdigest()


def read_donor(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> MeshArrays:
    """The evaluated mesh: modifiers and shape keys applied.

    Raises:
        RefusedError: no faces, or a scale of zero.
    """
    with Evaluated(obj, depsgraph) as mesh:
        return _read(obj, mesh, mesh, [])


def read_receiver(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> MeshArrays:
    """The faces of the object's own mesh; its vertices evaluated while modifiers keep their number.

    Raises:
        RefusedError: no faces, a scale of zero, or a mesh that may not be written.
    """
    refuse_unwritable(obj)
    with Evaluated(obj, depsgraph) as mesh:
        if len(mesh.vertices) == len(obj.data.vertices):
            return _read(obj, obj.data, mesh, [])
    warning = f"{obj.name}: its modifiers change the number of vertices; the mesh without modifiers is used"
    return _read(obj, obj.data, obj.data, [warning])


def own_arrays(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> MeshArrays:
    """As read_receiver, for an object that gives: its mesh may be linked or shared."""
    with Evaluated(obj, depsgraph) as mesh:
        kept = len(mesh.vertices) == len(obj.data.vertices)
        return _read(obj, obj.data, mesh if kept else obj.data, [])


def refuse_unwritable(obj: bpy.types.Object) -> None:
    """Raises RefusedError if the object's mesh is linked from a library or shared with other objects."""
    mesh = obj.data
    if obj.library is not None or mesh.library is not None or obj.override_library is not None:
        raise RefusedError(
            f"{obj.name} is linked from another file; make it local first (Object > Relations > Make Local)"
        )
    if mesh.users - int(mesh.use_fake_user) > 1:
        raise RefusedError(
            f"{obj.name} shares its mesh with another object; make it single user first "
            "(Object > Relations > Make Single User > Object & Data)"
        )


def copy_mesh(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph, own: bool) -> bpy.types.Mesh:
    """A new mesh as the object's own one without shape keys, or as its evaluated one, with all layers."""
    if own:
        mesh = obj.data.copy()
        if mesh.shape_keys is not None:
            holder = bpy.data.objects.new("holder", mesh)
            holder.shape_key_clear()
            bpy.data.objects.remove(holder)
        return mesh
    return bpy.data.meshes.new_from_object(
        obj.evaluated_get(depsgraph), preserve_all_data_layers=True, depsgraph=depsgraph
    )


def write_vertices(obj: bpy.types.Object, vertices: Array, flip: bool) -> None:
    """Move the vertices to (n, 3); `flip` turns the faces around."""
    obj.data.vertices.foreach_set("co", np.ascontiguousarray(vertices, dtype=np.float32).ravel())
    if flip:
        obj.data.flip_normals()
    obj.data.update()


def write_property(obj: bpy.types.Object, content: dict[str, Any]) -> None:
    """Write the id property that read_property reads."""
    obj[PROPERTY] = content
    obj.data.update()
    obj.update_tag()


def read_property(obj: bpy.types.Object) -> dict[str, Any] | None:
    """What write_property wrote, or None."""
    content = obj.get(PROPERTY)
    return content.to_dict() if hasattr(content, "to_dict") else None


class Evaluated:
    """The evaluated mesh of an object with all its layers, for the length of a with block."""

    def __init__(self, obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> None:
        self._object = obj.evaluated_get(depsgraph)
        self._depsgraph = depsgraph

    def __enter__(self) -> bpy.types.Mesh:
        return self._object.to_mesh(preserve_all_data_layers=True, depsgraph=self._depsgraph)

    def __exit__(self, *_: object) -> None:
        self._object.to_mesh_clear()


def _read(obj: bpy.types.Object, faces: bpy.types.Mesh, positions: bpy.types.Mesh, warnings: list[str]) -> MeshArrays:
    faces.calc_loop_triangles()
    if not len(faces.loop_triangles):
        raise RefusedError(f"{obj.name} has no faces; take a mesh with faces")
    sizes = get_array(faces.polygons, "loop_total", np.int32)
    starts = get_array(faces.polygons, "loop_start", np.int32)
    # Polygons need not lie in the order of their loops.
    order = np.argsort(starts, kind="stable")
    loop_polygons = np.repeat(order, sizes[order]).astype(np.int32)
    return MeshArrays(
        vertices=_positions(positions),
        triangles=get_array(faces.loop_triangles, "vertices", np.int32, 3),
        triangle_loops=get_array(faces.loop_triangles, "loops", np.int32, 3),
        triangle_polygons=get_array(faces.loop_triangles, "polygon_index", np.int32),
        loop_polygons=loop_polygons,
        loop_vertices=get_array(faces.loops, "vertex_index", np.int32),
        loop_edges=get_array(faces.loops, "edge_index", np.int32),
        edges=get_array(faces.edges, "vertices", np.int32, 2),
        rest=_positions(obj.data),
        linear=_linear_part(obj),
        warnings=warnings,
    )


def _positions(mesh: bpy.types.Mesh) -> Array:
    position = mesh.attributes.get("position")
    if position is not None and position.data_type == "FLOAT_VECTOR" and len(position.data) == len(mesh.vertices):
        return get_array(position.data, "vector", np.float32, 3).astype(np.float64)
    return get_array(mesh.vertices, "co", np.float32, 3).astype(np.float64)


def _linear_part(obj: bpy.types.Object) -> Array:
    """Scale and shear of the object's world matrix: M = Q L, Q the nearest rotation, det L of the sign of det M."""
    matrix = np.array(obj.matrix_world.to_3x3(), dtype=np.float64)
    _, stretch, v = np.linalg.svd(matrix)
    if not np.all(np.isfinite(stretch)) or stretch.min() <= 1e-9 * max(stretch.max(), 1e-30):
        raise RefusedError(f"{obj.name} is scaled to nothing along an axis; apply or reset its scale (Ctrl A)")
    if np.allclose(stretch, stretch[0], rtol=1e-5):
        # So that a rotation does not disturb a single bit of the shape.
        scale = 1.0 if abs(stretch[0] - 1.0) < 1e-5 else stretch[0]
        linear = scale * np.eye(3)
    else:
        linear = (v.T * stretch) @ v
    return linear * np.sign(np.linalg.det(matrix))


def get_array(collection: Any, key: str, dtype: Any, width: int = 1) -> Array:
    """All values of a collection: (n,) or (n, width)."""
    buffer = np.empty(len(collection) * width, dtype=dtype)
    collection.foreach_get(key, buffer)
    return buffer.reshape(-1, width) if width > 1 else buffer
