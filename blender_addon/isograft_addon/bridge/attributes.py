# SPDX-License-Identifier: GPL-3.0-or-later
"""Generic attributes of any type and domain."""

from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np

from .meshes import Array, get_array


@dataclass(frozen=True)
class AttributeLayer:
    """Named values of a mesh, one row per element of the domain."""

    name: str
    domain: str
    data_type: str
    values: Array


_STORAGE: dict[str, tuple[str, Any, int]] = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int32, 1),
    "BOOLEAN": ("value", bool, 1),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
    "INT32_2D": ("value", np.int32, 2),
    "INT16_2D": ("value", np.int32, 2),
    "QUATERNION": ("value", np.float32, 4),
    "FLOAT4X4": ("value", np.float32, 16),
    "STRING": ("value", object, 1),
}

_OWN_CARRIERS = {"position", "material_index", "sharp_face", "custom_normal", "id"}
"""Built-in attributes that are no user's data; what they hold has kinds of its own or follows from the shape."""

SEAMS = "uv_seam"
"""The name that the seam marks of edges go by; Blender hides theirs behind a property in all versions."""

_EDGE_PROPERTIES = {
    "crease_edge": ("crease", "FLOAT"),
    "bevel_weight_edge": ("bevel_weight", "FLOAT"),
    "sharp_edge": ("use_edge_sharp", "BOOLEAN"),
    SEAMS: ("use_seam", "BOOLEAN"),
}
"""Values that edges have as properties in some versions of Blender, by the names of the attributes of others."""


def _edge_properties() -> dict[str, tuple[str, str]]:
    """Those that are properties in this Blender."""
    known = bpy.types.MeshEdge.bl_rna.properties
    return {name: item for name, item in _EDGE_PROPERTIES.items() if item[0] in known}


def _read_edge_properties(mesh: bpy.types.Mesh) -> list[AttributeLayer]:
    """Of edges some of which have more than the default of 0."""
    layers = [
        AttributeLayer(name, "EDGE", kind, get_array(mesh.edges, key, _STORAGE[kind][1]))
        for name, (key, kind) in _edge_properties().items()
    ]
    return [layer for layer in layers if layer.values.any()]


def attribute_names(mesh: bpy.types.Mesh) -> set[str]:
    """Names that are taken on a mesh: those of its attributes, and of the properties in use that stand for some."""
    return {layer.name for layer in (*mesh.attributes, *_read_edge_properties(mesh))}


def read_attributes(mesh: bpy.types.Mesh) -> list[AttributeLayer]:
    """The user's attributes: neither colours nor UV maps, nothing that Blender or this add-on keeps for itself."""
    taken = {layer.name for layer in mesh.uv_layers} | {layer.name for layer in mesh.color_attributes}
    taken |= _OWN_CARRIERS | set(_edge_properties())
    layers = [
        AttributeLayer(layer.name, layer.domain, layer.data_type, _values(layer))
        for layer in mesh.attributes
        if layer.name not in taken and not layer.name.startswith((".", "isograft_")) and layer.data_type in _STORAGE
    ]
    return layers + _read_edge_properties(mesh)


def read_attribute(obj: bpy.types.Object, name: str, data_type: str) -> Array | None:
    """The values of a point attribute of the object's own mesh; None if there is none of that type."""
    return read_layer(obj.data, name, "POINT", data_type)


def read_layer(mesh: bpy.types.Mesh, name: str, domain: str, data_type: str) -> Array | None:
    """The values of one attribute, Blender's hidden ones too; None if there is none of that domain and type."""
    in_edges = _edge_properties().get(name)
    if in_edges is not None and (domain, data_type) == ("EDGE", in_edges[1]):
        return get_array(mesh.edges, in_edges[0], _STORAGE[data_type][1])
    attribute = mesh.attributes.get(name)
    if attribute is None or (attribute.data_type, attribute.domain) != (data_type, domain):
        return None
    return _values(attribute)


def write_attribute(obj: bpy.types.Object, name: str, domain: str, data_type: str, values: Array) -> None:
    """Write an attribute, in place of one of the same name."""
    in_edges = _edge_properties().get(name)
    if in_edges is not None and (domain, data_type) == ("EDGE", in_edges[1]):
        obj.data.edges.foreach_set(in_edges[0], np.ascontiguousarray(values, dtype=_STORAGE[data_type][1]))
        return
    attributes = obj.data.attributes
    old = attributes.get(name)
    if old is not None and (old.data_type, old.domain) != (data_type, domain):
        attributes.remove(old)
        old = None
    key, dtype, _ = _STORAGE[data_type]
    attribute = old or attributes.new(name, data_type, domain)
    if data_type == "STRING":
        # Bytes from Blender 4.1 on, text before.
        as_bytes = len(attribute.data) and isinstance(attribute.data[0].value, bytes)
        for element, value in zip(attribute.data, values, strict=True):
            element.value = str(value).encode() if as_bytes else str(value)
    else:
        attribute.data.foreach_set(key, np.ascontiguousarray(values, dtype=dtype).ravel())


def _values(attribute: bpy.types.Attribute) -> Array:
    key, dtype, width = _STORAGE[attribute.data_type]
    if attribute.data_type == "STRING":
        words = [element.value for element in attribute.data]
        return np.array([word.decode() if isinstance(word, bytes) else word for word in words], dtype=object)
    return get_array(attribute.data, key, dtype, width)
