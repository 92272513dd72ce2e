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


def cube_uv(directions: Array) -> tuple[Array, Array]:
    """UVs of faces given the directions of their corners (f, c, 3): six islands, one per side of a cube.

    Every island fills the middle 60 % of its cell of a 3 by 2 grid. Returns (f, c, 2) and the island (f,).
    """
    centre = directions.mean(axis=1)
    axis = np.abs(centre).argmax(axis=1)
    rows = np.arange(len(axis))
    side = (centre[rows, axis] > 0).astype(int)
    along = directions / np.abs(directions[rows, :, axis])[:, :, None]
    first = np.take_along_axis(along, ((axis + 1) % 3)[:, None, None], axis=2)[..., 0]
    second = np.take_along_axis(along, ((axis + 2) % 3)[:, None, None], axis=2)[..., 0]
    cell = np.stack([axis, side], axis=1)
    inside = 0.5 + 0.25 * np.clip(np.stack([first, second], axis=2), -1.2, 1.2)
    return (cell[:, None] + inside) / np.array([3.0, 2.0]), 2 * axis + side


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
