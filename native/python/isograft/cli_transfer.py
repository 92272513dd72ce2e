# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer SOURCE TARGET MAP --what uv,color,... -o OUT`."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any

from isograft import grafting
from isograft.cli_layers import add_layer_options, layer_options, open_layers
from isograft.cli_outcome import NOTHING_MATCHED, OK, BadInput, ProgressLine, check_output, open_mesh
from isograft.correspondence import Correspondence
from isograft.errors import InvalidInput
from isograft.files import MAP_SUFFIXES, MESH_SUFFIXES, MeshFile, read_map
from isograft.formats.images import check_images, read_image, write_image
from isograft.formats.layers import write_layers
from isograft.formats.mesh_output import write_mtl, write_obj, write_ply_mesh
from isograft.grafting_layers import LAYERS_OF
from isograft.transfer import invert
from isograft.transfer.wrapping import METHODS

WHAT = ("uv", "color", "texture", *(kind for kind in LAYERS_OF if kind != "uv"), "shape")
OUTPUT_SUFFIXES = (".obj", ".ply")


def add_transfer(commands: Any, epilog: str) -> None:
    parser = commands.add_parser(
        "transfer",
        help="put on one surface what another one carries",
        description="Move what TARGET carries (the donor) to SOURCE (the receiver) along MAP, which leads from SOURCE "
        f"to TARGET. Meshes: {', '.join(MESH_SUFFIXES)}.",
        epilog=epilog,
    )
    parser.add_argument("source", metavar="SOURCE", help="the receiver")
    parser.add_argument("target", metavar="TARGET", help="the donor")
    parser.add_argument("map", metavar="MAP", help=f"{', '.join(MAP_SUFFIXES[:2])}, as isograft match writes it")
    parser.add_argument(
        "--what",
        required=True,
        metavar="KIND,...",
        help="uv (texture coordinates, seams kept), color (of vertices), texture (an image baked into the receiver's "
        "texture coordinates, which are its own unless uv is asked for too), attributes (of vertices, corners, "
        "polygons and edges: numbers, booleans, strings), weights (vertex groups), keys (shape keys), normals (custom "
        "ones of corners), shape (alone: the donor's vertices and polygons in the receiver's shape)",
    )
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="the mesh to write: .obj or .ply")
    parser.add_argument(
        "--inverse", action="store_true", help="MAP leads from TARGET to SOURCE: use it the other way round"
    )
    parser.add_argument(
        "--cut-seams",
        action="store_true",
        help="with uv: cut polygons of SOURCE along the seams of TARGET, so that texture coordinates are exact on both "
        "sides",
    )
    parser.add_argument(
        "--fill",
        action="store_true",
        help="continue smoothly into what is unmatched; .ply marks it (isograft_filled)",
    )
    parser.add_argument(
        "--unmatched",
        choices=METHODS,
        help="with shape: the rest of the donor keeps its shape as rigidly as possible (default), or goes on smoothly",
    )
    parser.add_argument("--min-confidence", type=float, default=0.0, metavar="X", help="leave out less sure vertices")
    parser.add_argument(
        "--texture", metavar="IMAGE", help="the donor's image; default: the one that its .mtl names (map_Kd)"
    )
    parser.add_argument("--texture-output", metavar="IMAGE", help="default: OUT with .png for its suffix")
    parser.add_argument("--size", type=int, default=1024, metavar="N", help="of the baked image (default: 1024)")
    parser.add_argument("--margin", type=int, default=16, metavar="N", help="texels around what is baked (default: 16)")
    parser.add_argument("--threads", type=int, metavar="N", help="default: all cores")
    parser.add_argument("--progress", action="store_true", help="also where standard error is no terminal")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    add_layer_options(parser)
    parser.set_defaults(run=run_transfer)


