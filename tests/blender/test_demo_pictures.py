# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's pictures show files in any unit, and the receiver as the donor stands."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from demo import pictures, scene


@pytest.mark.parametrize("unit", [0.001, 1.0, 500.0])
def test_camera_and_captions_fit_the_unit(unit: float) -> None:
    scene.clear()
    corners = unit * np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.2, 0.2, 1)], float)
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    items = [scene.add_mesh("low", corners, faces), scene.add_mesh("high", corners + unit * np.array((2, 0, 0)), faces)]
    scene.studio(1, unit)
    scene.frame(items, 52.0, 17.0, 300, below=0.16)
    captions = [scene.caption(text, item, 0.05 * unit) for text, item in zip(("a", "b"), items, strict=True)]
    scene.level(captions)

    camera = bpy.context.scene.camera
    axes = np.array(camera.matrix_world)[:3, :3].T
    place = np.array(camera.matrix_world.translation)
    away = -(scene.world_points(items) - place) @ axes[2]
    assert camera.data.clip_start < 0.5 * away.min()
    assert camera.data.clip_end > 2.0 * away.max()
    ground = scene.world_points([bpy.data.objects["Ground"]])
    assert np.ptp(ground[:, 0]) > 20.0 * unit
    for item in captions:
        assert item.matrix_world.translation.z > 0.5 * item.data.size
    heights = [axes[1] @ np.array(item.matrix_world.translation) for item in captions]
    assert np.ptp(heights) < 1e-3 * unit


@pytest.mark.parametrize(("unit", "seen"), [(1.0, 1.0), (1.2, 1.0), (1000.0, 1.0 / 1000.0), (0.0254, 1.0 / 0.0254)])
def test_a_receiver_is_turned_as_the_donor_stands_and_scaled_only_from_another_unit(unit: float, seen: float) -> None:
    scene.clear()
    random = np.random.default_rng(3)
    points = random.normal(size=(200, 3)) * [1.0, 2.0, 3.0]
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    places = unit * (points @ turn.T) + unit * np.array([4.0, -7.0, 2.0])
    item = scene.add_mesh("receiver", places, [(0, 1, 2)])
    pictures.align([item], places, points + random.normal(scale=0.01, size=points.shape))
    world = scene.world_points([item])
    wanted = unit * seen * points
    off = (world - world.mean(axis=0)) - (wanted - wanted.mean(axis=0))
    assert np.abs(off).max() < 0.02 * np.ptp(wanted)
