# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_transfer computes, whole, before it writes."""

from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np

from . import bridge, cutting, pairing
from .bridge import RefusedError
from .cutting import Cut
from .job import Progress, in_turn
from .kinds import KINDS, Kind, UVMaps
from .matching import Messages
from .pairing import Pair
from .settings import Names, Settings

__all__ = ["Graft", "Settings", "TransferTask", "prepare"]

FILLED = "isograft_filled"
"""Point attribute on the receiver: True where what was received is completed, not found."""


def filled_text(name: str, filled: Any) -> str:
    """What to say of an object of which some vertices (n,) were filled."""
    count = int(np.count_nonzero(filled))
    return f"{name}: {count:,} unmatched vertices were filled; the attribute {FILLED} marks them"


def mark_filled(obj: Any, filled: Any) -> None:
    """Mark vertices (n,) of an object, beside those that are marked already."""
    if not filled.any():
        return
    before = bridge.read_attribute(obj, FILLED, "BOOLEAN")
    bridge.write_attribute(obj, FILLED, "POINT", "BOOLEAN", filled if before is None else filled | before)


@dataclass
class Graft:
    """Everything one receiver gets."""

    pair: Pair
    kinds: list[Kind]
    messages: Messages = field(default_factory=list)

    def compute(self, progress: Progress) -> None:
        """All of it; touches no object of Blender's."""
        with pairing.named(self.pair.name):
            for kind, part in in_turn(self.kinds, progress, lambda kind, _: f"{self.pair.name}: {kind.noun}s"):
                kind.run(part)
        self.messages = [("WARNING", text) for text in self.pair.arrays.warnings]
        self.messages += [("WARNING", text) for kind in self.kinds for text in kind.warnings]
        if self._filled.any():
            self.messages.append(("WARNING", filled_text(self.pair.name, self._filled)))
        parts = [text for kind in self.kinds if (text := kind.summary())]
        self.messages.append(("INFO", f"{self.pair.name}: received {' and '.join(parts) or 'nothing'}"))

    def find_again(self, depsgraph: Any, content_hash: str, donor: Any) -> None:
        """Look for the objects anew, as they may have moved in memory while compute() ran.

        Raises:
            RefusedError: the receiver is gone, or another mesh than that of `content_hash`.
        """
        receiver = pairing.unchanged(self.pair, depsgraph, content_hash)
        self.pair = replace(self.pair, receiver=receiver, donor=replace(self.pair.donor, obj=donor))
        for kind in self.kinds:
            kind.pair = self.pair

    def write(self) -> Messages:
        """Write it all; returns what to report."""
        for kind in self.kinds:
            kind.write()
        mark_filled(self.pair.receiver, self._filled)
        self.pair.receiver.data.update()
        return self.messages

    @property
    def _filled(self) -> Any:
        return np.any([kind.filled for kind in self.kinds], axis=0)


@dataclass(frozen=True)
class TransferTask:
    """What all receivers of a run get."""

    donor_name: str
    grafts: list[Graft]
    cuts: list[list[Cut]]
    """Of every receiver, to be made before it is written to."""
    hashes: list[str]
    """Of the receivers' meshes before any cut."""

    def task(self) -> "TransferTask":
        """The part that needs no Blender: run()."""
        return self

    def run(self, progress: Progress) -> list[Graft]:
        """Compute everything."""
        for graft, part in in_turn(self.grafts, progress):
            graft.compute(part)
        return self.grafts

    def write(self, grafts: list[Graft]) -> Messages:
        """Cut and write what run() returned; returns what to report.

        Raises:
            RefusedError: an object was removed or changed meanwhile; nothing is written.
        """
        depsgraph = bpy.context.evaluated_depsgraph_get()
        donor = bpy.data.objects.get(self.donor_name)
        if donor is None:
            raise RefusedError(f"{self.donor_name} was removed or renamed meanwhile; nothing was written")
        for graft, content_hash in zip(grafts, self.hashes, strict=True):
            graft.find_again(depsgraph, content_hash, donor)
        messages: Messages = []
        for graft, made in zip(grafts, self.cuts, strict=True):
            for cut in made:
                cut.apply(graft.pair.receiver)
            messages += [*_cut_messages(graft.pair.name, donor.name, made), *graft.write()]
        return messages


def prepare(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> TransferTask:
    """Read everything a transfer needs, and find where to cut; changes nothing.

    Raises:
        RefusedError: the donor lacks what is asked for, or a receiver's match is missing or no longer fits.
    """
    if not settings.what:
        raise RefusedError("Nothing to transfer; choose what the receivers are to get")
    cuts: list[list[Cut]] = [[] for _ in receivers]
    if not (settings.cut_seams and "UV" in settings.what):
        grafts = _read(donor, receivers, context, settings)
        return TransferTask(donor.name, grafts, cuts, [graft.pair.arrays.content_hash for graft in grafts])
    for obj in receivers:
        bridge.refuse_unwritable(obj)
    depsgraph = context.evaluated_depsgraph_get()
    hashes = [bridge.read_receiver(obj, depsgraph).content_hash for obj in receivers]
    # Found on copies of the meshes, which are read when cut: so all is known before the first write.
    with bridge.trial(receivers):
        cuts = _cut(donor, receivers, context, settings)
        grafts = _read(donor, receivers, context, settings)
    return TransferTask(donor.name, grafts, cuts, hashes)


def _read(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> list[Graft]:
    """Whoever is refused is refused here, before anything is computed."""
    chosen = [kind for name, kind in KINDS.items() if name in settings.what]
    gifts: dict[tuple[type[Kind], bool], Any] = {}
    grafts = []
    for pair in pairing.make(donor, receivers, context, settings.min_confidence):
        mesh = pair.receiver.data
        names = Names((layer.name for layer in (*mesh.uv_layers, *mesh.attributes)), settings.overwrite)
        kinds = []
        for kind in chosen:
            key = kind, pair.donor.is_own
            if key not in gifts:
                gifts[key] = kind.read(pair.donor, settings)
            kinds.append(kind(pair, gifts[key], settings, names))
        grafts.append(Graft(pair, kinds))
    return grafts


def _cut(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> list[list[Cut]]:
    """Cut every receiver along the seams of one chosen UV map after the other; returns what was done to each."""
    cuts: list[list[Cut]] = [[] for _ in receivers]
    number, maps = 0, 1
    while number < maps:
        found = []
        for graft in _read(donor, receivers, context, settings):
            cutting.refuse(graft.pair)
            seams = next(kind for kind in graft.kinds if isinstance(kind, UVMaps)).seam_maps()
            maps = len(seams)
            with pairing.named(graft.pair.name):
                found.append(cutting.find(graft.pair, seams[number]))
        for obj, made, cut in zip(receivers, cuts, found, strict=True):
            if cut is not None:
                cut.apply(obj)
                made.append(cut)
        number += 1
    return cuts


def _cut_messages(receiver: str, donor: str, cuts: list[Cut]) -> Messages:
    faces, whole = sum(len(np.unique(cut.faces)) for cut in cuts), sum(cut.left_whole for cut in cuts)
    messages: Messages = []
    if whole:
        text = f"{whole:,} concave faces were not cut; triangulate them first to have them cut"
        messages.append(("WARNING", f"{receiver}: {text}"))
    if faces:
        messages.append(("INFO", f"{receiver}: {faces:,} faces were cut along the seams of {donor}"))
    return messages