def run_transfer(arguments: argparse.Namespace) -> int:
    what = _what(arguments.what)
    check_output(arguments.output, OUTPUT_SUFFIXES)
    source, target = open_mesh(arguments.source), open_mesh(arguments.target)
    options = layer_options(arguments, what)
    data_output = open_layers(arguments, what, source, target, options)
    _check_meshes(arguments, what, source, target)
    image_path, texture_output = _images(arguments, what)
    pixels = None if image_path is None else _open_image(image_path)
    progress = ProgressLine() if arguments.progress or sys.stderr.isatty() else None
    try:
        correspondence = _correspondence(arguments, source, target)
        result = grafting.graft(
            correspondence,
            source,
            target,
            what=what,
            cut_seams=arguments.cut_seams,
            fill=arguments.fill,
            image=pixels,
            size=arguments.size,
            margin=arguments.margin,
            layers=options,
            unmatched=arguments.unmatched or METHODS[0],
            threads=arguments.threads,
            progress=progress,
        )
    finally:
        if progress is not None:
            progress.close()
    # All is computed; now all is written, the mesh last, since it names the others.
    material = None
    if data_output is not None:
        write_layers(data_output, result.mesh.layers)
    if result.image is not None:
        write_image(texture_output, result.image)
        material = str(Path(arguments.output).with_suffix(".mtl").name)
    if Path(arguments.output).suffix.lower() == ".obj":
        if material is not None:
            write_mtl(Path(arguments.output).with_suffix(".mtl"), Path(texture_output).name)
        write_obj(arguments.output, result.mesh, material, _libraries(arguments))
    else:
        write_ply_mesh(arguments.output, result.mesh)
    written = {"texture": texture_output if result.image is not None else None, "data": data_output}
    return _report(arguments, correspondence, result, written)


def _report(
    arguments: argparse.Namespace,
    correspondence: Correspondence,
    result: grafting.Graft,
    written: dict[str, str | None],
) -> int:
    code = OK if correspondence.matched.any() else NOTHING_MATCHED
    matched = int(correspondence.matched.sum())
    for text in result.warnings:
        print(f"isograft transfer: warning: {text}", file=sys.stderr)
    if arguments.json:
        summary = {
            "output": arguments.output,
            **written,
            "vertices": len(correspondence),
            "matched": matched,
            "filled": 0 if result.mesh.filled is None else int(result.mesh.filled.sum()),
            **result.counts,
            "warnings": result.warnings,
            "exit_code": code,
        }
        print(json.dumps(summary))
    else:
        names = ", ".join([arguments.output, *(path for path in written.values() if path is not None)])
        print(f"{matched} of {len(correspondence)} vertices matched; {result.sentence()}: {names}")
    return code


def _what(text: str) -> set[str]:
    kinds = [kind.strip() for kind in text.split(",") if kind.strip()]
    unknown = [kind for kind in kinds if kind not in WHAT]
    if unknown or not kinds:
        raise BadInput(f"--what must name some of {', '.join(WHAT)}, not {', '.join(unknown) or 'nothing'}")
    if "shape" in kinds and len(set(kinds)) > 1:
        raise BadInput("--what shape stands alone: it writes the donor's own vertices with all that they have")
    return set(kinds)


def _check_meshes(arguments: argparse.Namespace, what: set[str], source: MeshFile, target: MeshFile) -> None:
    if "uv" in what and target.corner_uvs is None and not target.layers.uv:
        raise BadInput(f"{arguments.target}: the donor has no texture coordinates; leave uv out of --what")
    if "color" in what and target.colors is None:
        raise BadInput(f"{arguments.target}: the donor has no vertex colours; leave color out of --what")
    if "texture" in what and target.corner_uvs is None:
        raise BadInput(f"{arguments.target}: the donor has no texture coordinates to read an image with")
    if "texture" in what and "uv" not in what and source.corner_uvs is None:
        raise BadInput(f"{arguments.source}: the receiver has no texture coordinates to bake into; add uv to --what")
    if arguments.unmatched and "shape" not in what:
        raise BadInput("--unmatched says how the donor's shape is completed; it is for --what shape")
    if arguments.cut_seams and "uv" not in what:
        raise BadInput("--cut-seams cuts along the seams of texture coordinates; add uv to --what")
    for path, mesh in ((arguments.source, source), (arguments.target, target)):
        if not len(mesh.faces):
            raise BadInput(f"{path}: the file has no faces")
    if not 0.0 <= arguments.min_confidence <= 1.0:
        raise BadInput(f"--min-confidence must be from 0 to 1, not {arguments.min_confidence}")


