# SPDX-License-Identifier: GPL-3.0-or-later
"""The creature's colours as a function of the place on its body; numpy alone."""

from __future__ import annotations

import numpy as np

from demo.creature_shape import place
from demo.implicit import Array, Shape

LABELS = ["horn", "plate", "claw", "eye", "knob", "body"]
BACK, FLANK, BELLY = (0.025, 0.115, 0.135), (0.06, 0.30, 0.27), (0.80, 0.58, 0.30)
STRIPE, BONE, HORN_DARK = (0.012, 0.03, 0.045), (0.83, 0.72, 0.52), (0.16, 0.09, 0.05)
KNOB, KNOB_RIM = (0.60, 0.36, 0.13), (0.13, 0.055, 0.03)
FLAME, EMBER, CLAW, EYE = (0.86, 0.17, 0.03), (0.95, 0.55, 0.08), (0.03, 0.025, 0.03), (0.95, 0.66, 0.05)


def ramp(x: Array, low: float, high: float) -> Array:
    """Smooth step from 0 at `low` to 1 at `high`."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def mix(a: Array, b: Array | tuple[float, ...], t: Array) -> Array:
    return a + (np.asarray(b) - a) * t[:, None]


def swirl(points: Array, wavelength: float, seed: int) -> Array:
    """Smooth random function with values about -1 to 1: a sum of plane waves."""
    rng = np.random.default_rng(seed)
    waves = rng.normal(size=(9, 3))
    waves *= (2 * np.pi / (wavelength * rng.uniform(0.7, 1.4, 9)) / np.linalg.norm(waves, axis=1))[:, None]
    return np.sin(points @ waves.T + rng.uniform(0, 2 * np.pi, 9)).sum(axis=1) / 4.5


def cells(points: Array, size: float) -> tuple[Array, Array]:
    """Worley cells: distance to the cell border in units of `size`, and a random number in [0, 1) per cell."""
    scaled = points / size
    base = np.floor(scaled).astype(np.int64)
    first = np.full(len(points), np.inf)
    second = np.full(len(points), np.inf)
    owner = np.zeros(len(points))
    for offset in np.ndindex(3, 3, 3):
        cell = base + np.array(offset) - 1
        seed = (cell * (73856093, 19349663, 83492791)).sum(axis=1)
        jitter = np.stack([_hash(seed + k) for k in (1, 2, 3)], axis=1)
        d = np.linalg.norm(cell + jitter - scaled, axis=1)
        nearer = d < first
        second = np.where(nearer, first, np.minimum(second, d))
        owner = np.where(nearer, jitter[:, 0], owner)
        first = np.where(nearer, d, first)
    return second - first, owner


def _hash(key: Array) -> Array:
    mixed = (key.astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)) ^ np.uint64(0xD1B54A32D192ED03)
    mixed ^= mixed >> np.uint64(29)
    mixed *= np.uint64(0xBF58476D1CE4E5B9)
    return ((mixed >> np.uint64(40)) & np.uint64(0xFFFFFF)).astype(float) / float(1 << 24)


def _skin(p: Array, normals: Array) -> tuple[Array, Array]:
    forward, up = -p[:, 1], p[:, 2]
    wobble = swirl(p, 0.5, 1)
    axis = np.interp(forward, (-2.8, -1.6, -0.8, 0.5, 0.9, 1.3, 1.8), (0.7, 0.8, 1.0, 1.0, 1.2, 1.6, 1.55))
    height = up - axis + 0.05 * wobble
    colour = mix(np.tile(FLANK, (len(p), 1)), BACK, ramp(height, -0.02, 0.32))
    underside = ramp(-normals[:, 2], 0.05, 0.75) * ramp(up, 0.45, 0.62) * ramp(0.3 - np.abs(p[:, 0]), 0.0, 0.12)
    belly = np.maximum(underside, ramp(-height, 0.16, 0.4) * ramp(up, 0.5, 0.75) * ramp(forward, -1.0, -0.5))
    colour = mix(colour, BELLY, belly)
    legs = ramp(0.75 - up, 0.0, 0.3) * ramp(1.0 - forward, 0.0, 0.1) * ramp(forward, -1.2, -1.1)
    colour = mix(colour, (0.16, 0.30, 0.20), 0.6 * legs * (1 - belly))
    phase = forward * 8.5 + 1.1 * wobble + 2.2 * np.abs(p[:, 0]) + 0.6 * swirl(p, 0.22, 2)
    stripe = ramp(np.sin(2 * np.pi * phase / 2.6) + 0.35 * swirl(p, 0.3, 3), 0.3, 0.62)
    bands = np.sin(2 * np.pi * (up + 0.06 * wobble) / 0.17) + 0.3 * swirl(p, 0.2, 4)
    stripe = np.where(legs > 0.5, ramp(bands, 0.3, 0.7), stripe)
    colour = mix(colour, STRIPE, 0.9 * stripe * (1 - belly) * ramp(1.42 - forward, 0.0, 0.25))
    face = ramp(forward, 1.35, 1.7)
    colour = mix(colour, (0.62, 0.40, 0.22), 0.75 * face * ramp(0.4 + 0.5 * swirl(p, 0.2, 5), 0.0, 0.8))
    flecks, tone = cells(p, 0.13)
    spots = ramp(flecks, 0.35, 0.6) * (tone > 0.45) * (1 - belly) * (1 - stripe) * ramp(height, -0.35, -0.1)
    colour = mix(colour, EMBER, 0.85 * spots * ramp(forward, -2.2, -1.9) * ramp(1.3 - forward, 0, 0.2))
    border, tint = cells(p + 0.008 * np.stack([swirl(p, 0.1, k) for k in (6, 7, 8)], axis=1), 0.042)
    scale = ramp(border, 0.02, 0.22)
    colour = colour * (0.45 + 0.55 * scale)[:, None] * (0.78 + 0.44 * tint)[:, None]
    return colour, 0.55 * scale + 0.2


def paint(shape: Shape, points: Array, normals: Array, crevice: Array) -> tuple[Array, Array]:
    """Linear colour (n, 3) and relief height (n,) in [0, 1] at rest-pose places `points` (n, 3).

    `crevice` (n,) is 0 in folds and 1 in the open, as `openness` gives it.
    """
    d = shape.nearest_label(points, LABELS)
    lead = d[:, 5:] - d  # positive where a part lies nearer than the bare body
    colour, height = _skin(points, normals)
    forward, up = -points[:, 1], points[:, 2]
    knob = ramp(lead[:, 4], 0.0, 0.015)
    colour = mix(colour, mix(np.tile(KNOB_RIM, (len(points), 1)), KNOB, ramp(lead[:, 4], 0.01, 0.035)), 0.9 * knob)
    plate = ramp(lead[:, 1], 0.0, 0.03)
    tip = ramp(up - np.interp(forward, (-1.7, -0.9, 0.1, 0.6, 0.95), (0.96, 1.34, 1.46, 1.58, 1.58)), 0.0, 0.24)
    veins = ramp(np.sin(2 * np.pi * (forward + 0.3 * up) / 0.07 + 2 * swirl(points, 0.3, 9)), 0.2, 0.9)
    flame = mix(
        mix(np.tile((0.33, 0.035, 0.03), (len(points), 1)), FLAME, ramp(tip, 0.1, 0.6)), EMBER, ramp(tip, 0.55, 1.0)
    )
    colour = mix(colour, (1.0 - 0.35 * veins)[:, None] * flame, plate)
    horn = ramp(lead[:, 0], -0.005, 0.012)
    reach = np.linalg.norm(points - np.where(forward > 0, 1, 0)[:, None] * np.array(place(1.3, 0.0, 1.85)), axis=1)
    rings = ramp(np.sin(2 * np.pi * reach / 0.065 + swirl(points, 0.2, 10)), -0.2, 0.6)
    ivory = mix(np.tile(HORN_DARK, (len(points), 1)), BONE, ramp(rings, 0.0, 1.0) * 0.75 + 0.25)
    colour = mix(colour, ivory, horn)
    height = height * (1 - horn) * (1 - plate) + horn * (0.3 + 0.4 * rings) + plate * (0.55 - 0.2 * veins)
    claw = ramp(lead[:, 2], -0.005, 0.01)
    colour, height = mix(colour, CLAW, claw), height * (1 - claw) + 0.5 * claw
    mouth = ramp(0.06 - np.abs(up - 1.53), 0.0, 0.02) * ramp(forward, 1.4, 1.5) * ramp(0.7 - crevice, 0.0, 0.15)
    colour = mix(colour, (0.25, 0.02, 0.03), mouth)
    colour = colour * (0.35 + 0.65 * ramp(crevice, 0.1, 0.95))[:, None]
    return _eyes(points, lead[:, 3], np.clip(colour, 0.0, 1.0), height)


def _eyes(points: Array, lead: Array, colour: Array, height: Array) -> tuple[Array, Array]:
    for side in (1, -1):
        centre = np.array(place(1.465, 0.135 * side, 1.765))
        gaze = np.array(place(0.35, 0.93 * side, 0.1))
        local = points - centre
        eye = ramp(lead, -0.012, -0.004) * (np.linalg.norm(local, axis=1) < 0.085) * (local @ gaze > 0.0)
        along, across = np.abs(local @ np.array(place(0.93, -0.35 * side, 0.0))), np.abs(local[:, 2])
        pupil = ramp(1.0 - np.hypot(along / 0.013, across / 0.042), 0.0, 0.2)
        iris = mix(np.tile(EYE, (len(points), 1)), (0.75, 0.12, 0.01), ramp(np.hypot(along, across), 0.02, 0.05))
        colour = mix(colour, mix(iris, (0.005, 0.005, 0.005), pupil), eye)
        height = height * (1 - eye) + 0.5 * eye
    return colour, height


def openness(shape: Shape, points: Array, normals: Array) -> Array:
    """How free the surface is at each point: value of the shape at several heights above it over the height, 0 to 1."""
    steps = (0.03, 0.06, 0.11)
    free = [np.clip(shape.value(points + step * normals) / step, 0.0, 1.0) for step in steps]
    return np.mean(free, axis=0)
