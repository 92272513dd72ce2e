# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes, vertex groups, shape keys and custom normals of mesh files, computed whole before anything is written."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from isograft.errors import InvalidInput
from isograft.formats.layers import DOMAINS, FILLED, SEAMS, Layers
from isograft.formats.mesh import MeshFile
from isograft.grafting_moves import Moved, Mover, edges_of
from isograft.names import Names, choose
from isograft.progress import part_of
from isograft.transfer import mix_weights, tidy_weights
from isograft.transfer.arrays import Array, CorrespondenceArrays, Progress
from isograft.transfer.shape_keys import Scale
from isograft.transfer.weights import MixMode

Bools = npt.NDArray[np.bool_]

#: What may be asked for, and the kinds of layers that it stands for.
LAYERS_OF: dict[str, tuple[str, ...]] = {
    "uv": ("uv",), "attributes": DOMAINS, "weights": ("weights",), "keys": ("keys",), "normals": ()
}  # fmt: skip
_WORDS = {
    "uv": "UV map",
    "attributes": "attribute",
    "weights": "vertex group",
    "keys": "shape key",
    "normals": "custom normals",
}


@dataclass(frozen=True)
class LayerOptions:
    """Which layers are moved, and how."""

    #: Comma-separated, with * and ?; empty: all.
    names: str = ""
    #: Write over the receiver's own layers of the same names; else what comes takes a new name.
    overwrite: bool = False
    #: The receiver's vertex groups and shape keys that may not change: comma-separated, with * and ?.
    locked: str = ""
    mix_mode: MixMode = "replace"
    mix: float = 1.0
    normalise: bool = False
    limit: int | None = None
    key_scale: Scale = "global"
    key_smoothing: int | None = None


@dataclass(eq=False)
class LayerGraft:
    """The receiver's layers and those that came."""

    layers: Layers
    filled: Bools
    counts: dict[str, int] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def moves_layers(what: set[str], donor: MeshFile) -> bool:
    """Whether `what` asks for any layers: of UV maps only for those beside the file's own."""
    return any(kind in what for kind in LAYERS_OF if kind != "uv") or ("uv" in what and bool(donor.layers.uv))


def choose_layers(what: set[str], donor: MeshFile, options: LayerOptions) -> dict[str, list[str]]:
    """Names of the donor's layers that are asked for, by their kind (KINDS).

    Raises:
        InvalidInput: the donor lacks something of `what` (LAYERS_OF), or a name stands for nothing; names its file.
    """
    asked = [kind for kind in LAYERS_OF if kind in what]
    found = {layer: [n for n in donor.layers.of(layer) if n != FILLED] for kind in asked for layer in LAYERS_OF[kind]}
    for kind in asked:
        has = any(found[layer] for layer in LAYERS_OF[kind])
        # What the file itself has.
        has = (
            has
            or (kind == "normals" and donor.layers.normals is not None)
            or (kind == "uv" and donor.corner_uvs is not None)
        )
        if not has:
            raise InvalidInput(
                f"{donor.path}: the donor has no {_WORDS[kind]}; give a file that has with --target-data, or leave "
                f"{kind} out of --what"
            )
    if options.names:
        names = [name for layer in found.values() for name in layer]
        owner = f"{donor.path}: the donor has no {' or '.join(_WORDS[kind] for kind in asked)}"
        chosen = set(choose(names, options.names, owner))
        found = {kind: [name for name in layer if name in chosen] for kind, layer in found.items()}
    return {kind: layer for kind, layer in found.items() if layer}


def graft_layers(
    correspondence: CorrespondenceArrays,
    receiver: MeshFile,
    donor: MeshFile,
    what: set[str],
    options: LayerOptions,
    *,
    fill: bool = False,
    threads: int | None = None,
    progress: Progress | None = None,
) -> LayerGraft:
    """Move the layers that choose_layers() names; those of the receiver stay, under their names.

    Raises:
        InvalidInput: the map does not fit, the donor lacks a kind or a name, or a layer's values cannot be used; the
            text names the file and the layer.
    """
    chosen = choose_layers(what, donor, options)
    locked = _locked(receiver, options)
    result = LayerGraft(Layers().with_(receiver.layers), np.zeros(len(receiver.vertices), bool))
    if "edge" in chosen and result.layers.edges is None:
        result.layers.edges = edges_of(receiver)
    tasks = [*chosen, *(["normals"] if "normals" in what else [])]
    for number, kind in enumerate(tasks):
        part = part_of(progress, number / len(tasks), (number + 1) / len(tasks))
        mover = Mover(correspondence, receiver, donor, result.layers.edges, fill, threads, part)
        if kind == "normals":
            _graft_normals(mover, options, result)
        elif kind == "weights":
            _graft_weights(mover, chosen[kind], locked, options, result)
        elif kind == "keys":
            _graft_keys(mover, chosen[kind], locked, options, result)
        else:
            _graft_attributes(mover, kind, chosen[kind], options, result)
    return result


