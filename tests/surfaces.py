# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that the tests share. All are made here, the same on every machine."""

from __future__ import annotations

import functools

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Mesh = tuple[Floats, Ints]


def icosahedron() -> Mesh:
    """12 vertices on the unit sphere, 20 triangles, wound outward."""
    g = (1.0 + 5.0**0.5) / 2.0
    vertices = np.array(
        [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
         [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    )  # fmt: skip
    faces = np.array(
        [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6],
         [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
         [8, 6, 7], [9, 8, 1]]
    )  # fmt: skip
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces


def sphere(subdivisions: int) -> Mesh:
    """The icosahedron with every triangle cut in four, `subdivisions` times, on the unit sphere."""
    vertices, faces = icosahedron()
    for _ in range(subdivisions):
        ends = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, edge_of = np.unique(ends, axis=0, return_inverse=True)
        middle = edge_of.reshape(-1, 3) + len(vertices)
        points = vertices[edges].mean(axis=1)
        vertices = np.vstack([vertices, points / np.linalg.norm(points, axis=1, keepdims=True)])
        a, b, c = faces.T
        ab, bc, ca = middle.T
        faces = np.vstack([np.stack(t, axis=1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return vertices, faces


@functools.cache
def _blob(subdivisions: int) -> Mesh:
    directions, faces = sphere(subdivisions)
    # Bumps of different widths and heights at places without symmetry: every point looks different.
    rng = np.random.default_rng(7)
    places = rng.normal(size=(14, 3))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    heights = rng.uniform(0.15, 0.5, 14)
    widths = rng.uniform(0.2, 0.45, 14)
    angles = np.arccos(np.clip(directions @ places.T, -1.0, 1.0))
    radius = 1.0 + (heights * np.exp(-((angles / widths) ** 2))).sum(axis=1)
    return directions * radius[:, None] * [1.0, 1.25, 0.8], faces


def blob(subdivisions: int = 4) -> Mesh:
    """A closed surface of one piece without any symmetry; 10 * 4**subdivisions + 2 vertices, about 2.5 across."""
    vertices, faces = _blob(subdivisions)
    return vertices.copy(), faces.copy()


def rotation(seed: int = 3) -> Floats:
    """A rotation by no special angle about no special axis."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def without(mesh: Mesh, dropped: npt.NDArray[np.bool_]) -> tuple[Mesh, Ints]:
    """The mesh less the vertices where `dropped`, and per old vertex its new index or -1."""
    vertices, faces = mesh
    index = np.where(dropped, -1, np.cumsum(~dropped) - 1)
    return (vertices[~dropped], index[faces[~dropped[faces].any(axis=1)]]), index


def area(mesh: Mesh) -> float:
    a, b, c = (mesh[0][mesh[1][:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def sample_spacing(mesh: Mesh, samples: int = 1000) -> float:
    """Distance of neighbours among `samples` points spread evenly (hexagonally) over the surface."""
    return float(np.sqrt(2.0 / np.sqrt(3.0) * area(mesh) / samples))
