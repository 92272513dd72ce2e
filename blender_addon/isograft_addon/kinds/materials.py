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
            bridge.polygon_materials(pair.receiver.data),
            [material.name for material in materials if material is not None],
        )

    @property
    def has_any(self) -> bool:
        """True if the receiver gets a material."""
        return bool(self.names)

    def assign(self, polygons: Array, fill: bool, progress: Progress) -> Array:
        """Give the donor's materials to the receiver's polygons of the mask `polygons`.

        A face takes the material of the donor's face under its centre, with `fill` one that is unmatched that of the
        nearest face. Other faces keep theirs; where the receiver had no slot, an empty one is made for those. Returns
        the vertices (n,) that were filled.
        """
        pair = self.pair
        moved = pair.from_face_centres(self.given, progress)
        slots, known = np.clip(moved.values, 0, len(self.materials) - 1), polygons & moved.mask
        filled = np.zeros(len(pair.own.vertices), dtype=bool)
        if fill:
            slots, has_any, filled = fill_faces(pair, slots, known, progress)
            known = polygons & has_any
        if not self.own and not known.all():
            self.own.append(None)
        slot_of = np.zeros(len(self.materials), dtype=np.int32)
        for donor_slot, material in enumerate(self.materials):
            if material not in self.own:
                self.own.append(material)
            slot_of[donor_slot] = self.own.index(material)
        self.index = np.where(known, slot_of[slots], self.index)
        self.names = self.given_names
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
        fill = self.settings.fill
        self.filled |= self._slots.assign(whole | fill, fill, self.hold)

    def write(self) -> None:
        """Slots and faces."""
        assert self._slots is not None
        self._slots.write(self.pair.receiver)

    def received(self) -> list[str]:
        """Names of the materials."""
        assert self._slots is not None
        return self._slots.names
