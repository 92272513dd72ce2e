# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys: displacements carried in the local frames of the two surfaces."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from isograft import transfer

from .. import bridge
from ..bridge import Array, Key, RefusedError
from ..pairing import Donor, Pair
from ..settings import Names, Settings, choose
from .base import Kind
from .filling import fill_points


@dataclass(frozen=True)
class _Gift:
    keys: list[Key]
    """The chosen ones."""
    base: Array
    """(m, 3) the reference's points."""
    displacements: Array
    """(k, m, 3) of every key from the one it is relative to."""
    masks: Array
    """(k, m) weights of the vertex group that limits the key, 1 where there is none."""
    has_drivers: bool


class Keys(Kind):
    """All shape keys or the chosen ones, with value, range, mute, relative key, mask and drivers."""

    noun = "shape key"

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        super().__init__(pair, gift, settings, names)
        obj = pair.receiver
        if not bridge.are_relative(obj):
            raise RefusedError(f"{pair.name} has absolute shape keys; switch Relative on in its Shape Keys panel")
        own = bridge.read_keys(obj)
        self._own = {key.name: key for key in own}
        overwritable = {key.name for key in own[1:] if not key.is_locked}
        claimed = Names(self._own, overwrite=False)
        self._targets: dict[str, str] = {}
        for key in gift.keys:
            written_over = settings.overwrite and key.name in overwritable
            self._targets[key.name] = key.name if written_over else claimed.claim(key.name)
        self._groups = {group.name for group in bridge.read_groups(obj)}
        if "GROUPS" in settings.what:
            with_groups = bridge.read_groups(pair.donor.obj)
            chosen = choose(with_groups, settings.group_names, pair.donor.obj.name, "vertex group", lambda g: g.name)
            self._groups |= {group.name for group in chosen}
        self._moved: list[Key] = []
        self._drivers = 0

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> _Gift:
        """The chosen keys as displacements of the mesh that the match knows."""
        obj = donor.obj
        keys = bridge.read_keys(obj)
        if len(keys) < 2:
            raise RefusedError(f"{obj.name} has no shape key beside a reference; make one, or leave shape keys out")
        if not bridge.are_relative(obj):
            raise RefusedError(f"{obj.name} has absolute shape keys; switch Relative on in its Shape Keys panel")
        chosen = {key.name for key in choose(keys[1:], settings.key_names, obj.name, "shape key", lambda key: key.name)}
        if len(donor.arrays.rest) != len(donor.arrays.vertices):
            keys = bridge.through_modifiers(obj, keys)
            if any(len(key.points) != len(donor.arrays.vertices) for key in keys):
                raise RefusedError(
                    f"{obj.name}: its modifiers make another number of vertices with some shape key; apply or disable "
                    "them and run Match again"
                )
        points = {key.name: key.points for key in keys}
        wanted = [key for key in keys[1:] if key.name in chosen]
        return _Gift(
            wanted,
            keys[0].points,
            np.stack([key.points - points[key.relative] for key in wanted]),
            _masks(donor, wanted),
            bool(bridge.key_drivers(obj)),
        )

    def compute(self) -> None:
        """Points of every key on the receiver."""
        pair, gift, settings = self.pair, self.gift, self.settings
        to_seen, from_seen = pair.donor.arrays.linear.T, np.linalg.inv(pair.arrays.linear).T
        displacements = gift.displacements @ to_seen
        for number, key in enumerate(gift.keys):
            if key.mask_group and key.mask_group not in self._groups:
                displacements[number] *= gift.masks[number][:, None]
        moved = transfer.transfer_shape_keys(
            pair.correspondence,
            pair.arrays.rest @ pair.arrays.linear.T,
            pair.own.triangles,
            gift.base @ to_seen,
            pair.given.triangles,
            displacements,
            scale=settings.key_scale.lower(),
            smoothing=None if settings.key_smoothing < 0 else settings.key_smoothing,
            progress=self.step(),
        )
        values, rows = np.asarray(moved.values), np.asarray(moved.mask)
        if settings.fill:
            flat = np.moveaxis(values, 0, 1).reshape(len(rows), -1)
            flat, rows, filled = fill_points(pair, flat, rows, self.hold)
            values = np.moveaxis(flat.reshape(len(rows), -1, 3), 1, 0)
            self.filled |= filled
        self._assemble(values @ from_seen, rows)
        if not rows.all():
            count = int(np.count_nonzero(~rows))
            text = f"{pair.name}: {count:,} of {len(rows):,} vertices are unmatched; shape keys do not move them"
            self.warnings.append(text)

    def write(self) -> None:
        """The keys, then their drivers."""
        bridge.write_keys(self.pair.receiver, self._moved)
        if self.settings.copy_drivers and self.gift.has_drivers:
            self._drivers = bridge.copy_drivers(self.pair.donor.obj, self.pair.receiver, self._targets)

    def received(self) -> list[str]:
        """Names of the keys."""
        return [key.name for key in self._moved]

    def _assemble(self, displacements: Array, rows: Array) -> None:
        """Absolute points from displacements, each on those of the key that it is relative to."""
        keys = {key.name: key for key in self.gift.keys}
        moves = {key.name: move for key, move in zip(self.gift.keys, displacements, strict=True)}
        base = next(iter(self._own.values())).points if self._own else self.pair.arrays.rest

        def points(name: str, seen: frozenset[str]) -> Array:
            # A key may be relative to one that does not come along, or, in a broken file, to itself.
            if name not in keys or name in seen:
                return base
            result: Array = points(keys[name].relative, seen | {name}) + moves[name]
            old = self._own.get(self._targets[name])
            return result if old is None else np.where(rows[:, None], result, old.points)

        for key in self.gift.keys:
            group = key.mask_group if key.mask_group in self._groups else ""
            relative = self._targets.get(key.relative, "") if key.relative != key.name else ""
            made = points(key.name, frozenset())
            self._moved.append(Key(self._targets[key.name], relative, group, made, key.settings))


def _masks(donor: Donor, keys: list[Key]) -> Array:
    masks = np.ones((len(keys), len(donor.arrays.vertices)))
    groups = {group.name: group.index for group in bridge.read_groups(donor.obj)}
    masked = {number: groups[key.mask_group] for number, key in enumerate(keys) if key.mask_group in groups}
    if masked:
        indices = sorted(set(masked.values()))
        with donor.mesh() as mesh:
            weights = bridge.read_weights(mesh, indices)
        for number, group in masked.items():
            masks[number] = weights[:, indices.index(group)]
    return masks
