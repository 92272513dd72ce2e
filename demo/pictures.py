# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: the demo's three pictures."""

from __future__ import annotations

import math
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

from demo import scene
from demo.addon import read_attribute
from demo.implicit import Array

UNMATCHED = (0.30, 0.30, 0.31)
# confidence 0, 1/4, ... 1: dark violet over red and orange to light yellow, even in lightness
HEAT = np.array([(0.06, 0.02, 0.20), (0.32, 0.03, 0.32), (0.75, 0.10, 0.12), (0.95, 0.40, 0.03), (0.98, 0.88, 0.35)])
AZIMUTH, ELEVATION = 52.0, 17.0
SCAN_TURN = -38.0


def carried(donor: bpy.types.Object) -> set[str]:
    """What the donor has to give, in the words of the transfer operator."""
    what = set()
    if donor.data.uv_layers:
        what.add("UV")
    if donor.data.color_attributes:
        what.add("COLOR")
    return what


def heat(confidence: Array, matched: Array) -> Array:
    """Linear colours (n, 4): the heat ramp where matched, grey where not."""
    steps = np.linspace(0.0, 1.0, len(HEAT))
    colour = np.stack([np.interp(confidence, steps, HEAT[:, i]) for i in range(3)], axis=1)
    return np.column_stack([np.where(matched[:, None], colour, UNMATCHED), np.ones(len(colour))])


def stand(item: bpy.types.Object, turn: float = 0.0) -> None:
    """Put an object upright (by its property `upright` if it has one), turned, onto the ground at the origin."""
    if "upright" in item:
        item.matrix_world = Matrix(np.array(item["upright"]).reshape(4, 4).tolist())
    root = item.parent or item
    root.matrix_world = Matrix.Rotation(math.radians(turn), 4, "Z") @ root.matrix_world
    bpy.context.view_layer.update()
    points = scene.world_points([item])
    low, high = points.min(axis=0), points.max(axis=0)
    _shift(item, Vector((*(-0.5 * (low + high)[:2]), -low[2])))


def align(items: list[bpy.types.Object], places: Array, points: Array) -> None:
    """Turn objects so that `places` (n, 3) in their own space lie as `points` (n, 3) in the scene do, in the mean.

    They are scaled as well where the one is more than half as large again as the other: a unit, not a size.
    """
    there, here = points - points.mean(axis=0), places - places.mean(axis=0)
    left, spread, right = np.linalg.svd(there.T @ here)
    spread[2] *= np.linalg.det(left @ right)
    turn = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    factor = float(spread.sum() / max(float((here**2).sum()), 1e-300))
    if not 1.5 < max(factor, 1.0 / max(factor, 1e-300)) < math.inf:
        factor = 1.0
    for item in items:
        item.matrix_world = Matrix((factor * turn).tolist()).to_4x4()
    bpy.context.view_layer.update()


def _shift(item: bpy.types.Object, step: Vector) -> None:
    root = item.parent or item
    root.matrix_world = Matrix.Translation(step) @ root.matrix_world
    bpy.context.view_layer.update()


def line_up(items: list[bpy.types.Object], azimuth: float, gap: float) -> None:
    """Stand the objects side by side as seen from `azimuth`; `gap` is a share of their height."""
    a = math.radians(azimuth)
    right = np.array((math.cos(a), math.sin(a), 0.0))
    edge = 0.0
    for item in items:
        across = scene.world_points([item])
        spread = across @ right
        _shift(item, Vector(right * (edge - spread.min())))
        edge += float(np.ptp(spread)) + gap * float(np.ptp(across[:, 2]))


def wear(item: bpy.types.Object, material: bpy.types.Material, bare: str | None) -> list[bpy.types.Material]:
    """Show `material` in every slot but that of the material named `bare`; returns what was there."""
    old = list(item.data.materials)
    for slot, there in enumerate(old):
        if there is None or there.name != bare:
            item.data.materials[slot] = material
    return old


