# SPDX-License-Identifier: GPL-3.0-or-later
"""The images of `isograft transfer`: which are read, where the baked ones go, and the material that shows them."""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from isograft.cli_outcome import BadInput
from isograft.errors import InvalidInput
from isograft.files import MeshFile
from isograft.formats.images import check_image_output, read_image
from isograft.formats.materials import Material, read_mtl, write_mtl
from isograft.formats.ply_header import texture_files
from isograft.formats.tiles import has_tiles, is_tiled
from isograft.grafting_textures import Textures, material_textures, one_texture, used_materials
from isograft.names import Names

#: The material that shows what was baked.
_NAME = "isograft"


def add_texture_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "texture",
        "All images of the donor's materials (mtllib, usemtl) are baked: colour, ambient, specular and emitted colour "
        "(map_Kd, map_Ka, map_Ks, map_Ke), shininess, opacity, roughness, metallic, sheen, clearcoat (map_Ns, map_d, "
        "map_Pr, map_Pm, map_Ps, map_Pc, map_Pcr), normal maps (norm, and map_Bump if it is coloured), heights "
        "(map_Bump if it is grey, disp). An .obj gets an .mtl beside it that shows them. A .ply names one image, the "
        "colour (comment TextureFile). <UDIM> in a name stands for the numbers of tiles.",
    )
    group.add_argument("--texture", metavar="IMAGE", help="bake this one only, as the colour of all of the donor")
    group.add_argument(
        "--texture-output",
        metavar="IMAGE",
        help="of the colour; default: OUT with .png for its suffix. The others are called IMAGE_roughness and so on",
    )
    group.add_argument("--size", type=int, default=1024, metavar="N", help="of the baked images (default: 1024)")
    group.add_argument("--margin", type=int, default=16, metavar="N", help="texels around what is baked (default: 16)")


def open_textures(arguments: argparse.Namespace, what: set[str], source: MeshFile, target: MeshFile) -> Textures | None:
    """What the donor has to bake, all images read; None if no texture is asked for.

    Raises BadInput or InvalidInput for what is missing, or would be written over.
    """
    if "texture" not in what:
        for given, name in ((arguments.texture, "--texture"), (arguments.texture_output, "--texture-output")):
            if given is not None:
                raise BadInput(f"{name} is given and texture is not in --what")
        return None
    folder = Path(_output(arguments)).parent
    if not folder.is_dir():
        raise BadInput(f"{_output(arguments)}: there is no folder {folder}")
    check_image_output(_output(arguments))
    single = Path(arguments.texture) if arguments.texture else _image_of_ply(target)
    opened: dict[Path, Any] = {}
    if single is not None:
        textures = one_texture(target, single, _once(_open_image, opened))
        read = {single}
    else:
        library = _library(target)
        textures = material_textures(target, library, _once(_open_image, opened))
        read = {texture.path for material in library.values() for texture in material.textures.values()}
    read |= {*opened} | {path for mesh in (source, target) for path in libraries_of(mesh)}
    written = [Path(path) for path in image_outputs(arguments, textures).values()]
    if _is_obj(arguments.output):
        written.append(Path(arguments.output).with_suffix(".mtl"))
    taken = {path.resolve() for path in read}
    for path in written:
        if path.resolve() in taken:
            raise BadInput(f"{path}: would be written over, and is read; give -o or --texture-output another name")
    return textures


def image_outputs(arguments: argparse.Namespace, textures: Textures) -> dict[str, str]:
    """Where every channel goes, by its keyword."""
    output = Path(_output(arguments))
    names = {item.keyword: f"{output.stem}_{item.word}" if item.word else output.stem for item in textures.channels}
    return {keyword: str(output.with_name(name + output.suffix)) for keyword, name in names.items()}


def shown_material(materials: list[str], shown: Any, libraries: list[Path]) -> tuple[list[str], str]:
    """The material of every polygon, those `shown` (p,) in a new one; and its name, which no library has."""
    known = {name for path in libraries if path.is_file() for name in read_mtl(path, ())}
    name = Names({*materials, *known}, overwrite=False).claim(_NAME)
    own = materials or [""] * len(shown)
    return [name if is_shown else before for is_shown, before in zip(shown.tolist(), own, strict=True)], name


def write_material(path: Path, output: Path, name: str, textures: Textures, images: dict[str, str]) -> None:
    """An .mtl at `path` that stands for `output`: the new material, which names the images as seen from there."""
    lines = {}
    for item in textures.channels:
        options = [f"-bm {item.strength:g}"] if item.strength != 1.0 else []
        options += ["-clamp on"] if item.is_clamped else []
        lines[item.keyword] = " ".join([*options, os.path.relpath(images[item.keyword], output.parent)])
    write_mtl(path, name, textures.numbers, lines)


def shown_in_ply(output: Path, images: dict[str, str]) -> str | None:
    """The one image that a .ply at `output` can name, as seen from there: the colour."""
    return os.path.relpath(images["map_Kd"], output.parent) if "map_Kd" in images else None


def libraries_of(mesh: MeshFile) -> list[Path]:
    """The material libraries that an .obj names, whether they exist or not."""
    path = Path(mesh.path)
    if not _is_obj(path):
        return []
    found: list[Path] = []
    for line in path.read_text("utf-8", "replace").splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword.lower() == "mtllib" and rest.strip():
            # Several names in a line, or one with spaces.
            whole = path.parent / rest.strip()
            found += [whole] if whole.is_file() else [path.parent / name for name in rest.split()]
    return list(dict.fromkeys(found))


def _image_of_ply(donor: MeshFile) -> Path | None:
    """The one image that a .ply names in a comment of its header, as MeshLab does; None for other files."""
    path = Path(donor.path)
    if path.suffix.lower() != ".ply":
        return None
    names = texture_files(path.read_bytes())
    if len(names) != 1:
        found = f"names {len(names)} images" if names else "names no image"
        raise BadInput(f"{path}: the donor {found} (comment TextureFile); give --texture")
    image = path.parent / names[0]
    if not (has_tiles(image) if is_tiled(image) else image.is_file()):
        raise BadInput(
            f"{path}: the donor names the image {names[0]} (comment TextureFile), which is not there; put it there, or "
            "give --texture"
        )
    return image


def _library(donor: MeshFile) -> dict[str, Material]:
    """The materials of all of the donor's libraries."""
    paths = libraries_of(donor)
    if not paths:
        raise BadInput(f"{donor.path}: the donor names no materials (mtllib) and so no image; give --texture")
    materials: dict[str, Material] = {}
    for path in paths:
        if not path.is_file():
            raise BadInput(f"{donor.path}: its material library {path} does not exist; give --texture")
        try:
            materials |= read_mtl(path, used_materials(donor))
        except OSError as error:
            raise BadInput(f"{path}: {error.strerror or error}") from None
    return materials


def _output(arguments: argparse.Namespace) -> str:
    return arguments.texture_output or str(Path(arguments.output).with_suffix(".png"))


def _is_obj(path: str | Path) -> bool:
    return Path(path).suffix.lower() == ".obj"


def _once(read: Callable[[Path], Any], seen: dict[Path, Any]) -> Callable[[Path], Any]:
    """Several channels may take what they need of one image."""

    def read_once(path: Path) -> Any:
        if path not in seen:
            seen[path] = read(path)
        return seen[path]

    return read_once


def _open_image(path: str | Path) -> Any:
    try:
        return read_image(path)
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror or error}") from None
    except InvalidInput as error:
        raise BadInput(str(error)) from None
