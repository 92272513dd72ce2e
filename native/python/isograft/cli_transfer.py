# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft transfer SOURCE TARGET MAP --what uv,color,... -o OUT`."""

from __future__ import annotations

import argparse
import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from isograft import grafting
from isograft.cli_layers import add_layer_options, layer_options, open_layers
from isograft.cli_outcome import NOTHING_MATCHED, OK, BadInput, ProgressLine, check_output, open_mesh
from isograft.cli_textures import (
    add_texture_options,
    image_outputs,
    libraries_of,
    open_textures,
    shown_in_ply,
    shown_material,
    write_material,
)
from isograft.correspondence import Correspondence
from isograft.errors import InvalidInput
from isograft.files import MAP_SUFFIXES, MESH_SUFFIXES, MeshFile, read_map
from isograft.formats.atomic import together
from isograft.formats.images import write_image
from isograft.formats.layers import write_layers
from isograft.formats.mesh_output import face_materials, write_obj, write_ply_mesh
from isograft.formats.npz import read_source
from isograft.grafting_layers import LAYERS_OF
from isograft.grafting_textures import Textures
from isograft.transfer import invert
from isograft.transfer.wrapping import METHODS

WHAT = ("uv", "color", "texture", *(kind for kind in LAYERS_OF if kind != "uv"), "shape")
OUTPUT_SUFFIXES = (".obj", ".ply")
# Vertices moved by less than this part of a mesh's size are where they were: a file may have few digits.
_SAME = 1e-4


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
        help="uv (texture coordinates, seams kept), color (of vertices), texture (images baked into the receiver's "
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
        "--mark-seams",
        action="store_true",
        help="with uv: mark the edges along which the islands part (the attribute uv_seam of edges)",
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
    parser.add_argument("--threads", type=int, metavar="N", help="default: all cores")
    parser.add_argument("--progress", action="store_true", help="also where standard error is no terminal")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    add_texture_options(parser)
    add_layer_options(parser)
    parser.set_defaults(run=run_transfer)


def run_transfer(arguments: argparse.Namespace) -> int:
    what = _what(arguments.what)
    check_output(arguments.output, OUTPUT_SUFFIXES)
    source, target = open_mesh(arguments.source), open_mesh(arguments.target)
    options = layer_options(arguments, what)
    data_output = open_layers(arguments, what, source, target, options)
    _check_meshes(arguments, what, source, target)
    textures = open_textures(arguments, what, source, target)
    progress = ProgressLine() if arguments.progress or sys.stderr.isatty() else None
    try:
        correspondence = _correspondence(arguments, source, target)
        result = grafting.graft(
            correspondence,
            source,
            target,
            what=what,
            cut_seams=arguments.cut_seams,
            mark_seams=arguments.mark_seams,
            fill=arguments.fill,
            textures=textures,
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
    written = _write(arguments, source, target, result, textures, data_output)
    return _report(arguments, correspondence, result, written)


def _write(
    arguments: argparse.Namespace,
    source: MeshFile,
    target: MeshFile,
    result: grafting.Graft,
    textures: Textures | None,
    data_output: str | None,
) -> dict[str, Any]:
    """Write everything that was computed, all of it or nothing; returns the names by what they hold."""
    output = Path(arguments.output)
    images = {} if textures is None else image_outputs(arguments, textures)
    with together() as beside:
        if data_output is not None:
            write_layers(beside(data_output), result.mesh.layers)
        for path, pixels in zip(images.values(), result.images, strict=True):
            write_image(beside(path), pixels)
        if output.suffix.lower() == ".obj":
            materials = face_materials(result.mesh)
            libraries = [path for mesh in (source, target) for path in libraries_of(mesh)] if materials else []
            if textures is not None:
                materials, name = shown_material(materials, result.shown, libraries)
                material = output.with_suffix(".mtl")
                write_material(beside(material), material, name, textures, images)
                libraries = [material, *libraries]
            names = [os.path.relpath(path, output.parent) for path in dict.fromkeys(libraries)]
            write_obj(beside(output), result.mesh, materials, names)
        else:
            write_ply_mesh(beside(output), result.mesh, shown_in_ply(output, images))
    return {"textures": list(images.values()), "data": data_output}


def _report(
    arguments: argparse.Namespace,
    correspondence: Correspondence,
    result: grafting.Graft,
    written: dict[str, Any],
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
        names = ", ".join([arguments.output, *written["textures"], *filter(None, [written["data"]])])
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
    for kind, words, own, given in (
        ("uv", "texture coordinates", source.corner_uvs, target.corner_uvs),
        ("color", "vertex colours", source.colors, target.colors),
    ):
        if kind in what and own is not None and given is not None and not arguments.overwrite:
            raise BadInput(
                f"{arguments.source}: the receiver has {words} of its own; give --overwrite, or leave {kind} out of "
                "--what"
            )
    if "texture" in what and target.corner_uvs is None:
        raise BadInput(f"{arguments.target}: the donor has no texture coordinates to read an image with")
    if "texture" in what and "uv" not in what and source.corner_uvs is None:
        raise BadInput(f"{arguments.source}: the receiver has no texture coordinates to bake into; add uv to --what")
    if arguments.unmatched and "shape" not in what:
        raise BadInput("--unmatched says how the donor's shape is completed; it is for --what shape")
    for given, does in ((arguments.cut_seams, "--cut-seams cuts along"), (arguments.mark_seams, "--mark-seams marks")):
        if given and "uv" not in what:
            raise BadInput(f"{does} the seams of texture coordinates; add uv to --what")
    for path, mesh in ((arguments.source, source), (arguments.target, target)):
        if not len(mesh.faces):
            raise BadInput(f"{path}: the file has no faces")
    if not 0.0 <= arguments.min_confidence <= 1.0:
        raise BadInput(f"--min-confidence must be from 0 to 1, not {arguments.min_confidence}")


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
    _check_shapes(arguments, correspondence, start, end)
    if arguments.inverse:
        correspondence = invert(
            correspondence, target.vertices, target.faces, source.vertices, source.faces, threads=arguments.threads
        )
    return grafting.at_least(correspondence, arguments.min_confidence)


def _check_shapes(
    arguments: argparse.Namespace, correspondence: Correspondence, start: MeshFile, end: MeshFile
) -> None:
    """Refuse a map that was made for other shapes of as many vertices, as far as its file tells."""
    if Path(arguments.map).suffix.lower() != ".npz":
        return
    matched = correspondence.face >= 0
    corners = end.faces[correspondence.face[matched]]
    points = np.einsum("nc,ncd->nd", correspondence.barycentric[matched], end.vertices[corners])
    sides: list[tuple[MeshFile, Any, Any]] = [(end, correspondence.points[matched], points)]
    source = read_source(arguments.map)
    if source is not None and len(source) == len(start.vertices):
        sides.append((start, source, start.vertices))
    for mesh, before, now in sides:
        size = float(np.ptp(mesh.vertices, axis=0).max(initial=0.0))
        off = float(np.abs(now - before).max(initial=0.0)) / max(size, 1e-300)
        if off > _SAME:
            raise BadInput(
                f"{mesh.path}: was edited after {arguments.map} was made, its vertices lie up to {off:.2g} of its size "
                "off; run isograft match again"
            )


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
