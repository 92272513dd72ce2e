# SPDX-License-Identifier: GPL-3.0-or-later
"""Wavefront material libraries (MTL): numbers and images of materials, read and written.

Keywords have the names below whichever a file uses: bump is map_Bump, and case does not matter.
"""

from __future__ import annotations

import os
from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from isograft.errors import InvalidInput
from isograft.formats.atomic import replacing
from isograft.formats.tiles import has_tiles, is_tiled

PathLike = str | os.PathLike[str]
Numbers = tuple[float, ...]

#: Images that lie on the surface.
IMAGES = ("map_Kd", "map_Ka", "map_Ks", "map_Ke", "map_Ns", "map_d", "map_Tr", "map_Pr", "map_Pm", "map_Ps", "map_Pc",
          "map_Pcr", "norm", "map_Bump", "disp")  # fmt: skip
_KEYWORDS = {name.lower(): name for name in IMAGES} | {"bump": "map_Bump", "map_norm": "norm", "map_disp": "disp"}
#: How many numbers or words may follow an option of an image.
_OPTIONS = {"-blendu": 1, "-blendv": 1, "-boost": 1, "-cc": 1, "-mm": 2, "-o": 3, "-s": 3, "-t": 3, "-texres": 1,
            "-clamp": 1, "-bm": 1, "-imfchan": 1, "-type": 1}  # fmt: skip


@dataclass(frozen=True)
class Texture:
    """An image and how it is shown: looked up at `scale` times the texture coordinates plus `offset`."""

    #: Of UDIM tiles the name that stands for all of them; see formats/tiles.py.
    path: Path
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    is_clamped: bool = False
    #: r, g, b, m (alpha) or l (luminance): the one that is taken of an image's components; empty: as the keyword asks.
    component: str = ""
    #: -bm, of bumps and normal maps.
    strength: float = 1.0


@dataclass
class Material:
    """Numbers by keyword, such as Kd, Ns, illum, as they stand in the file; images by their names of IMAGES."""

    numbers: dict[str, Numbers] = field(default_factory=dict)
    textures: dict[str, Texture] = field(default_factory=dict)
    #: Images that do not lie on the surface (reflections, decals), and what is not known.
    left_out: list[str] = field(default_factory=list)


def read_mtl(path: PathLike, names: Container[str] | None = None) -> dict[str, Material]:
    """The materials of a library by name, in its order; images are looked for and not opened.

    Of materials that are not among `names` nothing but the name is read; None: all are.

    Raises:
        InvalidInput: naming the line; an image that is missing or shown in a way that cannot be baked.
        OSError: the library cannot be opened.
    """
    materials: dict[str, Material] = {}
    name, material = "", Material()
    for where, keyword, rest in _lines(path):
        lower = keyword.lower()
        if lower == "newmtl":
            name = rest
            material = materials.setdefault(name, Material())
        elif names is not None and name not in names:
            continue
        elif lower in _KEYWORDS:
            material.textures[_KEYWORDS[lower]] = _texture(f"{where}: {keyword} of the material {name}", rest, path)
        elif lower.startswith("map_") or lower in ("refl", "decal"):
            material.left_out.append(keyword)
        elif (numbers := _numbers(rest)) is not None:
            material.numbers[keyword] = numbers
    return materials


def write_mtl(path: PathLike, name: str, numbers: Mapping[str, Numbers], images: Mapping[str, str]) -> None:
    """One material with numbers and, by their names of IMAGES, what follows on the lines of the images."""
    lines = [f"newmtl {name}"]
    lines += [f"{keyword} {' '.join(f'{value:.9g}' for value in values)}" for keyword, values in numbers.items()]
    lines += [f"{keyword} {image}" for keyword, image in images.items()]
    with replacing(path) as file:
        file.write("\n".join([*lines, ""]).encode())


def _lines(path: PathLike) -> Iterator[tuple[str, str, str]]:
    """Place, keyword and the rest of every line that has both."""
    for number, line in enumerate(Path(path).read_text("utf-8", "replace").splitlines(), 1):
        keyword, _, rest = line.strip().replace("\t", " ").partition(" ")
        if rest.strip() and not keyword.startswith("#"):
            yield f"{path}: line {number}", keyword, rest.strip()


def _numbers(text: str) -> Numbers | None:
    try:
        return tuple(float(word) for word in text.split())
    except ValueError:
        return None


def _texture(where: str, text: str, library: PathLike) -> Texture:
    options, name = _options(where, text)
    path = Path(library).parent / name
    if not _is_there(path):
        # As other systems write it.
        path = Path(library).parent / name.replace("\\", "/")
    if not _is_there(path):
        raise InvalidInput(f"{where} names the image {name}, which is not there; put it there, or remove the line")
    for option, plain in (("-mm", [0.0, 1.0]), ("-t", [0.0, 0.0, 0.0])):
        values = _of_option(where, options, option, plain)
        if values != plain:
            raise InvalidInput(f"{where} changes its image with {option}; work that into the image first")
    scale = _of_option(where, options, "-s", [1.0, 1.0, 1.0])
    offset = _of_option(where, options, "-o", [0.0, 0.0, 0.0])
    component = options.get("-imfchan", [""])[0].lower()
    if component not in ("", "r", "g", "b", "m", "l"):
        raise InvalidInput(f"{where} takes the component {component} of its image; it must be one of r, g, b, m, l")
    return Texture(
        path,
        (scale[0], scale[1]),
        (offset[0], offset[1]),
        options.get("-clamp", ["off"])[0].lower() == "on",
        component,
        _of_option(where, options, "-bm", [1.0])[0],
    )


def _is_there(path: Path) -> bool:
    return has_tiles(path) if is_tiled(path) else path.is_file()


def _options(where: str, text: str) -> tuple[dict[str, list[str]], str]:
    """The options and their values, and the file's name with whatever spaces it has."""
    options: dict[str, list[str]] = {}
    rest = text
    while (option := rest.split(None, 1)[0].lower()) in _OPTIONS:
        values: list[str] = []
        rest = _behind(where, rest)
        while len(values) < _OPTIONS[option]:
            word = rest.split(None, 1)[0]
            # -o, -s and -t have one to three numbers.
            if values and _numbers(word) is None:
                break
            values.append(word)
            rest = _behind(where, rest)
        options[option] = values
    return options, rest


def _behind(where: str, text: str) -> str:
    parts = text.split(None, 1)
    if len(parts) < 2:
        raise InvalidInput(f"{where} names no image")
    return parts[1]


def _of_option(where: str, options: dict[str, list[str]], option: str, default: list[float]) -> list[float]:
    """An option's numbers, those that are not given as in `default`."""
    values = _numbers(" ".join(options.get(option, [])))
    if values is None:
        raise InvalidInput(f"{where}: {option} is followed by {' '.join(options[option])}, not by numbers")
    return [*values, *default[len(values) :]]
