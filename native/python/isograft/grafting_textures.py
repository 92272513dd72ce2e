# SPDX-License-Identifier: GPL-3.0-or-later
"""A donor's materials as channels to bake: one image or constant per material for everything that an image shows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from isograft.color_spaces import luminance, to_srgb
from isograft.errors import InvalidInput
from isograft.formats.layers import MATERIAL
from isograft.formats.materials import Material, Numbers, Texture
from isograft.formats.mesh import MeshFile
from isograft.formats.tiles import is_tiled
from isograft.grafting_tiles import read_tiles, tiles_of
from isograft.transfer import Channel
from isograft.transfer.arrays import Array


class _Shown(NamedTuple):
    """What an image of a material shows."""

    word: str
    """Ends the name of the file."""
    number: str
    """The keyword of the number that it takes the place of; empty for none."""
    kind: str
    """color, value or normal; map_Bump is a normal map or a value by its looks."""
    default: Numbers
    """Of a material that says nothing."""


_SHOWN = {
    "map_Kd": _Shown("", "Kd", "color", (0.8, 0.8, 0.8)),
    "map_Ka": _Shown("ambient", "Ka", "color", (1.0, 1.0, 1.0)),
    "map_Ks": _Shown("specular", "Ks", "color", (0.5, 0.5, 0.5)),
    "map_Ke": _Shown("emission", "Ke", "color", (0.0, 0.0, 0.0)),
    "map_Ns": _Shown("shininess", "", "value", (1.0,)),
    "map_d": _Shown("opacity", "d", "value", (1.0,)),
    "map_Tr": _Shown("transparency", "Tr", "value", (0.0,)),
    "map_Pr": _Shown("roughness", "Pr", "value", (0.5,)),
    "map_Pm": _Shown("metallic", "Pm", "value", (0.0,)),
    "map_Ps": _Shown("sheen", "Ps", "value", (0.0,)),
    "map_Pc": _Shown("clearcoat", "Pc", "value", (0.0,)),
    "map_Pcr": _Shown("clearcoat_roughness", "Pcr", "value", (0.0,)),
    "norm": _Shown("normal", "", "normal", (0.5, 0.5, 1.0)),
    "map_Bump": _Shown("bump", "", "", (0.0,)),
    "disp": _Shown("displacement", "", "value", (0.0,)),
}


@dataclass(frozen=True, eq=False)
class TextureChannel:
    """One of the images that are baked."""

    keyword: str
    channel: Channel
    #: How the new material shows it.
    strength: float = 1.0
    is_clamped: bool = False

    @property
    def word(self) -> str:
        """Ends the name of its file; empty for the colour."""
        return _SHOWN[self.keyword].word


class _Painted(NamedTuple):
    """A channel whose images are by material, and by tile where they have some."""

    keyword: str
    #: Per material, the last one that of faces without, by the tile's number; 0 for images without tiles.
    images: list[dict[int, Any]]
    #: (G,) the tile that every triangle is read in, 0 where its image has none.
    tiles: Array
    kind: Literal["color", "normal"]
    uv: Array
    strength: float
    is_clamped: bool


@dataclass(eq=False)
class Textures:
    """What a donor has to bake."""

    channels: list[TextureChannel]
    #: (G,) index into the images of every channel: a material, or one tile of it.
    triangle_materials: Array
    #: Of the new material, whose images need none: those of the first material that is used.
    numbers: dict[str, Numbers] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def one_texture(donor: MeshFile, path: Path, read: Callable[[Path], Array]) -> Textures:
    """A single image, or its tiles, the colour of all of the donor.

    Raises:
        InvalidInput: a tile is missing.
    """
    material = Material({"Kd": (1.0, 1.0, 1.0)}, {"map_Kd": Texture(path)})
    result = Textures([], np.zeros(len(donor.faces), np.int32), dict(material.numbers))
    _spread(result, [_painted(donor, [""], [material], result.triangle_materials, "map_Kd", read, result.warnings)])
    return result


def used_materials(donor: MeshFile) -> set[str] | None:
    """Names of the materials that the donor's faces say they have; None if they say nothing."""
    names = _of_polygons(donor)
    return None if names is None else set(names.tolist())


