# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: install the add-on from its zip, and run its two operators."""

from __future__ import annotations

import time
from collections.abc import Iterable
from pathlib import Path

import addon_utils
import bpy
import numpy as np

from demo.implicit import Array

IS_EXTENSION = bpy.app.version >= (4, 2, 0)
MODULE = "bl_ext.user_default.isograft_addon" if IS_EXTENSION else "isograft_addon"


def install(zip_path: Path) -> None:
    """Install and enable the add-on in the user folder that the environment names.

    Raises:
        RuntimeError: Blender does not enable it.
    """
    if IS_EXTENSION:
        bpy.ops.extensions.package_install_files(filepath=str(zip_path), repo="user_default", enable_on_install=True)
    else:
        bpy.ops.preferences.addon_install(overwrite=True, filepath=str(zip_path))
        bpy.ops.preferences.addon_enable(module=MODULE)
    if addon_utils.check(MODULE) != (True, True):
        raise RuntimeError(f"Blender did not enable the add-on of {zip_path}")


def select(donor: bpy.types.Object, receiver: bpy.types.Object) -> None:
    """The add-on's contract: the active object gives, the other selected one receives."""
    for item in bpy.context.view_layer.objects:
        item.select_set(item in (donor, receiver))
    bpy.context.view_layer.objects.active = donor


def match_and_transfer(donor: bpy.types.Object, receiver: bpy.types.Object, what: Iterable[str]) -> float:
    """Run both operators; returns the seconds that the match took.

    Raises:
        RuntimeError: an operator refuses, with its own words.
    """
    select(donor, receiver)
    start = time.perf_counter()
    if bpy.ops.object.isograft_match() != {"FINISHED"}:
        raise RuntimeError("the match did not finish")
    seconds = time.perf_counter() - start
    if bpy.ops.object.isograft_transfer(what=set(what)) != {"FINISHED"}:
        raise RuntimeError("the transfer did not finish")
    return seconds


def read_attribute(item: bpy.types.Object, name: str, width: int = 1) -> Array:
    """A point attribute of the add-on's: (n,) or (n, width)."""
    data = item.data.attributes[name].data
    if name in ("isograft_face", "isograft_vertex", "isograft_region"):
        values = np.empty(len(data), np.int32)
    else:
        values = np.empty(len(data) * width, np.float32)
    data.foreach_get("vector" if width == 3 else "value", values)
    return values.reshape(-1, width) if width > 1 else values