def _images(arguments: argparse.Namespace, what: set[str]) -> tuple[str | None, str]:
    output = arguments.texture_output or str(Path(arguments.output).with_suffix(".png"))
    if "texture" not in what:
        for given, name in ((arguments.texture, "--texture"), (arguments.texture_output, "--texture-output")):
            if given is not None:
                raise BadInput(f"{name} is given and texture is not in --what")
        return None, output
    folder = Path(output).parent
    if not folder.is_dir():
        raise BadInput(f"{output}: there is no folder {folder}")
    path = arguments.texture or _image_of(arguments.target)
    check_images(path, output)
    return path, output


def _libraries(arguments: argparse.Namespace) -> list[str]:
    """The material libraries of receiver and donor, as seen from the output."""
    folder = Path(arguments.output).parent
    found = [
        os.path.relpath(Path(path).parent / name, folder)
        for path in (arguments.source, arguments.target)
        if Path(path).suffix.lower() == ".obj"
        for name in _values(Path(path), "mtllib")
    ]
    return list(dict.fromkeys(found))


def _image_of(path: str) -> str:
    """The one image that an OBJ's materials name as their colour."""
    images: set[Path] = set()
    if Path(path).suffix.lower() == ".obj":
        for name in _values(Path(path), "mtllib"):
            library = Path(path).parent / name
            if not library.is_file():
                raise BadInput(f"{path}: its material library {library} does not exist; give --texture")
            images |= {library.parent / value for value in _values(library, "map_kd")}
    if len(images) != 1:
        found = "names no image" if not images else f"names {len(images)} images"
        raise BadInput(f"{path}: the donor {found} as its colour; give --texture")
    return str(images.pop())


def _values(path: Path, keyword: str) -> list[str]:
    try:
        lines = path.read_text(errors="replace").splitlines()
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror or error}") from None
    parts = [line.strip().split(None, 1) for line in lines]
    return [part[1].strip() for part in parts if len(part) == 2 and part[0].lower() == keyword]


def _open_image(path: str) -> Any:
    try:
        return read_image(path)
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror or error}") from None


def _correspondence(arguments: argparse.Namespace, source: MeshFile, target: MeshFile) -> Correspondence:
    start, end = (target, source) if arguments.inverse else (source, target)
    try:
        correspondence = read_map(arguments.map, end.surface())
    except OSError as error:
        raise BadInput(f"{arguments.map}: {error.strerror or error}") from None
    except InvalidInput as error:
        raise BadInput(f"{error}{_hint(arguments, source, target)}") from None
    if len(correspondence) != len(start.vertices):
        raise BadInput(
            f"{arguments.map}: the map starts from {len(correspondence)} vertices, {start.path} has "
            f"{len(start.vertices)}"
        )
    if arguments.inverse:
        correspondence = invert(
            correspondence, target.vertices, target.faces, source.vertices, source.faces, threads=arguments.threads
        )
    return grafting.at_least(correspondence, arguments.min_confidence)


def _hint(arguments: argparse.Namespace, source: MeshFile, target: MeshFile) -> str:
    """What to do about a map of the other direction; nothing about one that fits neither way."""
    if arguments.inverse or Path(arguments.map).suffix.lower() != ".npz":
        return ""
    try:
        found = Correspondence.load(arguments.map)
    except InvalidInput:
        return ""
    turned = len(found) == len(target.vertices) and found.target_size == len(source.vertices)
    return "; it leads from TARGET to SOURCE: give --inverse" if turned else ""
