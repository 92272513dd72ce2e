# SPDX-License-Identifier: GPL-3.0-or-later
"""Custom normals, turned with the surface."""

from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings
from .base import Kind
from .filling import fill_normals


class Normals(Kind):
    """The custom normals of the face corners; unmatched faces keep theirs."""

    noun = "layer"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        if pair.receiver.data.has_custom_normals and not settings.overwrite:
            raise RefusedError(f"{pair.name} has custom normals already; choose Overwrite, or leave normals out")
        mesh = pair.receiver.data
        self._own = bridge.read_corner_normals(mesh) if mesh.has_custom_normals else None
        self._normals: Array = np.zeros((0, 3))

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> Array:
        """(l, 3) in the donor's space."""
        with donor.mesh() as mesh:
            if not mesh.has_custom_normals:
                raise RefusedError(f"{donor.obj.name} has no custom normals; make some first, or leave normals out")
            return bridge.read_corner_normals(mesh)

    def compute(self) -> None:
        """Normals per loop; where unmatched the receiver's custom ones, or 0."""
        pair = self.pair
        # A normal goes with the inverse of the transposed matrix that a point goes with.
        seen = self.gift @ np.linalg.inv(pair.donor.arrays.linear)
        seen /= np.maximum(np.linalg.norm(seen, axis=1, keepdims=True), 1e-30)
        normals, mask = self.move_corners(transfer.transfer_normals, seen, complete=fill_normals)
        back = normals @ pair.arrays.linear
        back /= np.maximum(np.linalg.norm(back, axis=1, keepdims=True), 1e-30)
        self._normals = self.to_loops(back, mask, self._own)
        whole = pair.whole_polygons(mask)
        if not whole.all():
            count = int(np.count_nonzero(~whole))
            text = f"{pair.name}: {count:,} of {len(whole):,} faces are unmatched; they keep their normals"
            self.warnings.append(text)

    def write(self) -> None:
        """The custom normals."""
        bridge.write_corner_normals(self.pair.receiver, self._normals)

    def received(self) -> list[str]:
        """What it is called in the report."""
        return ["of custom normals"]
