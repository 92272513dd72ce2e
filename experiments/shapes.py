# SPDX-License-Identifier: GPL-3.0-or-later
"""The two synthetic pairs: planes, one with peaks, and a body that a half turn maps onto itself."""

from __future__ import annotations

import numpy as np
from isograft.evaluation import Truth
from isograft.truth import as_truth

from benchmarks.cases import Case

#: Centres of the peaks, their radius and height, on the unit square.
PEAKS = np.array([(0.30, 0.30), (0.70, 0.35), (0.45, 0.72)])
RADIUS, HEIGHT = 0.08, 0.25


def grid(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """The unit square in z = 0, each cell cut into two triangles, the diagonals alternating."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, cells + 1), np.linspace(0.0, 1.0, cells + 1))
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    i, j = np.meshgrid(np.arange(cells), np.arange(cells))
    a = (j * (cells + 1) + i).ravel()
    b, c, d = a + 1, a + cells + 1, a + cells + 2
    even = (i + j).ravel() % 2 == 0
    first = np.where(even[:, None], np.column_stack([a, b, d]), np.column_stack([a, b, c]))
    second = np.where(even[:, None], np.column_stack([a, d, c]), np.column_stack([b, d, c]))
    return vertices, np.vstack([first, second]).astype(np.int32)


def planes(cells: int = 48) -> tuple[Case, np.ndarray]:
    """A plane, the same with three peaks, the truth outside the peaks, and two true matches in the near corners, so
    that the way from one to the other leads past the peaks."""
    vertices, faces = grid(cells)
    peaked = vertices.copy()
    off = np.linalg.norm(vertices[:, None, :2] - PEAKS[None], axis=2).min(axis=1)
    on_peak = off < RADIUS
    peaked[on_peak, 2] = 0.5 * HEIGHT * (1.0 + np.cos(np.pi * off[on_peak] / RADIUS))
    truth = np.where(on_peak, -1, np.arange(len(vertices)))
    corner = 4 * (cells + 1) + 4
    other = corner + cells - 8
    landmarks = np.array([(corner, corner), (other, other)], np.int32)
    return Case((vertices, faces), (peaked, faces), _truth(truth), True), landmarks


def symmetric_body(levels: int = 4) -> Case:
    """A bumpy closed body without mirror symmetry that a half turn about z maps onto itself, and its copy, bent a
    little."""
    vertices, faces = icosphere(levels)
    bumps = [(0.9, 0.1, 0.35, 0.55), (0.2, 0.8, -0.5, 0.40), (0.1, 0.35, 0.9, 0.25), (0.5, -0.6, -0.3, 0.30)]
    radius = np.ones(len(vertices))
    for x, y, z, height in bumps:
        for sign in (1.0, -1.0):
            centre = np.array((sign * x, sign * y, z)) / np.linalg.norm((x, y, z))
            radius += height * np.exp(-np.square((vertices - centre) / 0.38).sum(axis=1))
    source = vertices * radius[:, None]
    bend = 0.06 * source[:, 2:3] ** 2 * np.array([(1.0, 0.4, 0.0)])
    return Case((source, faces), (source + bend, faces), _truth(np.arange(len(source))), True)


def icosphere(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """The unit sphere as an icosahedron with every triangle cut into 4^levels."""
    g = (1.0 + np.sqrt(5.0)) / 2.0
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g)]
    vertices += [(g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    text = (
        "0 11 5 0 5 1 0 1 7 0 7 10 0 10 11 1 5 9 5 11 4 11 10 2 10 7 6 7 1 8 "
        "3 9 4 3 4 2 3 2 6 3 6 8 3 8 9 4 9 5 2 4 11 6 2 10 8 6 7 9 8 1"
    )
    faces = np.fromstring(text, np.int64, sep=" ").reshape(-1, 3)
    points = np.array(vertices, float)
    for _ in range(levels):
        points, faces = midpoints(points, faces)
    return points / np.linalg.norm(points, axis=1, keepdims=True), faces.astype(np.int32)


def midpoints(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Every triangle cut into four at the middles of its edges; the old vertices come first."""
    edges = np.sort(np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = index.reshape(3, -1) + len(vertices)
    a, b, c = faces.T
    cut = [np.column_stack(t) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    return np.vstack([vertices, 0.5 * (vertices[unique[:, 0]] + vertices[unique[:, 1]])]), np.vstack(cut)


def _truth(vertex: np.ndarray) -> Truth:
    return as_truth(vertex.astype(np.int64))
