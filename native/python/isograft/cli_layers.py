# SPDX-License-Identifier: GPL-3.0-or-later
"""What `isograft transfer` moves beside texture coordinates, colours and images: its options and its .npz files."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from isograft.cli_outcome import BadInput, check_output
from isograft.files import MeshFile
from isograft.formats.layers import read_layers
from isograft.grafting_layers import LAYERS_OF, LayerOptions, choose_layers, moves_layers
from isograft.transfer import MIX_MODES

_DEFAULTS = LayerOptions()
#: Names of options that need one of some kinds, and those.
_NEEDS = {
    "target_data": tuple(LAYERS_OF), "source_data": tuple(LAYERS_OF), "data_output": tuple(LAYERS_OF),
    "names": ("uv", "attributes", "weights", "keys"), "overwrite": (*LAYERS_OF, "color"), "locked": ("weights", "keys"),
    "mix_mode": ("weights",), "mix_factor": ("weights",), "normalise": ("weights",), "limit_total": ("weights",),
    "key_scale": ("keys",), "key_smoothing": ("keys",),
}  # fmt: skip


def add_layer_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group(
        "attributes, more UV maps, vertex groups, shape keys, custom normals",
        "They are read from PLY properties of vertices, faces and edges (vertex groups: weights/NAME) and from .npz "
        "files with the arrays point/NAME (n, ...), corner/NAME (c, ...), face/NAME (p, ...), edge/NAME (e, ...) with "
        "edges (e, 2), uv/NAME (c, 2), weights/NAME (n), keys/NAME (n, 3: displacements) and normals (c, 3), for n "
        "vertices, p polygons and their c corners as the mesh file has them. They are written to such an .npz; a .ply "
        "has those of one number too.",
    )
    group.add_argument("--target-data", metavar="DATA", help="what the donor carries (.npz)")
    group.add_argument("--source-data", metavar="DATA", help="what the receiver carries already (.npz); it is kept")
    group.add_argument("--data-output", metavar="DATA", help="default: OUT with .npz for its suffix")
    group.add_argument("--names", metavar="NAME,...", help="only these, with * and ? (default: all)")
    group.add_argument(
        "--overwrite",
        action="store_true",
        help="what the receiver has of the same name, and its texture coordinates, colours and normals; default: "
        "NAME.001 beside it, and a refusal",
    )
    group.add_argument("--locked", metavar="NAME,...", help="vertex groups and shape keys that may not be overwritten")
    group.add_argument("--mix-mode", choices=MIX_MODES, help="with own weights (default: replace)")
    group.add_argument(
        "--mix-factor",
        type=float,
        metavar="X",
        help="0 keeps own weights, 1 (default) takes the mixed ones; the threshold of the threshold modes",
    )
    group.add_argument("--normalise", action="store_true", help="weights of a vertex sum to 1")
    group.add_argument("--limit-total", type=int, metavar="N", help="the heaviest N groups of a vertex")
    group.add_argument(
        "--key-scale",
        metavar="X",
        help="global: one ratio of sizes (default); local: that around every vertex; or a number",
    )
    group.add_argument(
        "--key-smoothing", type=int, metavar="N", help="edges around a vertex that its turning is measured over"
    )


def layer_options(arguments: argparse.Namespace, what: set[str]) -> LayerOptions:
    """Raises BadInput for an option whose kind is not asked for, or out of range."""
    for name, kinds in _NEEDS.items():
        if getattr(arguments, name) not in (None, False) and what.isdisjoint(kinds):
            raise BadInput(f"{_flag(name)} is given and none of {', '.join(kinds)} is in --what")
    if arguments.mix_factor is not None and not 0.0 <= arguments.mix_factor <= 1.0:
        raise BadInput(f"--mix-factor must be from 0 to 1, not {arguments.mix_factor}")
    if arguments.limit_total is not None and arguments.limit_total < 1:
        raise BadInput(f"--limit-total must be at least 1, not {arguments.limit_total}")
    if arguments.key_smoothing is not None and arguments.key_smoothing < 0:
        raise BadInput(f"--key-smoothing must not be negative, and is {arguments.key_smoothing}")
    return LayerOptions(
        names=arguments.names or "",
        overwrite=arguments.overwrite,
        locked=arguments.locked or "",
        mix_mode=arguments.mix_mode or _DEFAULTS.mix_mode,
        mix=_DEFAULTS.mix if arguments.mix_factor is None else arguments.mix_factor,
        normalise=arguments.normalise,
        limit=arguments.limit_total,
        key_scale=_key_scale(arguments.key_scale),
        key_smoothing=arguments.key_smoothing,
    )


def open_layers(
    arguments: argparse.Namespace, what: set[str], source: MeshFile, target: MeshFile, options: LayerOptions
) -> str | None:
    """Give the meshes what their .npz files say; returns where to write what comes of it, None for nowhere.

    Raises BadInput or InvalidInput for files that do not fit, and for a donor that lacks what is asked for.
    """
    for path, mesh in ((arguments.target_data, target), (arguments.source_data, source)):
        if path is not None:
            mesh.polygons.layers = mesh.layers.with_(_open(path, mesh))
    if moves_layers(what, target):
        choose_layers(what, target, options)
    elif arguments.source_data is None and arguments.data_output is None and not arguments.mark_seams:
        return None
    output: str = arguments.data_output or str(Path(arguments.output).with_suffix(".npz"))
    check_output(output, (".npz",))
    for given in (arguments.map, arguments.target_data):
        if given is not None and Path(given).resolve() == Path(output).resolve():
            raise BadInput(f"{output}: would be written over, and is read; give --data-output another name")
    return output


def _open(path: str, mesh: MeshFile) -> Any:
    if Path(path).suffix.lower() != ".npz":
        raise BadInput(f"{path}: layers are read from .npz files")
    try:
        return read_layers(path, len(mesh.vertices), mesh.polygons.sizes, mesh.path)
    except OSError as error:
        raise BadInput(f"{path}: {error.strerror or error}") from None


def _flag(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _key_scale(text: str | None) -> Any:
    if text is None or text in ("global", "local"):
        return text or _DEFAULTS.key_scale
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < float("inf"):
        raise BadInput(f"--key-scale must be global, local or a positive number, not {text}")
    return value