def with_seams(layers: Layers, receiver: MeshFile, seams: npt.NDArray[np.int32]) -> Layers:
    """Layers with the edges `seams` (s, 2) marked, beside those that are marked already; SEAMS names the attribute."""
    edges = edges_of(receiver) if layers.edges is None else layers.edges
    key = np.array([len(receiver.vertices), 1])
    lacking = seams[~np.isin(seams @ key, np.sort(edges, axis=1) @ key)]
    grown = {
        name: np.concatenate([values, np.zeros((len(lacking), *values.shape[1:]), values.dtype)])
        for name, values in layers.edge.items()
    }
    edges = np.concatenate([edges, lacking])
    marks = np.isin(np.sort(edges, axis=1) @ key, seams @ key)
    own = grown.get(SEAMS)
    grown[SEAMS] = marks | (own != 0) if own is not None and own.ndim == 1 and own.dtype.kind in "biuf" else marks
    return replace(layers, edges=edges, edge=grown)


def _graft_attributes(mover: Mover, kind: str, names: list[str], options: LayerOptions, result: LayerGraft) -> None:
    own = result.layers.of(kind)
    # As in Blender, attributes of all domains share one space of names.
    beside = DOMAINS if kind in DOMAINS else (kind,)
    taken = Names({name for other in beside for name in result.layers.of(other)}, options.overwrite)
    for number, name in enumerate(names):
        with _named(f"{mover.donor.path}: {kind}/{name}"):
            moved = mover.move(kind, mover.donor.layers.of(kind)[name], number, len(names))
        target = taken.claim(name)
        for other in beside:
            if other != kind:
                result.layers.of(other).pop(target, None)
        own[target] = _beside(moved, own.get(target))
        result.filled |= moved.filled
    count = "attributes" if kind in DOMAINS else "uv_maps"
    result.counts[count] = result.counts.get(count, 0) + len(names)


def _beside(moved: Moved, own: Array | None) -> Array:
    """What came, and the receiver's own values, if they are of that kind, where nothing did."""
    if own is None or own.dtype.kind != moved.values.dtype.kind or own.shape != moved.values.shape:
        return moved.values
    known = moved.known.reshape(-1, *[1] * (own.ndim - 1))
    both: Array = np.where(known, moved.values, own)
    return both


def _graft_weights(mover: Mover, names: list[str], locked: set[str], options: LayerOptions, result: LayerGraft) -> None:
    own = result.layers.weights
    taken = Names(own, options.overwrite)
    targets = [taken.claim(name) for name in names]
    held = np.array([name in own and name in locked for name in targets], dtype=bool)
    with _named(f"{mover.donor.path}: weights"):
        moved = mover.move("weights", np.stack([mover.donor.layers.weights[name] for name in names], axis=1))
    before = np.stack([own.get(name, np.zeros(len(moved.known))) for name in targets], axis=1)
    with _named(f"{mover.receiver.path}: weights"):
        mixed = mix_weights(before, moved.values, mode=options.mix_mode, mix=options.mix, mask=moved.known, locked=held)
        tidy = tidy_weights(mixed, normalise=options.normalise, limit=options.limit, locked=held, mask=moved.known)
    own.update({targets[column]: tidy[:, column] for column in np.flatnonzero(~held)})
    result.filled |= moved.filled
    result.counts["vertex_groups"] = int((~held).sum())
    _tell_locked(result, mover.receiver.path, "vertex groups", [targets[column] for column in np.flatnonzero(held)])


def _graft_keys(mover: Mover, names: list[str], locked: set[str], options: LayerOptions, result: LayerGraft) -> None:
    own = result.layers.keys
    taken = Names(own, options.overwrite)
    targets = {name: taken.claim(name) for name in names}
    free = [name for name in names if not (targets[name] in own and targets[name] in locked)]
    if free:
        with _named(f"{mover.donor.path}: keys"):
            moved = mover.keys(
                np.stack([mover.donor.layers.keys[name] for name in free]), options.key_scale, options.key_smoothing
            )
        for name, key in zip(free, np.moveaxis(moved.values, 1, 0), strict=True):
            own[targets[name]] = _beside(moved._replace(values=key), own.get(targets[name]))
        result.filled |= moved.filled
    result.counts["shape_keys"] = len(free)
    _tell_locked(result, mover.receiver.path, "shape keys", [targets[n] for n in names if n not in free])


def _graft_normals(mover: Mover, options: LayerOptions, result: LayerGraft) -> None:
    own = result.layers.normals
    if own is not None and not options.overwrite:
        raise InvalidInput(
            f"{mover.receiver.path}: the receiver has custom normals of its own; give --overwrite, or leave normals "
            "out of --what"
        )
    with _named(f"{mover.donor.path}: normals"):
        moved = mover.normals(mover.donor.layers.normals)
    result.layers.normals = _beside(moved, own)
    result.filled |= moved.filled
    result.counts["corners_with_normals"] = int(moved.known.sum())


def _locked(receiver: MeshFile, options: LayerOptions) -> set[str]:
    own = [*receiver.layers.weights, *receiver.layers.keys]
    owner = f"{receiver.path}: the receiver has no vertex group or shape key"
    return set(choose(own, options.locked, owner)) if options.locked else set()


def _tell_locked(result: LayerGraft, path: str, words: str, names: list[str]) -> None:
    if names:
        result.warnings.append(f"{path}: locked {words} are as they were: {', '.join(names)}")


@contextmanager
def _named(text: str) -> Iterator[None]:
    """What is refused inside is refused with the name of the layer."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(f"{text}: {error}") from None
