# SPDX-License-Identifier: GPL-3.0-or-later
"""What object.isograft_transfer computes, whole, before it writes."""

from dataclasses import dataclass, field
from typing import Any

import bpy
import numpy as np

from . import bridge, pairing
from .bridge import RefusedError
from .kinds import KINDS, Kind
from .matching import Messages
from .pairing import Pair
from .settings import Names, Settings

__all__ = ["Graft", "Settings", "prepare", "transfer_all"]

FILLED = "isograft_filled"
"""Point attribute on the receiver: True where what was received is completed, not found."""


@dataclass
class Graft:
    """Everything one receiver gets."""

    pair: Pair
    kinds: list[Kind]
    messages: Messages = field(default_factory=list)

    def compute(self) -> None:
        """All of it; nothing is written."""
        with pairing.named(self.pair.name):
            for kind in self.kinds:
                kind.compute()
        self.messages = [("WARNING", text) for text in self.pair.arrays.warnings]
        self.messages += [("WARNING", text) for kind in self.kinds for text in kind.warnings]
        filled = int(np.count_nonzero(self._filled))
        if filled:
            text = f"{self.pair.name}: {filled:,} unmatched vertices were filled; the attribute {FILLED} marks them"
            self.messages.append(("WARNING", text))
        parts = [text for kind in self.kinds if (text := kind.summary())]
        self.messages.append(("INFO", f"{self.pair.name}: received {' and '.join(parts) or 'nothing'}"))

    def write(self) -> Messages:
        """Write it all; returns what to report."""
        for kind in self.kinds:
            kind.write()
        if self._filled.any():
            bridge.write_attribute(self.pair.receiver, FILLED, "POINT", "BOOLEAN", self._filled)
        self.pair.receiver.data.update()
        return self.messages

    @property
    def _filled(self) -> Any:
        return np.any([kind.filled for kind in self.kinds], axis=0)


def prepare(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> list[Graft]:
    """Compute what every receiver gets; changes nothing.

    Raises:
        RefusedError: the donor lacks what is asked for, or a receiver's match is missing or no longer fits.
    """
    if not settings.what:
        raise RefusedError("Nothing to transfer; choose what the receivers are to get")
    chosen = [kind for name, kind in KINDS.items() if name in settings.what]
    gifts: dict[tuple[type[Kind], bool], Any] = {}
    grafts = []
    # Whoever is refused is refused before anything is computed.
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
    for graft in grafts:
        graft.compute()
    return grafts


def transfer_all(donor: Any, receivers: list[Any], context: bpy.types.Context, settings: Settings) -> Messages:
    """Compute everything for all receivers, then write; returns what to report.

    Raises:
        RefusedError: as prepare(); nothing was changed.
    """
    grafts = prepare(donor, receivers, context, settings)
    return [message for graft in grafts for message in graft.write()]
