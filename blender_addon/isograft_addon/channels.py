# SPDX-License-Identifier: GPL-3.0-or-later
"""The donor's materials as channels to bake: per input of the Principled BSDF one image or constant per material."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from isograft import transfer
from isograft.color_spaces import luminance, to_linear, to_srgb

from . import bridge
from .bridge import Array, Input, RefusedError, Texture
from .pairing import Donor

_EXTENSION = {"REPEAT": "repeat", "EXTEND": "extend", "CLIP": "clip", "MIRROR": "repeat"}
_TILE_EDGE = 1e-4
"""UVs this far beyond a UDIM tile lie on its edge."""


@dataclass(frozen=True)
class BakedInput:
    """One input that gets an image."""

    shown: Input
    """How the new material shows it."""
    images: list[Any]
    """Per material an array (h, w, c), a constant (c,) or None; by the tile's number at first."""
    tiles: Array
    """(p,) number of the UDIM tile that a face lies in, 0 where its image has none."""
    space: str
    uv: Array
    """(l, 2) or (3 G, 2): every corner in the UV map and placement that its own material asks for."""
    extension: str
    interpolation: str
    constants: list[Input]
    """All inputs of the first material."""

    def kind_of_pixels(self) -> tuple[Any, int]:
        """Their type and how many components each has."""
        image = next(image for image in self.images if image is not None)
        return image.dtype, image.shape[-1]

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
    ways: dict[str, str]
    """Of the first material, as bridge.read_ways()."""
    warnings: list[str] = field(default_factory=list)

    def spread(self) -> None:
        """Make a material of its own of every tile, so that every input has one image per material."""
        keys = np.column_stack([self.polygon_slots, *(item.tiles for item in self.inputs)])
        rows, self.polygon_slots = np.unique(keys, axis=0, return_inverse=True)
        self.polygon_slots = self.polygon_slots.reshape(-1)
        self.inputs = [
            replace(item, images=[item.images[row[0]] and item.images[row[0]][row[k]] for row in rows.tolist()])
            for k, item in enumerate(self.inputs, 1)
        ]

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
    gift = Gift([], slots, render.name, render.values, bridge.read_ways(materials[used[0]]))
    for index, (_, left_out) in read_in.items():
        gift.warnings += [
            f"{obj.name}: {name} of the material {materials[index].name} comes from no image; it is left out"
            for name in left_out
        ]
    by_name = {index: {item.name: item for item in inputs} for index, (inputs, _) in read_in.items()}
    maps = {layer.name: layer.values for layer in layers} | {"": render.values}
    shown_by = slots, donor.arrays.loop_polygons
    first = used[0]
    constants = list(by_name[first].values())
    for name in by_name[first]:
        items = {index: inputs[name] for index, inputs in by_name.items() if name in inputs}
        if _is_baked(list(items.values())):
            _refuse_mixture(obj.name, name, items, gift.warnings)
            gift.inputs.append(_baked(obj.name, items, materials, maps, shown_by, constants, as_float, gift))
    gift.warnings += [
        f"{obj.name}: {name} of the material {materials[index].name} is left out; {materials[first].name} has no such "
        "input"
        for index, inputs in by_name.items()
        for name, item in inputs.items()
        if item.texture and name not in by_name[first]
    ]
    if not any(item.texture for inputs in by_name.values() for item in inputs.values()):
        raise RefusedError(f"{obj.name}: no material of it has an image; connect one to a Principled BSDF first")
    gift.spread()
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
    shown_by: tuple[Array, Array],
    constants: list[Input],
    as_float: bool,
    gift: Gift,
) -> BakedInput:
    textures = {index: item.texture for index, item in items.items() if item.texture is not None}
    shown = next((item for item in items.values() if item.texture is not None), next(iter(items.values())))
    pixels, uv, tiles = _read_textures(owner, shown, items, materials, maps, shown_by, gift)
    spaces = {"Non-Color" if t.component == 3 else bridge.color_space(t.image) for t in textures.values()}
    is_color = shown.kind == "color"
    out_of_range = any(not item.texture and not all(0 <= v <= 1 for v in item.value) for item in items.values())
    are_bytes = all(image.dtype == np.uint8 for read in pixels.values() for image in read.values())
    stays_byte = not as_float and are_bytes and len(spaces) <= 1
    stays_byte &= shown.kind in {"normal", "bump"} or not out_of_range
    if not textures:
        spaces = {"sRGB" if is_color else "Non-Color"}
    width = 1 if shown.kind in {"value", "bump"} else 3
    images: list[Any] = [None] * len(materials)
    for index, item in items.items():
        if item.texture is None:
            images[index] = {0: _constant(item, width, stays_byte, "sRGB" in spaces)}
        else:
            images[index] = {
                number: _values(read, item.texture, width, stays_byte) for number, read in pixels[index].items()
            }
    space = next(iter(spaces)) if stays_byte else ("" if is_color else "Non-Color")
    taken = shown.texture
    # A tile is read at what is left of the UVs beyond whole numbers.
    extension = _EXTENSION[taken.extension] if taken and not tiles.any() else "repeat"
    interpolation = "closest" if taken and taken.interpolation == "Closest" else "linear"
    return BakedInput(shown, images, tiles, space, uv, extension, interpolation, constants)


