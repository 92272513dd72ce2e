# SPDX-License-Identifier: GPL-3.0-or-later
"""What reaches the inputs of a Principled material: constants, images, normal maps, bumps."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .meshes import Array, RefusedError

_COMPONENTS = {"Red": 0, "Green": 1, "Blue": 2, "R": 0, "G": 1, "B": 2}


@dataclass(frozen=True)
class Texture:
    """An image on its way into an input."""

    image: Any
    component: int | None
    """0 to 2 a colour, 3 alpha, None all of RGB."""
    uv_map: str
    """Empty: the one that is rendered."""
    extension: str
    interpolation: str
    placement: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) from homogeneous UVs to those that are looked up."""


@dataclass(frozen=True)
class Input:
    """One input of the Principled BSDF. Without `texture` it has the constant `value`."""

    name: str
    kind: str
    """`color`, `value`, `normal` or `bump`."""
    value: tuple[float, ...]
    texture: Texture | None = None
    strength: float = 1.0
    distance: float = 1.0
    is_inverted: bool = False


def principled(material: Any) -> Any:
    """The Principled BSDF at the material's output, or None."""
    if not material.use_nodes or material.node_tree is None:
        return None
    output = material.node_tree.get_output_node("ALL")
    socket = output.inputs["Surface"] if output is not None else None
    node = _source(socket)[0] if socket is not None else None
    return node if node is not None and node.type == "BSDF_PRINCIPLED" else None


def read_inputs(material: Any, owner: str) -> tuple[list[Input], list[str]]:
    """Every input of the material's Principled BSDF, and the names of those that no image but some node drives.

    Raises:
        RefusedError: the material cannot be baked as it is.
    """
    shader = principled(material)
    if shader is None:
        raise RefusedError(
            f"{owner}: the material {material.name} has no Principled BSDF at its output; connect one, "
            "or bake it to images with Cycles first"
        )
    inputs, left_out = [], []
    for socket in shader.inputs:
        # A socket that Blender keeps for itself is not found by its name.
        if socket.type not in {"RGBA", "VALUE", "VECTOR"} or socket.name not in shader.inputs:
            continue
        found = _read(socket, f"{owner}: {socket.name} of the material {material.name}")
        if found is not None:
            inputs.append(found)
        else:
            left_out.append(socket.name)
    return inputs, left_out


def _read(socket: Any, where: str) -> Input | None:
    """None if a node that is no image drives it."""
    value = tuple(socket.default_value) if hasattr(socket.default_value, "__len__") else (socket.default_value,)
    is_normal = socket.type == "VECTOR" and socket.name.endswith("Normal")
    kind = "normal" if is_normal else {"RGBA": "color", "VALUE": "value", "VECTOR": "vector"}[socket.type]
    node, output = _source(socket)
    if node is None:
        return Input(socket.name, kind, value)
    if is_normal and node.type == "NORMAL_MAP":
        if node.space != "TANGENT":
            raise RefusedError(f"{where} is a normal map that is not in tangent space; bake it to tangent space first")
        texture = _texture(node.inputs["Color"], where)
        _refuse_links(node.inputs["Strength"], where)
        return texture and Input(socket.name, kind, value, texture, node.inputs["Strength"].default_value)
    if is_normal and node.type == "BUMP":
        texture = _texture(node.inputs["Height"], where)
        for name in ("Strength", "Distance", "Normal"):
            _refuse_links(node.inputs[name], where)
        numbers = (node.inputs["Strength"].default_value, node.inputs["Distance"].default_value)
        return texture and Input(socket.name, "bump", value, texture, *numbers, node.invert)
    if node.type in {"RGB", "VALUE"}:
        constant = output.default_value
        return Input(socket.name, kind, tuple(constant) if hasattr(constant, "__len__") else (constant,))
    texture = _texture(socket, where)
    return texture and Input(socket.name, kind, value, texture)


def _texture(socket: Any, where: str) -> Texture | None:
    """The image at `socket`, directly or one colour of it; None if there is no image behind it."""
    node, output = _source(socket)
    component = None
    if node is not None and node.type in {"SEPRGB", "SEPARATE_COLOR"} and getattr(node, "mode", "RGB") == "RGB":
        component = _COMPONENTS[output.name]
        node, output = _source(node.inputs[0])
    if node is None or node.type != "TEX_IMAGE":
        image = _image_behind(node)
        if image is not None:
            raise RefusedError(
                f"{where}: the image {image.name} goes through the node {node.name}; connect the image itself, or "
                "bake the material to images with Cycles first"
            )
        return None
    if output.name == "Alpha":
        component = 3
    elif component is None and socket.type == "VALUE":
        component = -1
    if node.image is None:
        raise RefusedError(f"{where}: the node {node.name} has no image; choose one, or remove the node")
    if node.projection != "FLAT":
        raise RefusedError(f"{where}: the image {node.image.name} is not projected by a UV map; use Flat projection")
    uv_map, placement = _placed(node.inputs["Vector"], where)
    return Texture(node.image, component, uv_map, node.extension, node.interpolation, placement)


def _placed(socket: Any, where: str) -> tuple[str, Array]:
    """The UV map that leads to `socket`, and what is done to its UVs on the way."""
    node, output = _source(socket)
    if node is None:
        return "", np.eye(3)
    if node.type == "UVMAP":
        return node.uv_map, np.eye(3)
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY":
        return node.attribute_name, np.eye(3)
    if node.type == "TEX_COORD" and output.name == "UV":
        return "", np.eye(3)
    if node.type == "MAPPING" and node.vector_type == "POINT":
        move, turn, scale = (node.inputs[name] for name in ("Location", "Rotation", "Scale"))
        flat = not any(abs(turn.default_value[axis]) > 1e-6 for axis in (0, 1))
        if flat and not (move.is_linked or turn.is_linked or scale.is_linked):
            c, s = np.cos(turn.default_value[2]), np.sin(turn.default_value[2])
            (x, y), (u, v) = move.default_value[:2], scale.default_value[:2]
            name, before = _placed(node.inputs["Vector"], where)
            return name, np.array([[c * u, -s * v, x], [s * u, c * v, y], [0.0, 0.0, 1.0]]) @ before
    raise RefusedError(
        f"{where}: its image is placed by the node {node.name}, not by a UV map; place it by one, or bake the material "
        "to images with Cycles first"
    )


def _refuse_links(socket: Any, where: str) -> None:
    if socket.is_linked:
        raise RefusedError(f"{where}: {socket.name} of the node {socket.node.name} is driven; disconnect it first")


def _source(socket: Any) -> tuple[Any, Any]:
    """Node and output that feed an input, reroutes skipped; (None, None) if nothing does."""
    while socket is not None and socket.is_linked:
        link = socket.links[0]
        if link.from_node.type != "REROUTE":
            return link.from_node, link.from_socket
        socket = link.from_node.inputs[0]
    return None, None


def _image_behind(node: Any) -> Any:
    """Any image whose texture node leads into `node`."""
    ahead, seen = [node] if node is not None else [], set()
    while ahead:
        here = ahead.pop()
        if here.type == "TEX_IMAGE" and here.image is not None:
            return here.image
        if here.name not in seen:
            seen.add(here.name)
            ahead += [link.from_node for socket in here.inputs for link in socket.links]
    return None
