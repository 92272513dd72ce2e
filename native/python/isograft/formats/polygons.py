# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygons to triangles, with the way back. Deterministic: equal polygons give equal triangles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from isograft.formats.mesh import MeshFile, Polygons

Floats = npt.NDArray[np.float64]
Ints64 = npt.NDArray[np.int64]


def triangulate(path: str, polygons: Polygons) -> MeshFile:
    """Cut every polygon into size - 2 triangles that cover it, concave ones too, if it is planar and simple.

    Triangles stay in the order of their polygons. Polygons of fewer than three corners give none and are counted in
    the warnings. Normals of vertices become those of the polygons' corners.
    """
    sizes = polygons.sizes.astype(np.int64)
    if polygons.normals is not None and len(sizes):
        polygons.layers.normals = polygons.normals[polygons.corners]
    starts = np.cumsum(sizes) - sizes
    counts = np.maximum(sizes - 2, 0)
    first = np.cumsum(counts) - counts
    local = np.empty((int(counts.sum()), 3), np.int64)
    owner = np.repeat(np.arange(len(sizes)), counts)
    for size in np.unique(sizes[sizes >= 3]):
        group = np.flatnonzero(sizes == size)
        triangles = _cut(polygons.vertices, polygons.corners, starts[group], int(size))
        local[first[group][:, None] + np.arange(size - 2)] = triangles
    corners = local + starts[owner][:, None]
    degenerate = int((sizes < 3).sum())
    if degenerate:
        polygons.warnings.append(f"{degenerate} polygons have fewer than three corners and were passed over")
    return MeshFile(
        path=path,
        vertices=polygons.vertices,
        faces=np.ascontiguousarray(polygons.corners[corners], dtype=np.int32),
        triangle_polygon=owner.astype(np.int32),
        triangle_corners=corners.astype(np.int32),
        polygons=polygons,
    )


def _cut(vertices: Floats, corners: npt.NDArray[np.int32], starts: Ints64, size: int) -> Ints64:
    """(g, size - 2, 3) corners, counted from 0 in each of g polygons of one size."""
    fan = np.stack([np.zeros(size - 2, np.int64), np.arange(1, size - 1), np.arange(2, size)], axis=1)
    if size == 3:
        return np.broadcast_to(fan, (len(starts), 1, 3))
    points = vertices[corners[starts[:, None] + np.arange(size)]]
    # Newell's normal: right for concave and slightly bent polygons too.
    following = np.roll(points, -1, axis=1)
    centre = points.mean(axis=1, keepdims=True)
    normal = np.cross(points - centre, following - centre).sum(axis=1)
    turn = np.cross(points - np.roll(points, 1, axis=1), following - points)
    with np.errstate(invalid="ignore", over="ignore"):
        convex = (np.einsum("gsi,gi->gs", turn, normal) >= 0).all(axis=1)
    triangles = np.broadcast_to(fan, (len(starts), size - 2, 3)).copy()
    if size == 4:
        # The shorter diagonal makes the better triangles, and of a bent quad the flatter surface.
        diagonal = np.linalg.norm(points[:, [0, 1]] - points[:, [2, 3]], axis=2)
        other = convex & (diagonal[:, 1] < diagonal[:, 0])
        triangles[other] = [[0, 1, 3], [1, 2, 3]]
    for index in np.flatnonzero(~convex):
        triangles[index] = _clip_ears(points[index], normal[index])
    return triangles


def _clip_ears(points: Floats, normal: Floats) -> list[list[int]]:
    """Triangles of one concave polygon, by cutting off ears; a fan of what is left where none is an ear."""
    axis = int(np.argmax(np.abs(normal)))
    flat = np.delete(points, axis, axis=1)
    if (normal[axis] < 0) != (axis == 1):
        flat = flat[:, ::-1]
    left = list(range(len(points)))
    triangles = []
    while len(left) > 3:
        ear = next((i for i in range(len(left)) if _is_ear(flat, left, i)), None)
        if ear is None:
            break
        triangles.append([left[ear - 1], left[ear], left[(ear + 1) % len(left)]])
        del left[ear]
    triangles.extend([left[0], left[i], left[i + 1]] for i in range(1, len(left) - 1))
    return triangles


def _is_ear(flat: Floats, left: list[int], i: int) -> bool:
    before, at, after = left[i - 1], left[i], left[(i + 1) % len(left)]
    a, b, c = flat[before], flat[at], flat[after]
    if _cross(b - a, c - a) <= 0:
        return False
    others = flat[[j for j in left if j not in (before, at, after)]]
    inside = (_cross(b - a, others - a) >= 0) & (_cross(c - b, others - b) >= 0) & (_cross(a - c, others - c) >= 0)
    # A corner of the same position (a cut to a hole) does not spoil the ear.
    inside &= (others != a).any(axis=1) & (others != b).any(axis=1) & (others != c).any(axis=1)
    return not inside.any()


def _cross(u: Floats, v: Floats) -> Floats:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