def _read_textures(
    owner: str,
    shown: Input,
    items: dict[int, Input],
    materials: list[Any],
    maps: dict[str, Array],
    shown_by: tuple[Array, Array],
    gift: Gift,
) -> tuple[dict[int, dict[int, Array]], Array, Array]:
    """Per material the images of its tiles by their numbers, 0 without tiles; BakedInput's `uv` (l, 2) and `tiles`.

    Args:
        shown_by: material of every polygon, and polygon of every loop.
    """
    slots, loop_polygons = shown_by
    uv, tiles = np.array(maps[""]), np.zeros(len(slots), dtype=np.int64)
    pixels: dict[int, dict[int, Array]] = {}
    for index, item in items.items():
        texture = item.texture
        if texture is None:
            continue
        where = f"{owner}, {shown.name} of the material {materials[index].name}"
        if texture.uv_map not in maps:
            raise RefusedError(
                f"{owner}: the material {materials[index].name} asks for a UV map called {texture.uv_map}, which is "
                "not there; make it, or choose another in the material"
            )
        if shown.kind == "normal":
            _refuse_turned(f"{owner}: {shown.name} of the material {materials[index].name}", item, gift.uv_name)
        mine = slots[loop_polygons] == index
        uv[mine] = maps[texture.uv_map][mine] @ texture.placement[:2, :2].T + texture.placement[:2, 2]
        if texture.image.source != "TILED":
            pixels[index] = {0: bridge.read_image(texture.image, where)}
            continue
        polygons = np.flatnonzero(slots == index)
        tiles[polygons], across = _tiles(uv, loop_polygons, len(slots), polygons)
        pixels[index] = bridge.read_tiles(texture.image, np.unique(tiles[polygons]).tolist(), where)
        if across:
            gift.warnings.append(
                f"{where}: {across:,} faces reach from one UDIM tile into another; each is read in that of its middle"
            )
    return pixels, uv, tiles


def _tiles(uv: Array, loop_polygons: Array, count: int, polygons: Array) -> tuple[Array, int]:
    """The UDIM tile under the middle of each of the polygons, -1 for none; how many of them reach beyond it."""
    size = np.maximum(np.bincount(loop_polygons, minlength=count), 1)
    middle = np.stack([np.bincount(loop_polygons, weights=uv[:, k], minlength=count) / size for k in range(2)], axis=1)
    low = np.floor(middle)
    beyond = (uv < low[loop_polygons] - _TILE_EDGE) | (uv > low[loop_polygons] + 1.0 + _TILE_EDGE)
    across = np.zeros(count, dtype=bool)
    across[loop_polygons[beyond.any(axis=1)]] = True
    inside = (low >= 0.0).all(axis=1) & (low[:, 0] < 10.0)
    number = np.where(inside, bridge.FIRST + low @ [1, 10], -1).astype(np.int64)
    return number[polygons], int(across[polygons].sum())


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
        chosen = luminance(pixels)
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
