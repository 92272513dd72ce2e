# SPDX-License-Identifier: GPL-3.0-or-later
"""A lumpy creature as arrays: one smooth surface in two tessellations and two poses, so that the truth is known."""

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]

# Direction, height and width of the bumps: no two alike, so that the shape has no self-symmetry.
_BUMPS = (
    ((0.9, 0.2, 0.5), 0.9, 0.10),
    ((-0.7, 0.6, 0.6), 0.6, 0.06),
    ((0.1, -0.9, 0.3), 0.75, 0.16),
    ((-0.3, -0.4, -0.9), 0.5, 0.08),
    ((0.5, 0.7, -0.5), 0.4, 0.05),
    ((-0.9, -0.3, 0.0), 0.3, 0.12),
)


def surface_points(directions: Array) -> Array:
    """Points of the creature in its first pose over unit directions (n, 3)."""
    radius = np.ones(len(directions))
    for axis, height, width in _BUMPS:
        unit = np.array(axis) / np.linalg.norm(axis)
        radius += height * np.exp(-((directions - unit) ** 2).sum(axis=1) / width)
    return directions * radius[:, None] * np.array([1.0, 0.85, 1.25])


def pose(points: Array) -> Array:
    """The second pose: bent about the y axis, turned and moved."""
    angle = 0.12 * points[:, 2]
    bent = np.stack(
        [
            np.cos(angle) * points[:, 0] + np.sin(angle) * 0.3,
            points[:, 1],
            points[:, 2] - np.sin(angle) * points[:, 0],
        ],
        axis=1,
    )
    c, s = np.cos(2.0), np.sin(2.0)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return bent @ turn.T + np.array([4.0, -1.0, 0.5])


def triangle_sphere(steps: int = 16) -> tuple[Array, Array]:
    """Unit directions and triangles of a divided icosahedron: 10 steps^2 + 2 vertices."""
    g = (1 + 5**0.5) / 2
    corners = np.array(
        [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
         [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    )  # fmt: skip
    faces = np.array(
        [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
         [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7],
         [9, 8, 1]]
    )  # fmt: skip
    points, triangles = [], []
    for face in faces:
        a, b, c = corners[face]
        start = len(points)
        index = {}
        for i in range(steps + 1):
            for j in range(steps + 1 - i):
                index[i, j] = start + len(index)
                points.append(a + (b - a) * i / steps + (c - a) * j / steps)
        for i in range(steps):
            for j in range(steps - i):
                triangles.append((index[i, j], index[i + 1, j], index[i, j + 1]))
                if i + j < steps - 1:
                    triangles.append((index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]))
    return _welded(np.array(points), np.array(triangles))


def quad_sphere(steps: int = 18) -> tuple[Array, Array]:
    """Unit directions and quads of a divided cube: 6 steps^2 + 2 vertices."""
    points, quads = [], []
    ticks = np.tan(np.linspace(-1, 1, steps + 1) * np.pi / 4)
    for axis in range(3):
        for sign in (-1, 1):
            start = len(points)
            for u in ticks:
                for v in ticks:
                    point = np.empty(3)
                    point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = sign, u, v
                    points.append(point)
            for i in range(steps):
                for j in range(steps):
                    k = start + i * (steps + 1) + j
                    quad = (k, k + steps + 1, k + steps + 2, k + 1)
                    quads.append(quad if sign > 0 else quad[::-1])
    return _welded(np.array(points), np.array(quads))


def hexagon_sphere(steps: int = 18) -> tuple[Array, Array]:
    """The quads of quad_sphere(), of an even number of steps, two by two as hexagons that lie in one side each."""
    directions, quads = quad_sphere(steps)
    a, b = quads[0::2].T, quads[1::2].T
    # The quads of every other side wind the other way round.
    ahead = np.stack([a[0], a[1], a[2], b[2], b[3], a[3]], axis=1)
    back = np.stack([a[0], b[0], b[1], a[1], a[2], a[3]], axis=1)
    turned = (np.arange(len(ahead)) // (steps * steps // 2)) % 2 == 0
    return directions, np.where(turned[:, None], back, ahead)


def cube_uv(directions: Array) -> tuple[Array, Array]:
    """UVs of faces given the directions of their corners (f, c, 3): six islands, one per side of a cube.

    Every island fills the middle 60 % of its cell of a 3 by 2 grid. Returns (f, c, 2) and the island (f,).
    """
    island = sides_of(directions)
    axis, side = np.divmod(island, 2)
    cell = np.stack([axis, side], axis=1)
    return (cell[:, None] + _on_side(directions, axis)) / np.array([3.0, 2.0]), island


def sides_of(directions: Array) -> Array:
    """(f,) the side of a cube, 0 to 5, that each face (f, c, 3) lies on by its centre."""
    centre = directions.mean(axis=1)
    axis = np.abs(centre).argmax(axis=1)
    return np.asarray(2 * axis + (centre[np.arange(len(axis)), axis] > 0))


def stacked_uv(directions: Array, island: Array) -> Array:
    """UVs (f, c, 2) of faces (f, c, 3) on the sides (f,): six islands one upon the other, every other one mirrored."""
    inside = _on_side(directions, island // 2)
    mirrored = inside * np.array([-1.0, 1.0]) + np.array([1.0, 0.0])
    return np.where((island % 2 == 1)[:, None, None], mirrored, inside)


def _on_side(directions: Array, axis: Array) -> Array:
    """(f, c, 2) where corners (f, c, 3) lie on the side across an axis (f,), which fills [0.25, 0.75]."""
    along = directions / np.maximum(np.abs(directions[np.arange(len(axis)), :, axis]), 1e-9)[:, :, None]
    first = np.take_along_axis(along, ((axis + 1) % 3)[:, None, None], axis=2)[..., 0]
    second = np.take_along_axis(along, ((axis + 2) % 3)[:, None, None], axis=2)[..., 0]
    return 0.5 + 0.25 * np.clip(np.stack([first, second], axis=2), -1.2, 1.2)


def uv_cell(uv: Array) -> Array:
    """The cell of the grid of cube_uv, the island's number, for UVs (..., 2)."""
    cell = np.floor(uv * np.array([3.0, 2.0])).astype(int)
    return np.asarray(2 * cell[..., 0] + cell[..., 1])


def point_color(directions: Array) -> Array:
    """A smooth colour over the sphere of directions (..., 3): RGBA."""
    return np.concatenate([0.5 + 0.45 * directions, np.ones((*directions.shape[:-1], 1))], axis=-1)


def _welded(points: Array, faces: Array) -> tuple[Array, Array]:
    points = points / np.linalg.norm(points, axis=1)[:, None]
    _, first, inverse = np.unique(points.round(6), axis=0, return_index=True, return_inverse=True)
    return points[first], inverse.reshape(-1)[faces]
