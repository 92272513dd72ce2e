# SPDX-License-Identifier: GPL-3.0-or-later
"""The donor's materials as channels to bake: per input of the Principled BSDF one image or constant per material."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from isograft import transfer

from . import bridge
from .bridge import Array, Input, RefusedError, Texture
from .pairing import Donor

_EXTENSION = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "repeat"}
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


@dataclass(frozen=True)
class BakedInput:
    """One input that gets an image."""

    shown: Input
    """How the new material shows it."""
    images: list[Any]
    """Per material an array (h, w, c), a constant (c,) or None."""
    space: str
    uv: Array
    """(l, 2) or (3 G, 2): every corner in the UV map and placement that its own material asks for."""
    extension: str
    interpolation: str
    constants: list[Input]
    """All inputs of the first material."""

    def channel(self) -> Any:
        """For isograft.transfer.bake()."""
        kind = "normal" if self.shown.kind == "normal" else "color"
        return transfer.Channel(
            self.images, kind=kind, uv=self.uv, extension=self.extension, interpolation=self.interpolation
        )


@dataclass
class Gift:
    """What a donor has to bake."""

    inputs: list[BakedInput]
    polygon_slots: Array
    """(p,) index into the images of every input."""
    uv_name: str
    uv: Array
    """(l, 2), the rendered map."""
    warnings: list[str] = field(default_factory=list)

    def inputs_for(self, loops: Array) -> list[BakedInput]:
        """With UVs of the triangle corners `loops` (G, 3)."""
        return [replace(item, uv=item.uv[loops.ravel()]) for item in self.inputs]


def read(donor: Donor, as_float: bool) -> Gift:
    """Every image-textured input of the donor's materials, and those whose constants differ between materials.

    Raises:
        RefusedError: no material, no UV map, no image, or one that cannot be read.
    """
    obj = donor.obj
    materials = [slot.material for slot in obj.material_slots]
    with donor.mesh() as mesh:
        slots = np.clip(bridge.polygon_materials(mesh), 0, max(0, len(materials) - 1))
        layers = bridge.read_uv_layers(mesh)
    used = [index for index in np.unique(slots) if index < len(materials) and materials[index] is not None]
    if not used:
        raise RefusedError(f"{obj.name} has no material; give it one with an image first")
    if not layers:
        raise RefusedError(f"{obj.name} has no UV map that would place its images; unwrap it first")
    render = next((layer for layer in layers if layer.is_render), layers[0])
    read_in = {index: bridge.read_inputs(materials[index], obj.name) for index in used}
    gift = Gift([], slots, render.name, render.values)
    for index, (_, left_out) in read_in.items():
        gift.warnings += [
            f"{obj.name}: {name} of the material {materials[index].name} comes from no image; it is left out"
            for name in left_out
        ]
    by_name = {index: {item.name: item for item in inputs} for index, (inputs, _) in read_in.items()}
    maps = {layer.name: layer.values for layer in layers} | {"": render.values}
    loop_slots = slots[donor.arrays.loop_polygons]
    first = used[0]
    constants = list(by_name[first].values())
    for name in by_name[first]:
        items = {index: inputs[name] for index, inputs in by_name.items() if name in inputs}
        if _is_baked(list(items.values())):
            _refuse_mixture(obj.name, name, items, gift.warnings)
            gift.inputs.append(_baked(obj.name, items, materials, maps, loop_slots, constants, as_float, render.name))
    if not any(item.texture for inputs in by_name.values() for item in inputs.values()):
        raise RefusedError(f"{obj.name}: no material of it has an image; connect one to a Principled BSDF first")
    return gift


def _is_baked(items: list[Input]) -> bool:
    if any(item.texture for item in items):
        return True
    return items[0].kind in {"color", "value"} and len({item.value for item in items}) > 1


def _baked(
    owner: str,
    items: dict[int, Input],
    materials: list[Any],
    maps: dict[str, Array],
    loop_slots: Array,
    constants: list[Input],
    as_float: bool,
    render: str,
) -> BakedInput:
    textures = {index: item.texture for index, item in items.items() if item.texture is not None}
    shown = next((item for item in items.values() if item.texture is not None), next(iter(items.values())))
    pixels = {
        index: bridge.read_image(texture.image, f"{owner}, {shown.name} of the material {materials[index].name}")
        for index, texture in textures.items()
    }
    spaces = {"Non-Color" if t.component == 3 else bridge.color_space(t.image) for t in textures.values()}
    is_color = shown.kind == "color"
    out_of_range = any(not item.texture and not all(0 <= v <= 1 for v in item.value) for item in items.values())
    stays_byte = not as_float and not any(p.dtype != np.uint8 for p in pixels.values()) and len(spaces) <= 1
    stays_byte &= shown.kind in {"normal", "bump"} or not out_of_range
    if not textures:
        spaces = {"sRGB" if is_color else "Non-Color"}
    width = 1 if shown.kind in {"value", "bump"} else 3
    images: list[Any] = [None] * len(materials)
    uv = np.array(maps[""])
    for index, item in items.items():
        texture = textures.get(index)
        if texture is None:
            images[index] = _constant(item, width, stays_byte, "sRGB" in spaces)
            continue
        images[index] = _values(pixels[index], texture, width, stays_byte)
        if texture.uv_map not in maps:
            raise RefusedError(
                f"{owner}: the material {materials[index].name} asks for a UV map called {texture.uv_map}, which is "
                "not there; make it, or choose another in the material"
            )
        if shown.kind == "normal":
            _refuse_turned(f"{owner}: {shown.name} of the material {materials[index].name}", item, render)
        mine = loop_slots == index
        uv[mine] = maps[texture.uv_map][mine] @ texture.placement[:2, :2].T + texture.placement[:2, 2]
    space = next(iter(spaces)) if stays_byte else ("" if is_color else "Non-Color")
    texture = shown.texture
    extension = _EXTENSION[texture.extension] if texture else "repeat"
    interpolation = "closest" if texture and texture.interpolation == "Closest" else "linear"
    return BakedInput(shown, images, space, uv, extension, interpolation, constants)


def _refuse_turned(where: str, item: Input, render: str) -> None:
    """A normal map is read in the tangents of the UVs that place it."""
    texture = item.texture
    assert texture is not None
    if (item.tangent_map or render) != (texture.uv_map or render):
        raise RefusedError(
            f"{where} takes its tangents from the UV map {item.tangent_map or render} and its image from "
            f"{texture.uv_map or render}; choose the same in both nodes"
        )
    linear = texture.placement[:2, :2]
    if abs(linear[0, 1]) > 1e-6 or abs(linear[1, 0]) > 1e-6 or linear.diagonal().min() <= 0:
        raise RefusedError(
            f"{where} is turned or mirrored by a Mapping node, and its tangents are not; turn the UV map itself"
        )


def _values(pixels: Array, texture: Texture, width: int, stays_byte: bool) -> Array:
    """The colours that the input takes of an image: (h, w, width), uint8 or linear float32."""
    if not stays_byte and pixels.dtype == np.uint8:
        linear = pixels.astype(np.float32) / np.float32(255.0)
        if not bridge.is_data(texture.image):
            linear[..., :3] = to_linear(linear[..., :3])
        pixels = linear
    if texture.component is None:
        chosen = pixels[..., :3]
    elif texture.component < 0:
        grey = pixels[..., :3] @ _LUMINANCE
        chosen = (np.rint(grey) if pixels.dtype == np.uint8 else grey)[..., None].astype(pixels.dtype)
    else:
        chosen = pixels[..., texture.component : texture.component + 1]
    return np.ascontiguousarray(np.broadcast_to(chosen, (*pixels.shape[:2], width)))


def _constant(item: Input, width: int, stays_byte: bool, encoded: bool) -> Array | None:
    if item.kind == "normal":
        value = np.array([0.5, 0.5, 1.0])
    elif item.kind == "bump":
        value = np.zeros(1)
    else:
        value = np.asarray(item.value[:width], dtype=np.float64)
    if len(value) != width:
        value = np.resize(value, width)
    if not stays_byte:
        return value.astype(np.float32)
    shown = to_srgb(value) if encoded and item.kind in {"color", "value"} else value
    return np.rint(np.clip(shown, 0.0, 1.0) * 255.0).astype(np.uint8)


def _refuse_mixture(owner: str, name: str, items: dict[int, Input], warnings: list[str]) -> None:
    """One input of one new material has one way to show an image."""
    kinds = {item.kind for item in items.values() if item.texture is not None}
    if len(kinds) > 1:
        raise RefusedError(
            f"{owner}: {name} is a normal map in one material and a bump in another; make them alike first"
        )
    looks = {
        (item.strength, item.distance, item.is_inverted, item.texture.extension, item.texture.interpolation)
        for item in items.values()
        if item.texture is not None
    }
    if len(looks) > 1:
        warnings.append(f"{owner}: the materials differ in how {name} shows its image; the first one's way is taken")


def to_linear(encoded: Array) -> Array:
    """sRGB to linear."""
    result: Array = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return result.astype(encoded.dtype)


def to_srgb(linear: Array) -> Array:
    """Linear to sRGB."""
    linear = np.clip(linear, 0.0, None)
    result: Array = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    return result
