# SPDX-License-Identifier: GPL-3.0-or-later
"""Depth maps to one open triangle mesh, and where each of its vertices lies on the true surface; numpy alone.

The depth maps are fused into a truncated signed distance grid (Curless and Levoy 1996); its zero set is taken only
where some camera has looked, so that unseen places stay holes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from demo.creature_mesh import components, crowded_edges, keep_vertices, pinched_vertices
from demo.implicit import Array
from demo.isosurface import surface_nets


@dataclass(frozen=True)
class Camera:
    """A pinhole camera: `axes` rows are right, up and forward; `width` x `height` pixels over `angle` radians."""

    place: Array
    axes: Array
    angle: float
    width: int
    height: int

    @staticmethod
    def looking(place: Array, target: Array, angle: float, width: int, height: int) -> Camera:
        forward = (target - place) / np.linalg.norm(target - place)
        right = np.cross(forward, (0.0, 0.0, 1.0))
        right /= np.linalg.norm(right)
        return Camera(place, np.stack([right, np.cross(right, forward), forward]), angle, width, height)

    @property
    def focal(self) -> float:
        """Focal length in pixels."""
        return 0.5 * self.width / float(np.tan(0.5 * self.angle))

    def rays(self) -> Array:
        """Unit directions through the pixel centres, row by row (height * width, 3)."""
        rows, columns = np.mgrid[0 : self.height, 0 : self.width]
        x = (columns - 0.5 * (self.width - 1)) / self.focal
        y = -(rows - 0.5 * (self.height - 1)) / self.focal
        directions = np.stack([x, y, np.ones_like(x)], axis=-1).reshape(-1, 3) @ self.axes
        return directions / np.linalg.norm(directions, axis=1, keepdims=True)

    def pixels(self, points: Array) -> tuple[Array, Array]:
        """Continuous (row, column) of each point (n, 2) and its distance from the camera (n,)."""
        local = (points - self.place) @ self.axes.T
        depth = np.maximum(local[:, 2], 1e-6)
        column = self.focal * local[:, 0] / depth + 0.5 * (self.width - 1)
        row = -self.focal * local[:, 1] / depth + 0.5 * (self.height - 1)
        return np.stack([row, column], axis=1), np.linalg.norm(local, axis=1)


def ranges_at(ranges: Array, pixels: Array, jump: float) -> Array:
    """Range map read bilinearly at continuous pixels; NaN outside, at misses and across jumps of the surface."""
    height, width = ranges.shape
    low = np.floor(pixels).astype(int)
    inside = ((low >= 0) & (low < (height - 1, width - 1))).all(axis=1)
    row, column = np.where(inside[:, None], low, 0).T
    fr, fc = (pixels - low).T
    four = np.stack(
        [ranges[row, column], ranges[row, column + 1], ranges[row + 1, column], ranges[row + 1, column + 1]]
    )
    mix = np.stack([(1 - fr) * (1 - fc), (1 - fr) * fc, fr * (1 - fc), fr * fc])
    smooth = np.isfinite(four).all(axis=0) & (np.ptp(np.nan_to_num(four), axis=0) < jump)
    return np.where(inside & smooth, (four * mix).sum(axis=0), np.nan)


def facing(camera: Camera, ranges: Array) -> Array:
    """Cosine between ray and surface normal at each pixel, from differences of the range map; NaN at its rims."""
    rays = camera.rays().reshape(camera.height, camera.width, 3)
    hits = rays * ranges[..., None]
    across, down = np.full_like(hits, np.nan), np.full_like(hits, np.nan)
    across[:, 1:-1] = hits[:, 2:] - hits[:, :-2]
    down[1:-1] = hits[2:] - hits[:-2]
    normal = np.cross(across, down)
    length = np.linalg.norm(normal, axis=2)
    return np.abs((normal * rays).sum(axis=2)) / np.where(length > 0, length, np.nan)


def fuse(cameras: list[Camera], range_maps: list[Array], spacing: float, truncation: float) -> tuple[Array, Array]:
    """Open triangle mesh of the fused range maps: vertices (n, 3), triangles (m, 3).

    A range map holds distances along the rays, NaN where a ray hits nothing; `truncation` is the distance from the
    surface to which a map counts. Vertices whose neighbourhood would not be a manifold are dropped, and so are pieces
    of fewer than 40 vertices.
    """
    hits = [c.place + r.reshape(-1, 1) * c.rays() for c, r in zip(cameras, range_maps, strict=True)]
    cloud = np.concatenate([h[np.isfinite(h).all(axis=1)] for h in hits])
    origin = cloud.min(axis=0) - 2.5 * truncation
    counts = np.ceil((cloud.max(axis=0) + 2.5 * truncation - origin) / spacing).astype(int) + 1
    near = _near_cloud(cloud, origin, spacing, counts, int(np.ceil(truncation / spacing)) + 1)
    points = origin + spacing * np.argwhere(near)
    total, weight = np.zeros(len(points)), np.zeros(len(points))
    for camera, ranges in zip(cameras, range_maps, strict=True):
        pixels, distance = camera.pixels(points)
        # Along an oblique ray the surface is nearer than the range tells: the cosine makes it a distance again.
        slant = ranges_at(facing(camera, ranges), pixels, 1.0)
        signed = (ranges_at(ranges, pixels, 4.0 * spacing) - distance) * np.maximum(slant, 0.15)
        seen = np.isfinite(signed) & (np.abs(signed) < truncation)
        # What lies behind the seen surface is less certain the deeper it lies.
        trust = slant * np.where(signed >= 0, 1.0, np.clip(1.0 + signed / truncation, 0.02, 1.0) ** 2)
        total[seen] += (trust * signed)[seen]
        weight[seen] += trust[seen]
    values = np.ones(tuple(counts))
    known = np.zeros(tuple(counts), bool)
    known[near] = weight > 0
    values[near] = np.where(weight > 0, total / np.maximum(weight, 1e-9), 1.0)
    return _as_surface(*surface_nets(values, origin, spacing, known))


def _near_cloud(cloud: Array, origin: Array, spacing: float, counts: Array, reach: int) -> Array:
    """Grid points within `reach` cells (per axis) of a point of the cloud."""
    near = np.zeros(tuple(counts), bool)
    near[tuple(np.round((cloud - origin) / spacing).astype(int).T)] = True
    for axis in range(3):
        grown = near.copy()
        for shift in range(1, reach + 1):
            grown |= np.roll(near, shift, axis) | np.roll(near, -shift, axis)
        near = grown
    return near


def _as_surface(vertices: Array, quads: Array, smallest: int = 40) -> tuple[Array, Array]:
    shorter = np.linalg.norm(vertices[quads[:, 0]] - vertices[quads[:, 2]], axis=1) <= np.linalg.norm(
        vertices[quads[:, 1]] - vertices[quads[:, 3]], axis=1
    )
    split = np.where(shorter[:, None], quads[:, [0, 1, 2, 0, 2, 3]], quads[:, [0, 1, 3, 1, 2, 3]])
    triangles = split.reshape(-1, 3)
    for _ in range(20):
        bad = np.union1d(crowded_edges(triangles), pinched_vertices(len(vertices), triangles))
        if not len(bad):
            break
        keep = np.ones(len(vertices), bool)
        keep[bad.astype(int)] = False
        vertices, triangles = keep_vertices(vertices, triangles, keep)
    label = components(len(vertices), triangles)
    return keep_vertices(vertices, triangles, np.bincount(label, minlength=len(vertices))[label] >= smallest)


def smooth_rims(vertices: Array, triangles: Array, rounds: int = 4) -> Array:
    """Vertices with the stair steps of the grid taken off the boundary; inner vertices stay."""
    sides = np.sort(np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    rim = edges[uses == 1]
    ends = np.concatenate([rim[:, 0], rim[:, 1]])
    others = np.concatenate([rim[:, 1], rim[:, 0]])
    count = np.bincount(ends, minlength=len(vertices))
    for _ in range(rounds):
        total = np.zeros_like(vertices)
        np.add.at(total, ends, vertices[others])
        moved = 0.5 * vertices + 0.5 * total / np.maximum(count, 1)[:, None]
        vertices = np.where((count == 2)[:, None], moved, vertices)
    return vertices


def barycentric(points: Array, corners: Array) -> Array:
    """Weights (n, 3), clipped to the triangle and summing to one, of points (n, 3) in triangles (n, 3, 3)."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    u, v, p = b - a, c - a, points - a
    uu, uv, vv = (u * u).sum(1), (u * v).sum(1), (v * v).sum(1)
    pu, pv = (p * u).sum(1), (p * v).sum(1)
    det = np.maximum(uu * vv - uv * uv, 1e-30)
    second, third = (vv * pu - uv * pv) / det, (uu * pv - uv * pu) / det
    weights = np.clip(np.stack([1.0 - second - third, second, third], axis=1), 0.0, None)
    return weights / weights.sum(axis=1, keepdims=True)


def rigid_motion(points: Array, axis: Array, degrees: float, shift: Array) -> Array:
    """Points turned about `axis` through the origin (Rodrigues' formula), then moved."""
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    angle = np.radians(degrees)
    turned = points * np.cos(angle) + np.cross(k, points) * np.sin(angle)
    return turned + np.outer(points @ k, k) * (1.0 - np.cos(angle)) + shift
