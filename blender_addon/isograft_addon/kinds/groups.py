# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups and the armature that moves with them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, RefusedError
from ..bridge.groups import Group
from ..pairing import Donor, Pair
from ..settings import Names, Settings, choose
from .base import Kind
from .filling import fill_points


@dataclass(frozen=True)
class _Gift:
    groups: list[Group]
    weights: Array
    armatures: list[Any]


class Groups(Kind):
    """All vertex groups or the chosen ones, mixed into those of the same name if wanted."""

    noun = "vertex group"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        obj = pair.receiver
        own = {group.name: group for group in bridge.read_groups(obj)}
        claimed = Names(own, settings.overwrite)
        self._targets = [claimed.claim(group.name) for group in gift.groups]
        self._locked = np.array([name in own and own[name].is_locked for name in self._targets], dtype=bool)
        self._own = np.zeros((len(pair.own.vertices), len(self._targets)), dtype=np.float32)
        there = [column for column, name in enumerate(self._targets) if name in own]
        if there:
            indices = [own[self._targets[column]].index for column in there]
            self._own[:, there] = bridge.read_weights(obj.data, indices)
        if settings.hook_armature:
            self._refuse_other_names(own)
        self._weights = self._own
        self._rows = np.zeros(len(self._own), dtype=bool)

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> _Gift:
        """The chosen groups with their weights, and the armatures if they are to be hooked up."""
        obj = donor.obj
        groups = bridge.read_groups(obj)
        if not groups:
            raise RefusedError(f"{obj.name} has no vertex group; weight it first, or leave vertex groups out")
        groups = choose(groups, settings.group_names, obj.name, "vertex group", lambda group: group.name)
        armatures = bridge.armature_modifiers(obj) if settings.hook_armature else []
        if settings.hook_armature and not armatures:
            raise RefusedError(
                f"{obj.name} has no armature modifier with an armature; give it one, or switch Hook Up Armature off"
            )
        with donor.mesh() as mesh:
            return _Gift(groups, bridge.read_weights(mesh, [group.index for group in groups]), armatures)

    def compute(self) -> None:
        """Move, fill, mix, limit, normalise."""
        pair, settings = self.pair, self.settings
        moved = transfer.transfer_weights(
            pair.correspondence, pair.given.triangles, self.gift.weights, progress=self.step()
        )
        values, self._rows = np.asarray(moved.values), np.asarray(moved.mask)
        if settings.fill:
            values, self._rows, filled = fill_points(pair, values, self._rows, self.hold, low=0.0, high=1.0)
            self.filled |= filled
        mixed = transfer.mix_weights(
            self._own,
            values,
            mode=settings.mix_mode.lower(),
            mix=settings.mix_factor,
            mask=self._rows,
            locked=self._locked,
        )
        self._weights = self._tidy(mixed)
        if not self._rows.all():
            count = int(np.count_nonzero(~self._rows))
            self.warnings.append(
                f"{pair.name}: {count:,} of {len(self._rows):,} vertices are unmatched; their weights are as they were"
            )
        if self._locked.any():
            names = ", ".join(name for name, locked in zip(self._targets, self._locked, strict=True) if locked)
            self.warnings.append(f"{pair.name}: locked vertex groups are as they were: {names}")

    def write(self) -> None:
        """The groups, then the armatures."""
        obj = self.pair.receiver
        for column, name in enumerate(self._targets):
            if not self._locked[column]:
                bridge.write_weights(obj, name, self._weights[:, column], self._rows)
        bridge.write_armatures(obj, self.gift.armatures)

    def received(self) -> list[str]:
        """Names of the groups that were written."""
        return [name for name, locked in zip(self._targets, self._locked, strict=True) if not locked]

    def _tidy(self, weights: Array) -> Array:
        """Limited and normalised among the groups that deform, or among all where none does."""
        settings = self.settings
        if not settings.normalise and not settings.limit_total:
            return weights
        deforming = np.array([group.is_deforming for group in self.gift.groups], dtype=bool)
        columns = np.flatnonzero(deforming if deforming.any() else np.ones_like(deforming))
        tidy = weights.copy()
        tidy[:, columns] = transfer.tidy_weights(
            weights[:, columns],
            normalise=settings.normalise,
            limit=settings.limit_total or None,
            locked=self._locked[columns],
            mask=self._rows,
        )
        return tidy

    def _refuse_other_names(self, own: dict[str, Group]) -> None:
        """An armature finds its groups by name: one that had to take another name would move nothing."""
        renamed = [
            group.name
            for group, target in zip(self.gift.groups, self._targets, strict=True)
            if group.is_deforming and target != group.name
        ]
        if renamed:
            raise RefusedError(
                f"{self.pair.name} has vertex groups of its bones already ({', '.join(renamed[:4])}); "
                "choose Overwrite, or switch Hook Up Armature off"
            )
