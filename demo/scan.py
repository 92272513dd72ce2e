# SPDX-License-Identifier: GPL-3.0-or-later
"""Inside Blender: a mesh seen by a few virtual range cameras becomes a scan with holes, noise and a known truth."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from demo.fusion import Camera, barycentric, fuse, smooth_rims
from demo.implicit import Array

SPACING = 0.027
TRUNCATION = 0.06
NOISE = 0.003
VERTICES = 13_000
# direction from the creature (forward, left, up); none stands below the ground
STATIONS = [
    (1, 0.9, 0.08), (1, -0.8, 0.15), (-1, 1, 0.08), (-1, -0.9, 0.12), (0.5, 0.3, 1), (-0.4, -0.3, 1),
    (0, 1, 0.05), (0.1, -1, 0.1), (1, 0.1, -0.03), (-1, 0.1, 0.15),
    (0.7, 1, -0.13), (0.7, -1, -0.13), (-0.5, 1, -0.13), (-0.5, -1, -0.13),
    (-1, 0.4, -0.13), (-1, -0.4, -0.13), (1, 0.5, -0.13), (1, -0.5, -0.13),
]  # fmt: skip
DISTANCE = 6.5


@dataclass(frozen=True)
class Scan:
    """Scan mesh in the scanned pose's frame and its truth: triangle of the scanned mesh or -1, and weights in it."""

    vertices: Array
    triangles: Array
    tri: Array
    w: Array


def stations(vertices: Array) -> list[Camera]:
    """Range cameras around the middle of the bounding box."""
    middle = 0.5 * (vertices.min(axis=0) + vertices.max(axis=0))
    cameras = []
    for forward, left, up in STATIONS:
        direction = np.array((left, -forward, up), float)
        place = middle + DISTANCE * direction / np.linalg.norm(direction)
        cameras.append(Camera.looking(place, middle, np.radians(46.0), 480, 400))
    return cameras


def cast(tree: BVHTree, camera: Camera, rng: np.random.Generator, noise: float) -> Array:
    """Range map (height, width) by one ray a pixel, NaN where nothing is hit or the surface is seen too obliquely."""
    origin = Vector(camera.place)
    rays = camera.rays()
    ranges = np.full(len(rays), np.nan)
    for i, direction in enumerate(rays.tolist()):
        _, normal, _, distance = tree.ray_cast(origin, Vector(direction))
        if distance is not None and abs(normal.dot(Vector(direction))) > 0.17:
            ranges[i] = distance
    return (ranges + noise * rng.normal(size=len(ranges))).reshape(camera.height, camera.width)


def scan_mesh(vertices: Array, triangles: Array, seed: int = 11) -> Scan:
    """Scan of a posed mesh: vertices (n, 3), triangles (m, 3)."""
    tree = BVHTree.FromPolygons(vertices.tolist(), triangles.tolist())
    rng = np.random.default_rng(seed)
    cameras = stations(vertices)
    maps = [cast(tree, camera, rng, NOISE) for camera in cameras]
    points, faces = simplified(*fuse(cameras, maps, SPACING, TRUNCATION), VERTICES)
    points = smooth_rims(points, faces)
    tri, w = true_places(tree, points, faces, vertices, triangles)
    return Scan(points, faces, tri, w)


def simplified(points: Array, faces: Array, count: int) -> tuple[Array, Array]:
    """About `count` vertices by Blender's edge collapse: another triangulation than the grid's."""
    if len(points) <= count:
        return points, faces
    mesh = bpy.data.meshes.new("dense")
    mesh.from_pydata(points.tolist(), [], faces.tolist())
    holder = bpy.data.objects.new("dense", mesh)
    bpy.context.scene.collection.objects.link(holder)
    holder.modifiers.new("fewer", "DECIMATE").ratio = count / len(points)
    fewer = holder.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    points = np.array([v.co[:] for v in fewer.vertices])
    faces = np.array([p.vertices[:] for p in fewer.polygons])
    bpy.data.objects.remove(holder)
    bpy.data.meshes.remove(mesh)
    return points, faces


def true_places(
    tree: BVHTree, points: Array, faces: Array, vertices: Array, triangles: Array, limit: float = 0.04
) -> tuple[Array, Array]:
    """Nearest point of the scanned surface that faces the same way: (tri (n,), w (n, 3)), -1 and zeros if none."""
    normals = np.zeros_like(points)
    cross = np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]])
    for corner in range(3):
        np.add.at(normals, faces[:, corner], cross)
    tri = np.full(len(points), -1, np.int64)
    place = np.zeros_like(points)
    for i, point in enumerate(points):
        normal = Vector(normals[i])
        best = limit
        for spot, other, face, distance in tree.find_nearest_range(Vector(point), limit):
            if distance < best and normal.dot(other) > 0:
                best, tri[i], place[i] = distance, face, spot
    w = np.zeros((len(points), 3))
    found = tri >= 0
    w[found] = barycentric(place[found], vertices[triangles[tri[found]]])
    return tri, w
