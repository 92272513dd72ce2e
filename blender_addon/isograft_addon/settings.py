# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a transfer as plain values, and the choice of layers by name."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, fields
from typing import Any, Self, TypeVar

from isograft import names as by_name
from isograft.errors import InvalidInput

from .bridge import RefusedError, attribute_names

Item = TypeVar("Item")


class OfProperties:
    """A dataclass whose fields are called as the properties of an operator."""

    @classmethod
    def of(cls, properties: Any) -> Self:
        """Those of an operator."""
        return cls(**{item.name: getattr(properties, item.name) for item in fields(cls)})


@dataclass(frozen=True)
class Settings(OfProperties):
    """The properties of object.isograft_transfer."""

    what: set[str] = field(default_factory=lambda: {"UV"})
    min_confidence: float = 0.0
    overwrite: bool = False
    link_materials: bool = True
    fill: bool = False
    uv_names: str = ""
    mark_seams: bool = True
    cut_seams: bool = False
    color_names: str = ""
    attribute_names: str = ""
    group_names: str = ""
    mix_mode: str = "REPLACE"
    mix_factor: float = 1.0
    normalise: bool = False
    limit_total: int = 0
    hook_armature: bool = False
    key_names: str = ""
    key_scale: str = "GLOBAL"
    key_smoothing: int = -1
    copy_drivers: bool = True


def choose(items: Iterable[Item], names: str, owner: str, kind: str, name_of: Callable[[Item], str]) -> list[Item]:
    """Those of `items` whose name is in the comma-separated list `names`, which may hold * and ?; all if it is empty.

    Raises:
        RefusedError: a name stands for nothing that `owner` has.
    """
    every = list(items)
    try:
        found = set(by_name.choose([name_of(item) for item in every], names, f"{owner} has no {kind}"))
    except InvalidInput as error:
        raise RefusedError(str(error)) from None
    return [item for item in every if name_of(item) in found]


class Names(by_name.Names):
    """Names in use on a receiver."""

    longest = 63
    """As Blender's own."""

    @classmethod
    def of_layers(cls, mesh: Any, overwrite: bool) -> Self:
        """Those of UV maps and attributes, which share one space of names."""
        return cls({layer.name for layer in mesh.uv_layers} | attribute_names(mesh), overwrite)
