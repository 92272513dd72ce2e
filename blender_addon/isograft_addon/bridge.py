# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender meshes <-> numpy arrays: the only user of foreach_get and foreach_set.

Reading never changes an object. Writing only happens in the write_... functions, which expect arrays that are ready.
"""

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
class CornerLayer:
    """Named values of a mesh: a UV map (loops by 2) or a colour attribute (vertices or loops by 4)."""

    name: str
    domain: str
    data_type: str
    values: Array
    is_render: bool = False


@dataclass(frozen=True)
class MeshArrays:
    """A mesh as arrays, in its object's space. n vertices, l loops, k loop triangles, p polygons."""

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
    linear: Array
    """(3, 3), the object's scale and shear, rotation taken out."""
    warnings: list[str] = field(default_factory=list)

    @property
    def is_mirrored(self) -> bool:
        """True if the object's scale turns the surface inside out."""
        return bool(np.linalg.det(self.linear) < 0)

    def surface(self) -> tuple[Array, Array]:
        """Vertices and triangles as they look in the scene, up to position and rotation, wound outward."""
        triangles = self.triangles[:, [0, 2, 1]] if self.is_mirrored else self.triangles
        return self.vertices @ self.linear.T, np.ascontiguousarray(triangles)

    def in_loop_order(self, barycentric: Array) -> Array:
        """Weights of surface()'s triangles as weights of the loop triangles' corners."""
        return np.ascontiguousarray(barycentric[:, [0, 2, 1]]) if self.is_mirrored else barycentric

    @cached_property
    def content_hash(self) -> str:
        """Changes with any vertex position and any face; not with the object's transform or the mesh's attributes."""
        digest = hashlib.sha256()
        for array, dtype in ((self.vertices, "<f4"), (self.triangles, "<i4"), (self.triangle_loops, "<i4")):
            digest.update(np.int64(array.shape).tobytes())
            digest.update(np.ascontiguousarray(array, dtype=dtype).tobytes())
        return digest.hexdigest()


