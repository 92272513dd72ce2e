# SPDX-License-Identifier: GPL-3.0-or-later
"""The same surface with more vertices: edges are halved, nothing is moved."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]


def refined(vertices: Floats, faces: Ints, count: int) -> tuple[Floats, Ints]:
    """Halve edges, the longest first, until there are `count` vertices. The old ones stay, and come first.

    Raises:
        ValueError: if there are more than `count` already.
    """
    if len(vertices) > count:
        raise ValueError(f"the mesh has {len(vertices)} vertices, more than {count}")
    while len(vertices) < count:
        edges, of_face, longest = _edges(vertices, faces)
        # An edge may go where it is the longest of all its triangles: no triangle is then cut twice in one round.
        uses = np.bincount(of_face.ravel(), minlength=len(edges))
        claims = np.bincount(longest, minlength=len(edges))
        free = np.flatnonzero(uses == claims)
        length = np.linalg.norm(vertices[edges[free, 0]] - vertices[edges[free, 1]], axis=1)
        order = np.lexsort((free, -length))
        # At most half of them in one round, so that long edges made free by others have their turn.
        keep = min(count - len(vertices), max(1, (len(free) + 1) // 2))
        vertices, faces = _split(vertices, faces, edges, of_face, free[order[:keep]])
    return vertices, faces


def _edges(vertices: Floats, faces: Ints) -> tuple[Ints, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """(e, 2) edges, (k, 3) those of each triangle (edge i runs from corner i), (k,) each one's longest."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    key = ends[:, 0].astype(np.int64) * len(vertices) + ends[:, 1]
    unique, inverse = np.unique(key, return_inverse=True)
    edges = np.stack([unique // len(vertices), unique % len(vertices)], axis=1).astype(np.int32)
    of_face = inverse.reshape(-1, 3)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    # By length and then by number, so that triangles agree on which of two equal edges is the longer.
    rank = np.empty(len(edges), np.int64)
    rank[np.lexsort((np.arange(len(edges)), length))] = np.arange(len(edges))
    longest = of_face[np.arange(len(faces)), np.argmax(rank[of_face], axis=1)]
    return edges, of_face, longest


def _split(
    vertices: Floats, faces: Ints, edges: Ints, of_face: npt.NDArray[np.int64], chosen: npt.NDArray[np.int64]
) -> tuple[Floats, Ints]:
    middle = np.full(len(edges), -1, np.int32)
    middle[chosen] = len(vertices) + np.arange(len(chosen), dtype=np.int32)
    points = 0.5 * (vertices[edges[chosen, 0]] + vertices[edges[chosen, 1]])
    cut = middle[of_face]
    rows = np.flatnonzero((cut >= 0).any(axis=1))
    side = np.argmax(cut[rows] >= 0, axis=1)
    new = cut[rows, side]
    a, b, c = (faces[rows, (side + k) % 3] for k in range(3))
    halved = faces.copy()
    halved[rows] = np.stack([a, new, c], axis=1)
    return np.concatenate([vertices, points]), np.concatenate([halved, np.stack([new, b, c], axis=1)])
