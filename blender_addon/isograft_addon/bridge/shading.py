# SPDX-License-Identifier: GPL-3.0-or-later
"""What reaches the inputs of a Principled material: constants, images, normal maps, bumps."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .meshes import Array, RefusedError

_ADVICE = "or bake the material to images with Cycles first"
_WAYS = ("distribution", "subsurface_method")
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
    tangent_map: str = ""
    """UV map of a normal map's tangents; empty: the one that is rendered."""


@dataclass(frozen=True)
class Plug:
    """An input of a node, in a tree that may be inside of node groups."""

    socket: Any
    groups: tuple[Any, ...] = ()
    """The group nodes that it lies in, the outermost first."""

    def of(self, name: str) -> "Plug":
        """Another input of the same node."""
        return Plug(self.socket.node.inputs[name], self.groups)

    def source(self) -> "Source":
        """What feeds it: through reroutes, muted nodes, and into and out of node groups."""
        socket, groups = self.socket, self.groups
        while socket.is_linked:
            link = socket.links[0]
            node, output = link.from_node, link.from_socket
            if node.type == "REROUTE":
                socket = node.inputs[0]
            elif node.mute:
                through = next((inner.from_socket for inner in node.internal_links if inner.to_socket == output), None)
                if through is None:
                    return Source(None, None, groups, socket)
                socket = through
            elif node.type == "GROUP" and node.node_tree is not None:
                inside = next(
                    (n for n in node.node_tree.nodes if n.type == "GROUP_OUTPUT" and n.is_active_output), None
                )
                if inside is None:
                    return Source(node, output, groups, socket)
                socket = next(s for s in inside.inputs if s.identifier == output.identifier)
                groups = (*groups, node)
            elif node.type == "GROUP_INPUT" and groups:
                socket = next(s for s in groups[-1].inputs if s.identifier == output.identifier)
                groups = groups[:-1]
            else:
                return Source(node, output, groups, socket)
        return Source(None, None, groups, socket)


@dataclass(frozen=True)
class Source:
    """A node and its output, None if nothing is connected: then the constant is that of `socket`."""

    node: Any
    output: Any
    groups: tuple[Any, ...]
    socket: Any

    def plug(self, name: Any) -> Plug:
        """An input of the node."""
        return Plug(self.node.inputs[name], self.groups)


def principled(material: Any) -> Source | None:
    """The Principled BSDF at the material's output, or None."""
    if not material.use_nodes or material.node_tree is None:
        return None
    output = material.node_tree.get_output_node("ALL")
    if output is None:
        return None
    source = Plug(output.inputs["Surface"]).source()
    return source if source.node is not None and source.node.type == "BSDF_PRINCIPLED" else None


def read_ways(material: Any) -> dict[str, str]:
    """The choices of the material's Principled BSDF that decide which inputs it shows."""
    shader = principled(material)
    assert shader is not None
    return {name: getattr(shader.node, name) for name in _WAYS if hasattr(shader.node, name)}


def read_inputs(material: Any, owner: str) -> tuple[list[Input], list[str]]:
    """Every input of the material's Principled BSDF, and the names of those that no image but some node drives.

    Raises:
        RefusedError: the material cannot be baked as it is.
    """
    shader = principled(material)
    if shader is None:
        raise RefusedError(
            f"{owner}: the material {material.name} has no Principled BSDF at its output; connect one, {_ADVICE}"
        )
    inputs, left_out = [], []
    for socket in shader.node.inputs:
        # A socket that Blender keeps for itself is not found by its name.
        if socket.type not in {"RGBA", "VALUE", "VECTOR"} or socket.name not in shader.node.inputs:
            continue
        found = _read(Plug(socket, shader.groups), f"{owner}: {socket.name} of the material {material.name}")
        if found is not None:
            inputs.append(found)
        else:
            left_out.append(socket.name)
    return inputs, left_out


def _read(plug: Plug, where: str) -> Input | None:
    """None if a node that is no image drives it."""
    name = plug.socket.name
    is_normal = plug.socket.type == "VECTOR" and name.endswith("Normal")
    kind = "normal" if is_normal else {"RGBA": "color", "VALUE": "value", "VECTOR": "vector"}[plug.socket.type]
    source = plug.source()
    value = _numbers(plug.socket)
    if hasattr(source.socket, "default_value"):
        value = _fitting(source.socket, len(value))
    node = source.node
    if node is None:
        return Input(name, kind, value)
    if is_normal and node.type == "NORMAL_MAP":
        if node.space != "TANGENT":
            raise RefusedError(f"{where} is a normal map that is not in tangent space; bake it to tangent space first")
        texture = _texture(source.plug("Color"), where)
        strength = _unlinked(source.plug("Strength"), where)
        return texture and Input(name, kind, value, texture, strength, tangent_map=node.uv_map)
    if is_normal and node.type == "BUMP":
        texture = _texture(source.plug("Height"), where)
        _unlinked(source.plug("Normal"), where)
        numbers = (_unlinked(source.plug("Strength"), where), _unlinked(source.plug("Distance"), where))
        return texture and Input(name, "bump", value, texture, *numbers, node.invert)
    if node.type in {"RGB", "VALUE"}:
        return Input(name, kind, _fitting(source.output, len(value)))
    texture = _texture(plug, where)
    return texture and Input(name, kind, value, texture)


