# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys with everything that belongs to them."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any

import bpy
import numpy as np

from .meshes import Array, Evaluated, get_array

_COPIED = ("slider_min", "slider_max", "value", "mute", "interpolation")
"""In this order: a value is clamped to the range that is set."""


@dataclass(frozen=True)
class Key:
    """A shape key; `relative` is the name of the key it is relative to."""

    name: str
    relative: str
    mask_group: str
    points: Array
    """(n, 3) float64, in the object's space."""
    settings: dict[str, Any]
    is_locked: bool = False


def read_keys(obj: bpy.types.Object) -> list[Key]:
    """The shape keys of the object's own mesh, the reference first; empty if there is none."""
    keys = obj.data.shape_keys
    if keys is None:
        return []
    return [
        Key(
            block.name,
            block.relative_key.name,
            block.vertex_group,
            get_array(block.data, "co", np.float32, 3).astype(np.float64),
            {name: getattr(block, name) for name in _COPIED},
            bool(getattr(block, "lock_shape", False)),
        )
        for block in keys.key_blocks
    ]


def are_relative(obj: bpy.types.Object) -> bool:
    """True if the object's shape keys are relative ones, or there are none."""
    return obj.data.shape_keys is None or obj.data.shape_keys.use_relative


def through_modifiers(obj: bpy.types.Object, keys: list[Key]) -> list[Key]:
    """The same keys with the points (m, 3) of the evaluated mesh: each one shown alone, then all put back."""
    with _pinned(obj):
        return [replace(key, points=_shown(obj, index)) for index, key in enumerate(keys)]


def write_keys(obj: bpy.types.Object, keys: list[Key]) -> None:
    """Add the keys or write over those of the same name; makes the reference if there is no key yet."""
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)
    blocks = obj.data.shape_keys.key_blocks
    for key in keys:
        block = blocks.get(key.name) or obj.shape_key_add(name=key.name, from_mix=False)
        block.data.foreach_set("co", np.ascontiguousarray(key.points, dtype=np.float32).ravel())
        for name, value in key.settings.items():
            setattr(block, name, value)
        block.vertex_group = key.mask_group
    for key in keys:
        blocks[key.name].relative_key = blocks[key.relative] if key.relative else blocks[0]
    obj.data.update()


def key_drivers(obj: bpy.types.Object) -> list[Any]:
    """The drivers of the object's shape keys."""
    keys = obj.data.shape_keys
    return list(keys.animation_data.drivers) if keys is not None and keys.animation_data else []


def copy_drivers(donor: bpy.types.Object, receiver: bpy.types.Object, names: dict[str, str]) -> int:
    """Copy the drivers of the keys in `names` (donor's -> receiver's) and return how many.

    What looks at the donor's own keys looks at the receiver's, where those have come along.
    """
    source, target = donor.data.shape_keys, receiver.data.shape_keys
    paths = {_path(old): _path(new) for old, new in names.items()}
    count = 0
    for curve in key_drivers(donor):
        old = next((path for path in paths if curve.data_path.startswith(path)), None)
        if old is None:
            continue
        drivers = (target.animation_data or target.animation_data_create()).drivers
        data_path = paths[old] + curve.data_path[len(old) :]
        there = drivers.find(data_path, index=curve.array_index)
        if there is not None:
            drivers.remove(there)
        made = drivers.from_existing(src_driver=curve)
        made.data_path = data_path
        for variable in made.driver.variables:
            for end in variable.targets:
                mine = next((path for path in paths if end.data_path.startswith(path)), None)
                if end.id == source and mine is not None:
                    end.id = target
                    end.data_path = paths[mine] + end.data_path[len(mine) :]
        count += 1
    return count


def _path(name: str) -> str:
    return f'key_blocks["{bpy.utils.escape_identifier(name)}"]'


def _shown(obj: bpy.types.Object, index: int) -> Array:
    obj.active_shape_key_index = index
    bpy.context.view_layer.update()
    with Evaluated(obj, bpy.context.evaluated_depsgraph_get()) as mesh:
        return get_array(mesh.vertices, "co", np.float32, 3).astype(np.float64)


@contextmanager
def _pinned(obj: bpy.types.Object) -> Iterator[None]:
    """Only the active key is shown, whatever its value, mute or driver."""
    before = obj.show_only_shape_key, obj.active_shape_key_index
    muted = [block.mute for block in obj.data.shape_keys.key_blocks]
    try:
        obj.show_only_shape_key = True
        for block in obj.data.shape_keys.key_blocks:
            block.mute = False
        yield
    finally:
        for block, mute in zip(obj.data.shape_keys.key_blocks, muted, strict=True):
            block.mute = mute
        obj.show_only_shape_key, obj.active_shape_key_index = before
        bpy.context.view_layer.update()
