# SPDX-License-Identifier: GPL-3.0-or-later
"""Implicit shapes: distance-like functions of primitives and their smooth union, in numpy alone.

A `Shape` is a list of parts; its value is negative inside, positive outside and close to a distance near the
surface. Points are (n, 3) arrays; all lengths are in the caller's unit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

Array = np.ndarray
FAR = 1.0


@dataclass(frozen=True)
class Part:
    """One primitive: its distance, the ball outside which it has no effect, and how softly it joins the rest."""

    distance: Callable[[Array], Array]
    centre: Array
    radius: float
    blend: float
    label: str = "body"
    carve: bool = False


def tapered_capsule(
    a: Sequence[float],
    b: Sequence[float],
    radius_a: float,
    radius_b: float,
    *,
    blend: float = 0.1,
    label: str = "body",
    flat: tuple[Sequence[float], float] | None = None,
) -> Part:
    """A capsule from `a` to `b` whose radius changes linearly; `flat=(direction, factor)` thins it."""
    start, end = np.asarray(a, float), np.asarray(b, float)
    axis = end - start
    length2 = float(axis @ axis)
    direction, factor = (np.asarray(flat[0], float), flat[1]) if flat else (np.zeros(3), 1.0)
    if flat:
        direction = direction / np.linalg.norm(direction)

    def distance(points: Array) -> Array:
        offset = points - start
        t = np.clip(offset @ axis / length2, 0.0, 1.0)
        rest = offset - t[:, None] * axis
        if flat:
            across = rest @ direction
            rest = rest + (across * (1.0 / factor - 1.0))[:, None] * direction
        return np.linalg.norm(rest, axis=1) - (radius_a + t * (radius_b - radius_a))

    reach = 0.5 * np.sqrt(length2) + max(radius_a, radius_b)
    return Part(distance, 0.5 * (start + end), reach, blend, label)


def ellipsoid(
    centre: Sequence[float],
    radii: Sequence[float],
    *,
    rotation: Array | None = None,
    blend: float = 0.1,
    label: str = "body",
    carve: bool = False,
) -> Part:
    """An ellipsoid; the columns of `rotation` are its axes. With `carve` it is taken away instead of added."""
    middle, sizes = np.asarray(centre, float), np.asarray(radii, float)

    def distance(points: Array) -> Array:
        local = points - middle
        if rotation is not None:
            local = local @ rotation
        k0 = np.linalg.norm(local / sizes, axis=1)
        k1 = np.linalg.norm(local / sizes**2, axis=1)
        return k0 * (k0 - 1.0) / np.maximum(k1, 1e-9)

    return Part(distance, middle, float(sizes.max()), blend, label, carve)


def curve(
    points: Sequence[Sequence[float]], radii: Sequence[float], *, blend: float = 0.05, label: str = "body"
) -> list[Part]:
    """Tapered capsules along a polyline; only the first one joins the rest softly, so that tips stay slender."""
    pieces = []
    for i in range(len(points) - 1):
        soft = blend if i == 0 else 0.25 * min(radii[i], blend)
        pieces.append(tapered_capsule(points[i], points[i + 1], radii[i], radii[i + 1], blend=soft, label=label))
    return pieces


def smooth_min(a: Array, b: Array, k: float) -> Array:
    """Polynomial smooth minimum; equals min(a, b) where they differ by more than `k`."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.minimum(a, b) - 0.25 * k * h * h


@dataclass
class Shape:
    """Parts in the order in which they are joined, then fine relief added to the value."""

    parts: list[Part] = field(default_factory=list)
    relief: list[Callable[[Array, Array], Array]] = field(default_factory=list)

    def add(self, *parts: Part) -> None:
        self.parts.extend(parts)

    def value(self, points: Array) -> Array:
        """Signed, distance-like value (n,); clipped to FAR where no part is near."""
        points = np.asarray(points, float)
        result = np.full(len(points), FAR)
        for part in self.parts:
            near = np.flatnonzero(self._near(part, points))
            if not len(near):
                continue
            d = part.distance(points[near])
            if part.carve:
                result[near] = -smooth_min(-result[near], d, part.blend)
            else:
                result[near] = smooth_min(result[near], d, part.blend)
        close = np.flatnonzero(np.abs(result) < 0.15)
        if len(close):
            for relief in self.relief:
                result[close] += relief(points[close], result[close])
        return result

    def gradient(self, points: Array, step: float = 2e-3) -> Array:
        """Central differences (n, 3)."""
        columns = [self.value(points + step * axis) - self.value(points - step * axis) for axis in np.eye(3)]
        return np.stack(columns, axis=1) / (2.0 * step)

    def project(self, points: Array, steps: int = 4) -> Array:
        """Points moved onto the zero set by damped Newton steps along the gradient."""
        points = np.array(points, float)
        for _ in range(steps):
            g = self.gradient(points)
            move = self.value(points) / np.maximum((g * g).sum(axis=1), 0.2)
            points -= np.clip(move, -0.03, 0.03)[:, None] * g
        return points

    def nearest_label(self, points: Array, labels: Sequence[str]) -> Array:
        """Distance to the nearest part of each label: (n, #labels), FAR where none is near."""
        out = np.full((len(points), len(labels)), FAR)
        for part in self.parts:
            if part.label in labels and not part.carve:
                near = np.flatnonzero(self._near(part, points))
                column = labels.index(part.label)
                if len(near):
                    out[near, column] = np.minimum(out[near, column], part.distance(points[near]))
        return out

    @staticmethod
    def _near(part: Part, points: Array) -> Array:
        offset = points - part.centre
        return np.einsum("ij,ij->i", offset, offset) < (part.radius + part.blend + 0.2) ** 2