def read_donor(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> MeshArrays:
    """The evaluated mesh: modifiers and shape keys applied.

    Raises:
        RefusedError: no faces, or a scale of zero.
    """
    with _Evaluated(obj, depsgraph) as mesh:
        return _read(obj, mesh, mesh, [])


def read_receiver(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> MeshArrays:
    """The faces of the object's own mesh; its vertices evaluated while modifiers keep their number.

    Raises:
        RefusedError: no faces, a scale of zero, or a mesh that may not be written.
    """
    refuse_unwritable(obj)
    with _Evaluated(obj, depsgraph) as mesh:
        if len(mesh.vertices) == len(obj.data.vertices):
            return _read(obj, obj.data, mesh, [])
    warning = f"{obj.name}: its modifiers change the number of vertices; the mesh without modifiers is used"
    return _read(obj, obj.data, obj.data, [warning])


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


def read_uv_layers(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[CornerLayer]:
    """The UV maps of the evaluated mesh, values (l, 2)."""
    with _Evaluated(obj, depsgraph) as mesh:
        return [
            CornerLayer(
                layer.name, "CORNER", "UV", _get(layer.data, "uv", np.float32, 2).astype(float), layer.active_render
            )
            for layer in mesh.uv_layers
        ]


def read_colors(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[CornerLayer]:
    """The colour attributes of the evaluated mesh, linear RGBA, values (n, 4) or (l, 4) by domain."""
    with _Evaluated(obj, depsgraph) as mesh:
        # Of the object's own mesh where it has colours: choosing another one does not evaluate the mesh again.
        choice = obj.data.color_attributes if len(obj.data.color_attributes) else mesh.color_attributes
        index = choice.render_color_index
        render = choice[index].name if 0 <= index < len(choice) else ""
        return [
            CornerLayer(
                layer.name,
                layer.domain,
                layer.data_type,
                _get(layer.data, "color", np.float32, 4).astype(float),
                layer.name == render,
            )
            for layer in mesh.color_attributes
        ]


def read_polygon_materials(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Array:
    """(p,) int32, material slot of every polygon of the evaluated mesh."""
    with _Evaluated(obj, depsgraph) as mesh:
        return _get(mesh.polygons, "material_index", np.int32)


def read_own_polygon_materials(obj: bpy.types.Object) -> Array:
    """(p,) int32, material slot of every polygon of the object's own mesh."""
    return _get(obj.data.polygons, "material_index", np.int32)


def read_attribute(obj: bpy.types.Object, name: str, data_type: str) -> Array | None:
    """The values of a point attribute of the object's own mesh; None if there is none of that type and size."""
    attribute = obj.data.attributes.get(name)
    if attribute is None or (attribute.data_type, attribute.domain) != (data_type, "POINT"):
        return None
    key, dtype, width = _STORAGE[data_type]
    return _get(attribute.data, key, dtype, width)


def write_attribute(obj: bpy.types.Object, name: str, domain: str, data_type: str, values: Array) -> None:
    """Write an attribute, in place of one of the same name."""
    attributes = obj.data.attributes
    old = attributes.get(name)
    if old is not None and (old.data_type, old.domain) != (data_type, domain):
        attributes.remove(old)
        old = None
    key, dtype, _ = _STORAGE[data_type]
    attribute = old or attributes.new(name, data_type, domain)
    attribute.data.foreach_set(key, np.ascontiguousarray(values, dtype=dtype).ravel())


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


def activate_color(obj: bpy.types.Object, name: str) -> None:
    """Make a colour attribute the one that is shown and rendered."""
    colors = obj.data.color_attributes
    colors.active_color_index = colors.render_color_index = colors.find(name)


def write_polygon_materials(obj: bpy.types.Object, slots: list[Any], index: Array) -> None:
    """Append to the mesh's material slots those of `slots` beyond its own, and give every polygon its slot."""
    mesh = obj.data
    for material in slots[len(mesh.materials) :]:
        mesh.materials.append(material)
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(index, dtype=np.int32))


def write_property(obj: bpy.types.Object, content: dict[str, Any]) -> None:
    """Write the id property that read_property reads."""
    obj[PROPERTY] = content
    obj.data.update()
    obj.update_tag()


def read_property(obj: bpy.types.Object) -> dict[str, Any] | None:
    """What write_property wrote, or None."""
    content = obj.get(PROPERTY)
    return content.to_dict() if hasattr(content, "to_dict") else None


_STORAGE: dict[str, tuple[str, Any, int]] = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
}


class _Evaluated:
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
    sizes = _get(faces.polygons, "loop_total", np.int32)
    starts = _get(faces.polygons, "loop_start", np.int32)
    # Polygons need not lie in the order of their loops.
    order = np.argsort(starts, kind="stable")
    loop_polygons = np.repeat(order, sizes[order]).astype(np.int32)
    return MeshArrays(
        vertices=_positions(positions),
        triangles=_get(faces.loop_triangles, "vertices", np.int32, 3),
        triangle_loops=_get(faces.loop_triangles, "loops", np.int32, 3),
        triangle_polygons=_get(faces.loop_triangles, "polygon_index", np.int32),
        loop_polygons=loop_polygons,
        linear=_linear_part(obj),
        warnings=warnings,
    )


def _positions(mesh: bpy.types.Mesh) -> Array:
    position = mesh.attributes.get("position")
    if position is not None and position.data_type == "FLOAT_VECTOR" and len(position.data) == len(mesh.vertices):
        return _get(position.data, "vector", np.float32, 3).astype(np.float64)
    return _get(mesh.vertices, "co", np.float32, 3).astype(np.float64)


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


def _get(collection: Any, key: str, dtype: Any, width: int = 1) -> Array:
    buffer = np.empty(len(collection) * width, dtype=dtype)
    collection.foreach_get(key, buffer)
    return buffer.reshape(-1, width) if width > 1 else buffer
