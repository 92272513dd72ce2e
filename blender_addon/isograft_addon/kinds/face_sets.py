# SPDX-License-Identifier: GPL-3.0-or-later
"""Face sets of sculpting."""

from typing import Any

import bpy
import numpy as np

from .. import bridge
from ..bridge import Array, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings
from .base import Kind
from .filling import fill_faces

NAME = ".sculpt_face_set"
HIDDEN_BEFORE = (3, 6, 0)
"""Older Blenders do not show face sets to add-ons."""


class FaceSets(Kind):
    """The face set of every face; unmatched faces keep theirs."""

    noun = "layer"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        own = bridge.read_layer(pair.receiver.data, NAME, "FACE", "INT")
        if own is not None and not settings.overwrite:
            raise RefusedError(f"{pair.name} has face sets already; choose Overwrite, or leave face sets out")
        self._sets: Array = np.ones(pair.arrays.polygon_count, dtype=np.int32) if own is None else own

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> Array:
        """(p,) of the donor."""
        if bpy.app.version < HIDDEN_BEFORE:
            raise RefusedError(
                f"Blender {bpy.app.version_string} does not show the face sets of {donor.obj.name} to add-ons; "
                "leave face sets out, or take Blender 3.6 or later"
            )
        with donor.mesh() as mesh:
            sets = bridge.read_layer(mesh, NAME, "FACE", "INT")
        if sets is None:
            raise RefusedError(f"{donor.obj.name} has no face sets; make some in Sculpt Mode, or leave them out")
        return sets

    def compute(self) -> None:
        """The set of the donor's face under each face's centre."""
        pair = self.pair
        moved = pair.from_face_centres(self.gift, self.step())
        self._sets = np.where(moved.mask, moved.values, self._sets)
        if self.settings.fill:
            self._sets, _, self.filled = fill_faces(pair, self._sets, moved.mask, self.hold)

    def write(self) -> None:
        """The face sets."""
        bridge.write_attribute(self.pair.receiver, NAME, "FACE", "INT", self._sets)

    def received(self) -> list[str]:
        """What it is called in the report."""
        return ["of face sets"]
