# SPDX-License-Identifier: GPL-3.0-or-later
"""The paper's way to show a map: a texture of S carried to T, red where T has no correspondence in S."""

from __future__ import annotations

import colorsys
from typing import Any

import numpy as np
import scipy.spatial

from experiments.shapes import midpoints

RED = np.array((0.75, 0.02, 0.02))


def source_colours(points: np.ndarray, low: np.ndarray, size: float) -> np.ndarray:
    """A checkerboard in space whose hue drifts along the body: (n, 3), linear."""
    cell = size / 26.0
    dark = np.floor((points - low) / cell + 1e-6).sum(axis=1) % 2 < 1
    share = (points - low) / size
    hue = (0.18 + 0.62 * share[:, int(np.argmax(np.ptp(points, axis=0)))] + 0.12 * share.min(axis=1)) % 1.0
    bright = np.array([colorsys.hsv_to_rgb(h, 0.75, 0.85) for h in hue])
    return np.where(dark[:, None], 0.16 * bright, bright)


def refined(vertices: np.ndarray, faces: np.ndarray, least: int = 30_000) -> tuple[np.ndarray, np.ndarray]:
    """Cut triangles until there are `least` vertices, so that colours of vertices show the cells."""
    while len(vertices) < least:
        vertices, faces = midpoints(vertices, faces)
    return vertices, faces


def carried_colours(source: Any, target_points: np.ndarray, found: Any) -> np.ndarray:
    """Colours of points of T from the points of S whose images are nearest; red where none is near."""
    vertices, faces = source
    low, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max())
    matched = np.isfinite(found["points"]).all(axis=1)
    places, images = vertices[matched], found["points"][matched]
    if faces is not None:
        usable = faces[matched[faces].all(axis=1)]
        corners, ends = vertices[usable], found["points"][usable]
        longest = [np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2).max(axis=1) for x in (corners, ends)]
        whole = longest[1] < 3.0 * np.median(longest[1] / np.maximum(longest[0], 1e-300)) * longest[0]
        weights = np.array([(a, b, 6 - a - b) for a in range(7) for b in range(7 - a)]) / 6.0
        places = np.einsum("kc,fcx->fkx", weights, corners[whole]).reshape(-1, 3)
        images = np.einsum("kc,fcx->fkx", weights, ends[whole]).reshape(-1, 3)
    colours = np.tile(RED, (len(target_points), 1))
    if len(images) == 0:
        return colours
    distance, nearest = scipy.spatial.cKDTree(images).query(target_points)
    spacing = np.median(scipy.spatial.cKDTree(images).query(images[:: max(1, len(images) // 2000)], k=2)[0][:, 1])
    reach = max(4.0 * float(spacing), 0.012 * float(np.ptp(target_points, axis=0).max()))
    near = distance < reach
    colours[near] = source_colours(places[nearest[near]], low, size)
    return colours
