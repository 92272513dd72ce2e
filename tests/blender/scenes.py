# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects to test with, and ways to look at them."""

from typing import Any

import bpy
import numpy as np
import shapes

Array = np.ndarray[Any, Any]

QUICK = {"preset": "fast", "scale": "FIXED"}
"""Settings of a match whose accuracy is not what is tested."""

CUT = -0.55
"""Height over the sphere of directions below which the receiver is cut away."""


def add_mesh(name: str, vertices: Array, faces: Any) -> Any:
    """A mesh object in the scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.asarray(vertices).tolist(), [], [list(map(int, face)) for face in faces])
    mesh.update()
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.collection.objects.link(obj)
    return obj


def add_uv(obj: Any, name: str, uv: Array) -> None:
    """A UV map from (l, 2)."""
    obj.data.uv_layers.new(name=name).data.foreach_set("uv", np.asarray(uv, dtype=np.float32).ravel())


def add_color(obj: Any, name: str, data_type: str, domain: str, values: Array) -> None:
    """A colour attribute from (n, 4) or (l, 4)."""
    obj.data.color_attributes.new(name, data_type, domain)
    obj.data.color_attributes[name].data.foreach_set("color", np.asarray(values, dtype=np.float32).ravel())


def values(obj: Any, name: str, key: str, width: int = 1) -> Array:
    """An attribute's values."""
    data = obj.data.attributes[name].data
    buffer = np.empty(len(data) * width, dtype=np.int32 if obj.data.attributes[name].data_type == "INT" else np.float32)
    data.foreach_get(key, buffer)
    return buffer.reshape(-1, width) if width > 1 else buffer


def uvs(obj: Any, name: str) -> Array:
    """A UV map's values (l, 2)."""
    data = obj.data.uv_layers[name].data
    buffer = np.empty(2 * len(data), dtype=np.float32)
    data.foreach_get("uv", buffer)
    return buffer.reshape(-1, 2)


def select(donor: Any, *receivers: Any) -> None:
    """Make `donor` active and select it with the receivers, nothing else."""
    # Objects that were linked just now can be selected only after this.
    bpy.context.view_layer.update()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj == donor or obj in receivers)
    bpy.context.view_layer.objects.active = donor
    bpy.context.view_layer.update()


def snapshot(obj: Any) -> dict[str, Any]:
    """Everything of an object that an operator of ours could change."""
    mesh = obj.data
    coordinates = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", coordinates)
    return {
        "co": coordinates.tobytes(),
        "faces": [tuple(polygon.vertices) for polygon in mesh.polygons],
        "materials": [(m.name if m else None) for m in mesh.materials],
        "material_index": [polygon.material_index for polygon in mesh.polygons],
        "attributes": sorted((a.name, a.data_type, a.domain) for a in mesh.attributes),
        "uv": {layer.name: uvs(obj, layer.name).tobytes() for layer in mesh.uv_layers},
        "groups": [(group.name, group.lock_weight) for group in obj.vertex_groups],
        "weights": [[(g.group, g.weight) for g in vertex.groups] for vertex in mesh.vertices],
        "keys": keys(mesh),
        "modifiers": [(item.name, item.type) for item in obj.modifiers],
        "seams": [edge.use_seam for edge in mesh.edges],
        "properties": sorted(obj.keys()),
        "matrix": [tuple(row) for row in obj.matrix_world],
        "users": mesh.users,
    }


def filled_around(obj: Any, unmatched: Array) -> Array:
    """(n,) vertices that filling marks: those without a match (n,), and those that no triangle with three matches
    touches, at which faces and corners are filled."""
    mesh = obj.data
    mesh.calc_loop_triangles()
    triangles = np.array([tuple(triangle.vertices) for triangle in mesh.loop_triangles])
    touched = np.zeros(len(unmatched), dtype=bool)
    touched[triangles[~unmatched[triangles].any(axis=1)]] = True
    return ~touched


def keys(mesh: Any) -> list[Any]:
    """Every shape key of a mesh."""
    if mesh.shape_keys is None:
        return []
    result = []
    for block in mesh.shape_keys.key_blocks:
        points = np.empty(3 * len(block.data), dtype=np.float32)
        block.data.foreach_get("co", points)
        result.append((block.name, block.value, block.mute, block.relative_key.name, points.tobytes()))
    return result


def receiver_shape() -> tuple[Array, Array]:
    """Directions and quads of the receiver: the quad sphere without its lowest part."""
    directions, quads = shapes.quad_sphere()
    quads = quads[(directions[:, 2] >= CUT)[quads].all(axis=1)]
    used, compact = np.unique(quads, return_inverse=True)
    return directions[used], compact.reshape(quads.shape)


class Pair:
    """A donor and a receiver of the same creature: another tessellation, another pose, cut open below."""

    def __init__(self) -> None:
        self.donor_directions, donor_faces = shapes.triangle_sphere()
        self.directions, quads = receiver_shape()
        self.truth = shapes.surface_points(self.directions)
        self.donor = add_mesh("Donor", shapes.surface_points(self.donor_directions), donor_faces)
        self.receiver = add_mesh("Scan", shapes.pose(self.truth), quads)
        corners = self.donor_directions[donor_faces]
        uv, _ = shapes.cube_uv(corners)
        add_uv(self.donor, "Atlas", uv.reshape(-1, 2))
        add_color(self.donor, "Paint", "FLOAT_COLOR", "POINT", shapes.point_color(self.donor_directions))
        add_color(self.donor, "Corners", "BYTE_COLOR", "CORNER", shapes.point_color(corners).reshape(-1, 4))
        select(self.donor, self.receiver)


class MatchedPair:
    """The Pair of the file, as it was matched."""

    def __init__(self) -> None:
        self.donor = bpy.data.objects["Donor"]
        self.receiver = bpy.data.objects["Scan"]
        self.directions, _ = receiver_shape()
        self.truth = shapes.surface_points(self.directions)