def material_textures(donor: MeshFile, library: dict[str, Material], read: Callable[[Path], Array]) -> Textures:
    """Everything that an image of the donor's materials shows, and numbers that differ between these.

    `read` opens an image: (height, width, components), uint8 or float32.

    Raises:
        InvalidInput: the donor's faces have no material or one that `library` lacks, no material has an image, a tile
            is missing, or they cannot be baked together; names the donor.
    """
    names, of_polygon = _used(donor, library)
    materials = [library[name] for name in names]
    if not any(material.textures for material in materials):
        raise InvalidInput(f"{donor.path}: the donor's materials name no image; give --texture")
    triangle_materials = of_polygon[donor.triangle_polygon]
    result = Textures([], triangle_materials, dict(materials[0].numbers))
    for name, material in zip(names, materials, strict=True):
        if material.left_out:
            text = f"{', '.join(material.left_out)} of the material {name} cannot be baked and is left out"
            result.warnings.append(f"{donor.path}: {text}")
    painted = []
    for keyword, shown in _SHOWN.items():
        if any(keyword in material.textures for material in materials) or _differ(materials, shown):
            painted.append(_painted(donor, names, materials, triangle_materials, keyword, read, result.warnings))
            if shown.number:
                result.numbers[shown.number] = (1.0,) * len(shown.default)
    _spread(result, painted)
    return result


def _spread(textures: Textures, painted: list[_Painted]) -> None:
    """Make a material of its own of every tile, so that every channel has one image per material."""
    keys = np.column_stack([textures.triangle_materials, *(item.tiles for item in painted)])
    rows, index = np.unique(keys, axis=0, return_inverse=True)
    textures.triangle_materials = index.reshape(-1).astype(np.int32)
    for k, item in enumerate(painted, 1):
        images = [item.images[row[0]].get(row[k]) for row in rows.tolist()]
        has_tiles = bool((item.tiles != 0).any())
        extension: Literal["repeat", "extend"] = "extend" if item.is_clamped and not has_tiles else "repeat"
        channel = Channel(images, kind=item.kind, uv=item.uv, extension=extension)
        textures.channels.append(TextureChannel(item.keyword, channel, item.strength, item.is_clamped))


def _used(donor: MeshFile, library: dict[str, Material]) -> tuple[list[str], Array]:
    """Names of the materials that faces have, and per polygon the number of its own; one more stands for none."""
    given = _of_polygons(donor)
    if given is None:
        if len(library) != 1:
            raise InvalidInput(
                f"{donor.path}: the donor's libraries have {len(library)} materials and its faces use none (usemtl); "
                "give --texture"
            )
        return list(library), np.zeros(len(donor.polygons.sizes), np.int32)
    found, index = np.unique(given, return_inverse=True)
    names = [name for name in found.tolist() if name in library]
    unknown = [name for name in found.tolist() if name and name not in library]
    if unknown:
        raise InvalidInput(
            f"{donor.path}: the donor's faces use the material {unknown[0]}, which its libraries (mtllib) do not have; "
            "give --texture"
        )
    number = np.array([names.index(name) if name in library else len(names) for name in found.tolist()], np.int32)
    return names, number[index.reshape(-1)]


def _of_polygons(donor: MeshFile) -> Array | None:
    names = donor.layers.face.get(MATERIAL)
    return None if names is None or names.dtype.kind != "U" or names.ndim != 1 else names


def _differ(materials: Sequence[Material], shown: _Shown) -> bool:
    """Whether a number that an image can show is not the same in all materials."""
    return bool(shown.number) and len({m.numbers.get(shown.number, shown.default) for m in materials}) > 1


def _painted(
    donor: MeshFile,
    names: list[str],
    materials: list[Material],
    triangle_materials: Array,
    keyword: str,
    read: Callable[[Path], Array],
    warnings: list[str],
) -> _Painted:
    textures = {i: m.textures[keyword] for i, m in enumerate(materials) if keyword in m.textures}
    uv, tiles, pixels = _read(donor, names, textures, triangle_materials, keyword, read, warnings)
    every = [image for read_in in pixels.values() for image in read_in.values()]
    shown, kind = _SHOWN[keyword], _SHOWN[keyword].kind or _kind_of_bump(donor, every)
    if len({(t.is_clamped, t.strength) for t in textures.values()}) > 1:
        warnings.append(f"{donor.path}: the materials differ in how {keyword} shows its image; the first is followed")
    whole = {
        i: {number: _components(image, texture, keyword, kind) for number, image in pixels[i].items()}
        for i, texture in textures.items()
    }
    every = [image for images in whole.values() for image in images.values()]
    width = {"value": 1, "normal": 3}.get(kind) or max((image.shape[2] for image in every), default=3)
    in_bytes = all(image.dtype == np.uint8 for image in every)
    images: list[dict[int, Any]] = [{} for _ in range(len(materials) + 1)]
    for i, material in enumerate(materials):
        if i in textures:
            images[i] = {number: _widened(image, width, in_bytes) for number, image in whole[i].items()}
            if kind == "normal" and min(textures[i].scale) <= 0.0:
                raise InvalidInput(
                    f"{donor.path}: {keyword} of the material {names[i]} is mirrored by -s, and its tangents are not; "
                    "mirror the texture coordinates themselves"
                )
            continue
        default = (0.5, 0.5, 1.0) if kind == "normal" else shown.default
        number = material.numbers.get(shown.number, default) if shown.number else default
        if not all(0.0 <= value <= 1.0 for value in number):
            text = f"{shown.number} of the material {names[i]} is not between 0 and 1, and is painted as if it were"
            warnings.append(f"{donor.path}: {text}")
        images[i] = {0: _constant(np.resize(number, 3 if kind == "color" else width), kind, width, in_bytes)}
    first = next(iter(textures.values()), None)
    is_clamped, strength = (False, 1.0) if first is None else (first.is_clamped, first.strength)
    return _Painted(keyword, images, tiles, "normal" if kind == "normal" else "color", uv, strength, is_clamped)