def _numbers(socket: Any) -> tuple[float, ...]:
    value = socket.default_value
    return tuple(value) if hasattr(value, "__len__") else (value,)


def _fitting(socket: Any, width: int) -> tuple[float, ...]:
    """The socket's constant as an input of `width` numbers takes it: a grey of a number, the mean of a colour."""
    numbers = _numbers(socket)
    if len(numbers) == width:
        return numbers
    if width == 1:
        return (sum(numbers[:3]) / 3.0,)
    grown = numbers * 3 if len(numbers) == 1 else numbers[:3]
    return (*grown[:3], 1.0)[:width]


def _texture(plug: Plug, where: str) -> Texture | None:
    """The image at `plug`, directly or one colour of it; None if there is no image behind it."""
    source = plug.source()
    component = None
    parts = source.node is not None and source.node.type in {"SEPRGB", "SEPARATE_COLOR"}
    if parts and getattr(source.node, "mode", "RGB") == "RGB":
        component = _COMPONENTS[source.output.name]
        source = source.plug(0).source()
    node = source.node
    if node is None or node.type != "TEX_IMAGE":
        image = _image_behind(source)
        if image is not None:
            raise RefusedError(
                f"{where}: the image {image.name} goes through the node {node.name}; connect the image itself, "
                f"{_ADVICE}"
            )
        return None
    if source.output.name == "Alpha":
        component = 3
    elif component is None and plug.socket.type == "VALUE":
        component = -1
    if node.image is None:
        raise RefusedError(f"{where}: the node {node.name} has no image; choose one, or remove the node")
    if node.projection != "FLAT":
        raise RefusedError(f"{where}: the image {node.image.name} is not projected by a UV map; use Flat projection")
    uv_map, placement = _placed(source.plug("Vector"), where)
    return Texture(node.image, component, uv_map, node.extension, node.interpolation, placement)


def _placed(plug: Plug, where: str) -> tuple[str, Array]:
    """The UV map that leads to `plug`, and what is done to its UVs on the way."""
    source = plug.source()
    node = source.node
    if node is None:
        return "", np.eye(3)
    if node.type == "UVMAP":
        return node.uv_map, np.eye(3)
    if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY":
        return node.attribute_name, np.eye(3)
    if node.type == "TEX_COORD" and source.output.name == "UV":
        return "", np.eye(3)
    if node.type == "MAPPING" and node.vector_type == "POINT":
        ends = [source.plug(name).source() for name in ("Location", "Rotation", "Scale")]
        if all(end.node is None for end in ends):
            (x, y, _), (tilt, roll, angle), (u, v, _) = ((*_numbers(end.socket), 0.0, 0.0)[:3] for end in ends)
            if abs(tilt) < 1e-6 and abs(roll) < 1e-6:
                c, s = np.cos(angle), np.sin(angle)
                name, before = _placed(source.plug("Vector"), where)
                return name, np.array([[c * u, -s * v, x], [s * u, c * v, y], [0.0, 0.0, 1.0]]) @ before
    raise RefusedError(
        f"{where}: its image is placed by the node {node.name}, not by a UV map; place it by one, {_ADVICE}"
    )


def _unlinked(plug: Plug, where: str) -> Any:
    """The constant of an input that no node may drive; None where it has none of use."""
    source = plug.source()
    if source.node is not None:
        socket = plug.socket
        raise RefusedError(f"{where}: {socket.name} of the node {socket.node.name} is driven; disconnect it first")
    return _numbers(source.socket)[0] if hasattr(source.socket, "default_value") else None


def _image_behind(source: Source) -> Any:
    """Any image whose texture node leads into the source's node."""
    ahead, seen = [source], set()
    while ahead:
        here = ahead.pop()
        if here.node is None:
            continue
        if here.node.type == "TEX_IMAGE" and here.node.image is not None:
            return here.node.image
        key = (*(group.name for group in here.groups), here.node.name)
        if key not in seen:
            seen.add(key)
            ahead += [Plug(socket, here.groups).source() for socket in here.node.inputs if socket.is_linked]
    return None