def undress(item: bpy.types.Object, materials: list[bpy.types.Material]) -> None:
    """Give the slots their materials back."""
    for slot, material in enumerate(materials):
        item.data.materials[slot] = material


def arrange(items: list[bpy.types.Object], words: list[str], pixels: int) -> list[bpy.types.Object]:
    """Stand the objects side by side before the camera, hide other meshes, and put words under each: the captions."""
    line_up(items, AZIMUTH, 0.08)
    for item in bpy.context.scene.objects:
        if item.type == "MESH" and item.name != "Ground":
            item.hide_render = item not in items
    height = float(np.ptp(scene.world_points(items)[:, 2]))
    right = np.array([math.cos(math.radians(AZIMUTH)), math.sin(math.radians(AZIMUTH)), 0.0])
    size = max(0.075 * height, 0.016 * float(np.ptp(scene.world_points(items) @ right)))
    for text, item in zip(words, items, strict=True):
        # A letter is about half as wide as the text is high; narrow things stand close together.
        size = min(size, float(np.ptp(scene.world_points([item]) @ right)) / (0.5 * len(text)))
    scene.frame(items, AZIMUTH, ELEVATION, pixels, below=max(0.16, 2.1 * size / height))
    captions = [scene.caption(text, item, size) for text, item in zip(words, items, strict=True)]
    scene.level(captions)
    return captions


def take(
    donor: bpy.types.Object, before: bpy.types.Object, after: bpy.types.Object, out: Path, samples: int = 48
) -> None:
    """Render before_after.png, checker.png and confidence.png into `out`; leaves the three arranged and textured."""
    stand(donor)
    for item in (before, after):
        stand(item, SCAN_TURN if "upright" in item else 0.0)
    size = float(np.ptp(scene.world_points([donor, before]), axis=0).max())
    scene.studio(samples, size)
    bare = before.data.materials[0].name if before.data.materials else None

    made = "upright" in before
    checker = scene.checker_material("Checker", 48.0)
    if donor.data.uv_layers:
        worn = {item: wear(item, checker, bare) for item in (donor, after)}
        words = ["UV map of the model", "UV map on the scan"]
        captions = arrange([donor, after], words if made else ["UV map of the donor", "UV map on the receiver"], 1500)
        scene.render(str(out / "checker.png"))
        remove(captions)
        for item, materials in worn.items():
            undress(item, materials)
    confidence_picture(after, out / "confidence.png")
    words = ["complete model", "partial scan, another pose", "the scan after Isograft"]
    arrange([donor, before, after], words if made else ["donor", "receiver", "after Isograft"], 1800)
    scene.render(str(out / "before_after.png"))


def confidence_picture(after: bpy.types.Object, path: Path) -> None:
    """The receiver from both sides, coloured by confidence, grey where unmatched, with the scale of colours."""
    matched = read_attribute(after, "isograft_face") >= 0
    colours = heat(read_attribute(after, "isograft_confidence"), matched)
    views = []
    for turn in (0.0, 180.0):
        view = after.copy()
        view.data = after.data.copy()
        layer = view.data.color_attributes.new("Heat", "FLOAT_COLOR", "POINT")
        layer.data.foreach_set("color", colours.astype(np.float32).ravel())
        view.data.materials.clear()
        view.data.materials.append(scene.attribute_material("Heat", layer.name))
        bpy.context.scene.collection.objects.link(view)
        view.matrix_world = Matrix.Rotation(math.radians(turn), 4, "Z") @ after.matrix_world
        views.append(view)
    captions = arrange(views, ["confidence 0 to 1, grey: unmatched", "the other side"], 1500)
    ramp = heat(np.linspace(0.0, 1.0, 65), np.ones(65, bool))
    scale = scene.colour_bar(ramp, captions[0])
    scene.render(str(path))
    remove([*views, *captions, scale])


def remove(items: list[bpy.types.Object]) -> None:
    for item in items:
        bpy.data.objects.remove(item)
