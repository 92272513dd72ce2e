# SPDX-License-Identifier: GPL-3.0-or-later
"""Closest points of a triangle mesh, with numpy alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_GROUP = 32
_BATCH = 512


def closest_points(points: Floats, vertices: Floats, faces: npt.NDArray[np.integer]) -> tuple[Ints, Floats, Floats]:
    """The closest point of a mesh to every point: triangle (n,), weights of its corners (n, 3), distance (n,).

    Exact. Triangles are taken in groups along a space-filling order; a group is looked into only where its box is
    nearer than what has been found.
    """
    triangles = np.asarray(vertices, float)[np.asarray(faces)]
    order = np.argsort(_morton(triangles.mean(axis=1)), kind="stable")
    order = np.append(order, np.full(-len(order) % _GROUP, order[-1])).reshape(-1, _GROUP)
    low = triangles[order].min(axis=(1, 2))
    high = triangles[order].max(axis=(1, 2))

    face = np.full(len(points), -1, np.int64)
    weights = np.zeros((len(points), 3))
    square = np.full(len(points), np.inf)
    if not len(points):
        return face, weights, square
    sequence = np.argsort(_morton(points), kind="stable")
    for start in range(0, len(points), _BATCH):
        rows = sequence[start : start + _BATCH]
        outside = np.maximum(np.maximum(low - points[rows, None], points[rows, None] - high), 0.0)
        bound = np.einsum("ijk,ijk->ij", outside, outside)
        groups = np.argsort(bound, axis=1)
        bound = np.take_along_axis(bound, groups, axis=1)
        for rank in range(groups.shape[1]):
            open_rows = np.flatnonzero(bound[:, rank] < square[rows])
            if not len(open_rows):  # bounds ascend: no later group can be nearer either
                break
            at = rows[open_rows]
            candidates = order[groups[open_rows, rank]]
            w, d = _closest_on_triangles(points[at, None], triangles[candidates])
            best = np.argmin(d, axis=1)[:, None]
            d_best = np.take_along_axis(d, best, axis=1)[:, 0]
            better = d_best < square[at]
            at = at[better]
            square[at] = d_best[better]
            face[at] = np.take_along_axis(candidates, best, axis=1)[better, 0]
            weights[at] = np.take_along_axis(w, best[:, :, None], axis=1)[better, 0]
    return face, weights, np.sqrt(square)


def _morton(points: Floats) -> Ints:
    """Position along a space-filling curve, 10 bits an axis."""
    low = points.min(axis=0)
    cell = np.ptp(points, axis=0).max() or 1.0
    grid = np.clip((points - low) / cell * 1023.0, 0, 1023).astype(np.int64)
    code = np.zeros(len(points), np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((grid[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code


def _closest_on_triangles(points: Floats, triangles: Floats) -> tuple[Floats, Floats]:
    """Weights (..., 3) and squared distance (...) of the closest point of each triangle (..., 3, 3)."""
    corner, along, beside = triangles[..., 0, :], triangles[..., 1, :], triangles[..., 2, :]
    u, v, p = along - corner, beside - corner, points - corner
    uu, uv, vv = _dot(u, u), _dot(u, v), _dot(v, v)
    pu, pv = _dot(p, u), _dot(p, v)
    area = uu * vv - uv * uv
    divisor = np.where(area > 0.0, area, 1.0)
    s = (vv * pu - uv * pv) / divisor
    t = (uu * pv - uv * pu) / divisor
    inside = (area > 0.0) & (s >= 0.0) & (t >= 0.0) & (s + t <= 1.0)
    weights = np.stack([1.0 - s - t, s, t], axis=-1)
    best = np.where(inside, _square(points, triangles, np.where(inside[..., None], weights, 0.0)), np.inf)
    # Otherwise it lies on an edge.
    for k in range(3):
        n = (k + 1) % 3
        edge = triangles[..., n, :] - triangles[..., k, :]
        length = _dot(edge, edge)
        share = np.clip(_dot(points - triangles[..., k, :], edge) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        candidate = np.zeros_like(weights)
        candidate[..., k] = 1.0 - share
        candidate[..., n] = share
        square = _square(points, triangles, candidate)
        nearer = square < best
        best = np.where(nearer, square, best)
        weights = np.where(nearer[..., None], candidate, weights)
    return weights, best


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("...i,...i->...", a, b))


def _square(points: Floats, triangles: Floats, weights: Floats) -> Floats:
    offset = points - np.einsum("...i,...ij->...j", weights, triangles)
    return _dot(offset, offset)