def _read(
    donor: MeshFile,
    names: list[str],
    textures: dict[int, Texture],
    triangle_materials: Array,
    keyword: str,
    read: Callable[[Path], Array],
    warnings: list[str],
) -> tuple[Array, Array, dict[int, dict[int, Array]]]:
    """The UVs (G, 3, 2) that place the images, the tile of every triangle, and the images as of _Painted."""
    assert donor.triangle_uvs is not None
    uv, tiles = donor.triangle_uvs, np.zeros(len(triangle_materials), np.int64)
    pixels: dict[int, dict[int, Array]] = {}
    for i, texture in textures.items():
        mine = triangle_materials == i
        if (texture.scale, texture.offset) != ((1.0, 1.0), (0.0, 0.0)):
            uv = np.where(mine[:, None, None], uv * texture.scale + np.array(texture.offset), uv)
        if not is_tiled(texture.path):
            pixels[i] = {0: read(texture.path)}
            continue
        where = f"{donor.path}: {keyword} of the material {names[i]}" if names[i] else f"{donor.path}: its image"
        numbers, across = tiles_of(uv, donor.triangle_polygon, mine)
        pixels[i] = read_tiles(texture.path, numbers, where, read)
        tiles = np.where(mine, numbers, tiles)
        if across:
            text = f"{across:,} faces reach from one UDIM tile into another; each is read in that of its middle"
            warnings.append(f"{where}: {text}")
    return uv, tiles, pixels


def _kind_of_bump(donor: MeshFile, images: list[Array]) -> str:
    """Files call both a grey image of heights and a coloured normal map map_Bump."""
    kinds = {"normal" if _is_coloured(image) else "value" for image in images}
    if len(kinds) > 1:
        raise InvalidInput(
            f"{donor.path}: map_Bump is a normal map in one of the donor's materials and a grey image of heights in "
            "another; make them alike first"
        )
    return kinds.pop()


def _is_coloured(pixels: Array) -> bool:
    return pixels.shape[2] >= 3 and bool((pixels[..., :1] != pixels[..., 1:3]).any())


def _components(pixels: Array, texture: Texture, keyword: str, kind: str) -> Array:
    """(height, width, components): those that the channel takes of an image."""
    count = pixels.shape[2]
    if kind == "normal":
        if count < 3:
            raise InvalidInput(f"{texture.path}: the image of {keyword} is grey, and a normal map has three components")
        return pixels[..., :3]
    component = texture.component
    if not component and kind == "value" and keyword == "map_d" and count in (2, 4):
        component = "m"
    if component == "m":
        if count in (1, 3):
            raise InvalidInput(f"{texture.path}: the image of {keyword} has no alpha, which -imfchan m asks for")
        return pixels[..., -1:]
    if component in ("r", "g", "b"):
        return pixels[..., [min("rgb".index(component), count - 1 if count > 2 else 0)]]
    if kind == "value" or component == "l":
        return _grey(pixels)
    return pixels if count != 2 else pixels[..., [0, 0, 0, 1]]


def _grey(pixels: Array) -> Array:
    """Luminance, or the one component that there is."""
    return luminance(pixels) if _is_coloured(pixels) else pixels[..., :1]


def _widened(pixels: Array, width: int, in_bytes: bool) -> Array:
    """With `width` components: grey is repeated, alpha is full where there is none."""
    if not in_bytes and pixels.dtype == np.uint8:
        pixels = pixels.astype(np.float32) / np.float32(255)
    if pixels.shape[2] == 1 and width > 1:
        pixels = np.repeat(pixels, 3, axis=2)
    if pixels.shape[2] < width:
        full = np.full((*pixels.shape[:2], 1), 255 if in_bytes else 1, pixels.dtype)
        pixels = np.concatenate([pixels, full], axis=2)
    return np.ascontiguousarray(pixels)


def _constant(number: Array, kind: str, width: int, in_bytes: bool) -> Array:
    """A number as an image's pixel: colours as sRGB, which images of colours are in."""
    value = np.clip(np.asarray(number, np.float64), 0.0, 1.0)
    if kind == "color":
        value = to_srgb(value)
    value = np.concatenate([value, np.ones(max(0, width - len(value)))])[:width]
    pixel: Array = np.rint(255 * value).astype(np.uint8) if in_bytes else value.astype(np.float32)
    return pixel
