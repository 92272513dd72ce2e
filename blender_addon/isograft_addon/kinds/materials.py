# SPDX-License-Identifier: GPL-3.0-or-later
"""Material slots and the material of every face."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import bridge
from ..bridge import Array, RefusedError
from ..job import Progress
from ..pairing import Donor, Pair
from ..settings import Names, Settings
from .base import Kind
from .filling import fill_faces


@dataclass
class Slots:
    """The donor's materials appended to the receiver's slots, and the slot of every receiver polygon."""

    pair: Pair
    materials: list[Any]
    given: Array
    """(p of the donor,) slots."""
    own: list[Any]
    index: Array
    """(p,) slots of the receiver's polygons."""
    given_names: list[str]
    names: list[str] = field(default_factory=list)
    """Of the materials that the receiver gets."""

    @classmethod
    def read(cls, pair: Pair) -> "Slots | None":
        """None if the donor has no material."""
        materials = [slot.material for slot in pair.donor.obj.material_slots]
        if not any(materials):
            return None
        with pair.donor.mesh() as mesh:
            given = bridge.polygon_materials(mesh)
        return cls(
            pair,
            materials,
            given,
            list(pair.receiver.data.materials),
            bridge.own_polygon_materials(pair.receiver),
            [material.name for material in materials if material is not None],
        )

    @property
    def has_any(self) -> bool:
        """True if the receiver gets a material."""
        return bool(self.names)

    def assign(self, polygons: Array, progress: Progress) -> Array:
        """Give the donor's materials to the receiver's polygons of the mask `polygons`.

        A face takes the material of the donor's face under its first corner, one that is to have a material though it
        is unmatched that of the nearest face. Other faces keep theirs; where the receiver had no slot, an empty one is
        made for them. Returns the vertices (n,) that were filled.
        """
        if not self.own and not polygons.all():
            self.own.append(None)
        slot_of = np.zeros(len(self.materials), dtype=np.int32)
        for donor_slot, material in enumerate(self.materials):
            if material not in self.own:
                self.own.append(material)
            slot_of[donor_slot] = self.own.index(material)
        pair = self.pair
        first = np.full(pair.arrays.polygon_count, -1)
        order = np.arange(len(pair.own.polygons))[::-1]
        first[pair.own.polygons[order]] = pair.own.triangles[order, 0]
        face = pair.correspondence.face[first[polygons]]
        found = np.clip(self.given[pair.given.polygons[face]], 0, len(self.materials) - 1)
        self.index[polygons] = np.where(face >= 0, slot_of[found], self.index[polygons])
        self.names = self.given_names
        known = polygons.copy()
        known[polygons] = face >= 0
        completed, filled = fill_faces(pair, self.index, known, progress)
        self.index[polygons] = completed[polygons]
        return filled

    def write(self, obj: Any) -> None:
        """Append the slots, give every polygon its own."""
        bridge.write_polygon_materials(obj, self.own, self.index)


class Materials(Kind):
    """Material slots and per-face materials."""

    noun = "material"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        self._slots = Slots.read(pair)

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> None:
        """Only looks whether there is one."""
        if not any(slot.material for slot in donor.obj.material_slots):
            raise RefusedError(f"{donor.obj.name} has no material; give it one first, or leave materials out")

    def compute(self) -> None:
        """A face takes the material if all its corners are matched."""
        assert self._slots is not None
        pair = self.pair
        whole = pair.whole_polygons(pair.matched[pair.own.triangles].all(axis=1))
        if self.settings.fill:
            self.filled |= self._slots.assign(np.ones_like(whole), self.hold)
        else:
            self._slots.assign(whole, self.hold)

    def write(self) -> None:
        """Slots and faces."""
        assert self._slots is not None
        self._slots.write(self.pair.receiver)

    def received(self) -> list[str]:
        """Names of the materials."""
        assert self._slots is not None
        return self._slots.names
