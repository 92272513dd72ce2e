# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_wrap computes, whole, before it writes: the donor's mesh with a receiver's shape."""

from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from isograft import transfer

from . import bridge, pairing
from .bridge import Array, RefusedError
from .grafting import FILLED
from .job import Progress, in_turn
from .matching import Messages
from .pairing import Pair
from .settings import OfProperties


@dataclass(frozen=True)
class WrapSettings(OfProperties):
    """The properties of object.isograft_wrap."""

    method: str = "RIGID"
    min_confidence: float = 0.0
    threads: int = 0


@dataclass
class Wrap:
    """The donor's vertices on one receiver."""

    pair: Pair
    vertices: Array = field(default_factory=lambda: np.zeros((0, 3)))
    """(m, 3) in the receiver's object space."""
    filled: Array = field(default_factory=lambda: np.zeros(0, dtype=bool))
    """(m,) True where completed."""

    def compute(self, settings: WrapSettings, progress: Progress) -> None:
        """Positions of the donor's vertices; touches no object of Blender's."""
        pair = self.pair
        wrapped = transfer.wrap(
            pair.correspondence,
            *pair.geometry(),
            method=settings.method.lower(),
            threads=settings.threads or None,
            progress=lambda stage, fraction: progress(f"{pair.name}: {stage}", fraction),
        )
        self.vertices = wrapped.vertices @ np.linalg.inv(pair.arrays.linear).T
        self.filled = np.asarray(wrapped.filled)

    def write(self, donor: Any, depsgraph: Any) -> Messages:
        """A new object beside the receiver; returns what to report."""
        receiver, arrays = self.pair.receiver, self.pair.donor.arrays
        name = f"{donor.name} on {receiver.name}"
        mesh = bridge.copy_mesh(donor, depsgraph, self.pair.donor.is_own)
        mesh.name = name
        obj = bpy.data.objects.new(name, mesh)
        bridge.copy_object_materials(obj, donor)
        for collection in receiver.users_collection:
            collection.objects.link(obj)
        obj.matrix_world = receiver.matrix_world
        bridge.write_vertices(obj, self.vertices, arrays.is_mirrored != self.pair.arrays.is_mirrored)
        bridge.write_attribute(obj, FILLED, "POINT", "BOOLEAN", self.filled)
        count = int(np.count_nonzero(self.filled))
        messages: Messages = []
        if count:
            text = f"{count:,} of {len(self.filled):,} vertices are unmatched and completed; {FILLED} marks them"
            messages.append(("WARNING", f"{obj.name}: {text}"))
        return [*messages, ("INFO", f"{obj.name}: the mesh of {donor.name} with the shape of {receiver.name}")]


@dataclass(frozen=True)
class WrapTask:
    """All wraps of a run, one after the other."""

    donor_name: str
    settings: WrapSettings
    wraps: list[Wrap]

    def task(self) -> "WrapTask":
        """The part that needs no Blender: run()."""
        return self

    def run(self, progress: Progress) -> list[Wrap]:
        """Compute all of them."""
        for item, part in in_turn(self.wraps, progress):
            with pairing.named(item.pair.name):
                item.compute(self.settings, part)
        return self.wraps

    def write(self, wraps: list[Wrap]) -> Messages:
        """Make the new objects of what run() returned.

        Raises:
            RefusedError: an object was removed or changed meanwhile; nothing is written.
        """
        depsgraph = bpy.context.evaluated_depsgraph_get()
        donor = bpy.data.objects.get(self.donor_name)
        for item in wraps:
            item.pair = replace(item.pair, receiver=pairing.unchanged(item.pair, depsgraph))
            arrays = item.pair.donor.arrays
            read = bridge.own_arrays if item.pair.donor.is_own else bridge.read_donor
            if donor is None or read(donor, depsgraph).content_hash != arrays.content_hash:
                raise RefusedError(f"{self.donor_name} was removed or edited meanwhile; nothing was written")
        return [message for item in wraps for message in item.write(donor, depsgraph)]


def prepare(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: WrapSettings) -> WrapTask:
    """Read everything a wrap needs.

    Raises:
        RefusedError: a match is missing or no longer fits, or matches nothing.
    """
    pairs = pairing.make(donor, receivers, context, settings.min_confidence)
    for pair in pairs:
        if not pair.matched.any():
            raise RefusedError(f"{pair.name}: no vertex of it is matched, there is nothing to wrap onto")
    return WrapTask(donor.name, settings, [Wrap(pair) for pair in pairs])
