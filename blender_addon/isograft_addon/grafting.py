# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_transfer computes, whole, before it writes."""

from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from isograft.progress import part_of

from . import bridge, cutting, pairing
from .bridge import RefusedError
from .cutting import Cut, Search
from .job import Progress, in_turn
from .kinds import KINDS, Kind, UVMaps
from .matching import Messages
from .pairing import Pair
from .settings import Names, Settings

__all__ = ["CutSearch", "Graft", "Settings", "TransferTask", "prepare"]

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
    done: float = 0.0
    """What was done before, of the progress."""

    def task(self) -> "TransferTask":
        """The part that needs no Blender: run()."""
        return self

    def run(self, progress: Progress) -> list[Graft]:
        """Compute everything."""
        for graft, part in in_turn(self.grafts, part_of(progress, self.done, 1.0)):
            graft.compute(part)
        return self.grafts

    def write(self, grafts: list[Graft]) -> Messages:
        """Cut and write what run() returned; returns what to report.

        Raises:
            RefusedError: an object was removed or changed meanwhile; nothing is written.
        """
        depsgraph = bpy.context.evaluated_depsgraph_get()
        donor = pairing.donor_again(self.donor_name)
        for graft, content_hash in zip(grafts, self.hashes, strict=True):
            graft.find_again(depsgraph, content_hash, donor)
        messages: Messages = []
        for graft, made in zip(grafts, self.cuts, strict=True):
            for cut in made:
                cut.apply(graft.pair.receiver)
            messages += [*_cut_messages(graft.pair.name, donor.name, made), *graft.write()]
        return messages


@dataclass(frozen=True)
class CutSearch:
    """A transfer that cuts first, on its way: where to, for one chosen UV map of the donor after the other.

    What follows from a cut is read from copies of the meshes that are cut: so all is known before the first write.
    """

    donor_name: str
    settings: Settings
    hashes: list[str]
    """Of the receivers' meshes before any cut."""
    searches: list[Search]
    """Of every receiver, cut as found so far."""
    cuts: list[list[Cut]]
    """Of every receiver, found so far."""
    number: int
    """Of the UV map."""
    maps: int

    def task(self) -> "CutSearch":
        """The part that needs no Blender: run()."""
        return self

    def run(self, progress: Progress) -> list[Cut | None]:
        """The cut of every receiver."""
        found = []
        share = part_of(progress, self.number / (self.maps + 1), (self.number + 1) / (self.maps + 1))
        for search, part in in_turn(self.searches, share, lambda item, _: f"{item.pair.name}: seams to cut along"):
            with pairing.named(search.pair.name):
                found.append(search.find(part))
        return found

    def then(self, found: list[Cut | None], context: bpy.types.Context) -> "CutSearch | TransferTask":
        """What to run next, after run() returned `found`: the search along the next map, or the transfer.

        Raises:
            RefusedError: an object was removed or changed meanwhile, or the donor lacks what is asked for.
        """
        depsgraph = context.evaluated_depsgraph_get()
        donor = pairing.donor_again(self.donor_name)
        receivers = [
            pairing.again(search.pair.name, depsgraph, content_hash)
            for search, content_hash in zip(self.searches, self.hashes, strict=True)
        ]
        cuts = [made if cut is None else [*made, cut] for made, cut in zip(self.cuts, found, strict=True)]
        number = self.number + 1
        with bridge.trial(receivers):
            for obj, made in zip(receivers, cuts, strict=True):
                for cut in made:
                    cut.apply(obj)
            grafts = _read(donor, receivers, context, self.settings)
            if number == self.maps:
                return TransferTask(donor.name, grafts, cuts, self.hashes, number / (number + 1))
            return replace(self, searches=_searches(grafts, number), cuts=cuts, number=number)


def prepare(
    donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings
) -> "TransferTask | CutSearch":
    """Read everything a transfer needs, or what finding the cuts before it needs; changes nothing.

    Raises:
        RefusedError: the donor lacks what is asked for, or a receiver's match is missing or no longer fits.
    """
    if not settings.what:
        raise RefusedError("Nothing to transfer; choose what the receivers are to get")
    cuts: list[list[Cut]] = [[] for _ in receivers]
    cuts_first = settings.cut_seams and "UV" in settings.what
    if cuts_first:
        for obj in receivers:
            bridge.refuse_unwritable(obj)
    grafts = _read(donor, receivers, context, settings)
    hashes = [graft.pair.arrays.content_hash for graft in grafts]
    if not cuts_first:
        return TransferTask(donor.name, grafts, cuts, hashes)
    for graft in grafts:
        cutting.refuse(graft.pair)
    maps = len(_uv_maps(grafts[0]).seam_maps())
    return CutSearch(donor.name, settings, hashes, _searches(grafts, 0), cuts, 0, maps)


def _searches(grafts: list[Graft], number: int) -> list[Search]:
    """For the cuts of every receiver along the seams of one chosen UV map."""
    return [Search.of(graft.pair, _uv_maps(graft).seam_maps()[number]) for graft in grafts]


def _uv_maps(graft: Graft) -> UVMaps:
    return next(kind for kind in graft.kinds if isinstance(kind, UVMaps))


def _read(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> list[Graft]:
    """Whoever is refused is refused here, before anything is computed."""
    chosen = [kind for name, kind in KINDS.items() if name in settings.what]
    gifts: dict[tuple[type[Kind], bool], Any] = {}
    grafts = []
    for pair in pairing.make(donor, receivers, context, settings.min_confidence):
        names = Names.of_layers(pair.receiver.data, settings.overwrite)
        kinds = []
        for kind in chosen:
            key = kind, pair.donor.is_own
            if key not in gifts:
                gifts[key] = kind.read(pair.donor, settings)
            kinds.append(kind(pair, gifts[key], settings, names))
        grafts.append(Graft(pair, kinds))
    return grafts


def _cut_messages(receiver: str, donor: str, cuts: list[Cut]) -> Messages:
    faces, whole = sum(len(np.unique(cut.faces)) for cut in cuts), sum(cut.left_whole for cut in cuts)
    messages: Messages = []
    if whole:
        text = f"{whole:,} concave faces were not cut; triangulate them first to have them cut"
        messages.append(("WARNING", f"{receiver}: {text}"))
    if faces:
        messages.append(("INFO", f"{receiver}: {faces:,} faces were cut along the seams of {donor}"))
    return messages
