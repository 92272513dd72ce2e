# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes whose UVs and seams are known in closed form, and maps between two tessellations of one shape."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

CUBE_SIDES = [(0, 1, 2, -1), (0, 1, 2, 1), (1, 2, 0, -1), (1, 2, 0, 1), (2, 0, 1, -1), (2, 0, 1, 1)]


def grid(rows, columns, close_rows=False, close_columns=False):
    """Triangles of a grid of vertices, and the (row, column) of every corner before closing."""
    cells = [(i, j) for i in range(rows) for j in range(columns)]
    shape = np.array([[(0, 0), (1, 0), (1, 1)], [(0, 0), (1, 1), (0, 1)]])
    corners = (np.array(cells)[:, None, None] + shape).reshape(-1, 3, 2)
    wide = columns if close_columns else columns + 1
    row = corners[..., 0] % rows if close_rows else corners[..., 0]
    column = corners[..., 1] % columns if close_columns else corners[..., 1]
    return (row * wide + column).astype(np.int32), corners


def cylinder(rows, columns, turn=0.0):
    """Radius 1, height 4; u around from the cut, v up. One island, cut open along a line."""
    faces, corners = grid(rows, columns, close_columns=True)
    i, j = np.divmod(np.arange((rows + 1) * columns), columns)
    angle = 2 * np.pi * (j + turn) / columns
    vertices = np.stack([np.cos(angle), np.sin(angle), 4 * i / rows], axis=1)
    return vertices, faces, np.stack([corners[..., 1] / columns, corners[..., 0] / rows], axis=-1)


def torus(rows, columns, turn=0.0):
    """Radii 3 and 1; two cuts, one island."""
    faces, corners = grid(rows, columns, True, True)
    i, j = np.divmod(np.arange(rows * columns), columns)
    a, b = 2 * np.pi * (i + turn) / rows, 2 * np.pi * (j + turn) / columns
    around = 3 + np.cos(b)
    vertices = np.stack([around * np.cos(a), around * np.sin(a), np.sin(b)], axis=1)
    return vertices, faces, np.stack([corners[..., 0] / rows, corners[..., 1] / columns], axis=-1)


def sphere(rows, columns, turn=0.0):
    """Latitude and longitude; every polar triangle has a UV of its own at the pole, as in Blender's UV sphere."""
    faces, corners = grid(rows, columns, close_columns=True)
    i, j = np.divmod(np.arange((rows + 1) * columns), columns)
    polar, angle = np.pi * i / rows, 2 * np.pi * (j + turn) / columns
    vertices = np.stack([np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar)], axis=1)
    uv = np.stack([corners[..., 1] / columns, corners[..., 0] / rows], axis=-1)
    faces[faces < columns] = 0
    faces[faces >= rows * columns] = rows * columns
    whole = np.array([len(set(face)) == 3 for face in faces])
    uv[..., 0] += np.where(uv[..., 1] % 1.0 == 0.0, 0.25 / columns, 0.0)
    return vertices, faces[whole], uv[whole]


def cube(cells, turn=0.0):
    """Side 2, every side an island of its own in a 3 by 2 layout with gaps, vertices shared across sides."""
    faces, corners = grid(cells, cells)
    lattice = np.stack(np.divmod(np.arange((cells + 1) ** 2), cells + 1), axis=1) / cells
    points, triangles, uvs = [], [], []
    for side, (axis, first, second, sign) in enumerate(CUBE_SIDES):
        at = np.zeros((len(lattice), 3))
        at[:, axis], at[:, first], at[:, second] = sign, 2 * lattice[:, 0] - 1, 2 * lattice[:, 1] - 1
        points.append(at)
        triangles.append(faces[:, ::-1] + side * len(lattice) if sign < 0 else faces + side * len(lattice))
        place = np.array([side % 3, side // 3]) / 3 + 0.02
        uvs.append(place + 0.28 * (corners[:, ::-1] if sign < 0 else corners) / cells)
    all_points, shared = np.unique(np.concatenate(points), axis=0, return_inverse=True)
    spin = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return all_points @ spin.T, shared.reshape(-1)[np.concatenate(triangles)].astype(np.int32), np.concatenate(uvs)


SHAPES = {"cube": cube, "cylinder": cylinder, "sphere": sphere, "torus": torus}
DONORS = {"cube": (8,), "cylinder": (12, 24), "sphere": (16, 32), "torus": (36, 18)}
RECEIVERS = {"cube": (7,), "cylinder": (17, 31), "sphere": (13, 29), "torus": (31, 23)}
COARSE = {"cube": (3,), "cylinder": (5, 9), "sphere": (6, 10), "torus": (14, 9)}


def closest_points(points, vertices, faces):
    """Nearest point of the donor for every row, by trying all triangles: (triangle, weights)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    best = np.full(len(points), np.inf)
    face, weights = np.zeros(len(points), dtype=np.int32), np.zeros((len(points), 3))
    normal = np.cross(b - a, c - a)
    area = np.einsum("ij,ij->i", normal, normal)
    for row, p in enumerate(points):
        v = np.einsum("ij,ij->i", np.cross(p - a, c - a), normal) / area
        w = np.einsum("ij,ij->i", np.cross(b - a, p - a), normal) / area
        candidates = [np.stack([1 - v - w, v, w], axis=1)]
        for k, (x, y) in enumerate(((a, b), (b, c), (c, a))):
            t = np.clip(np.einsum("ij,ij->i", p - x, y - x) / np.einsum("ij,ij->i", y - x, y - x), 0, 1)
            edge = np.zeros((len(faces), 3))
            edge[:, k], edge[:, (k + 1) % 3] = 1 - t, t
            candidates.append(edge)
        for at in candidates:
            q = at[:, :1] * a + at[:, 1:2] * b + at[:, 2:] * c
            distance = np.where((at >= 0).all(axis=1), ((q - p) ** 2).sum(axis=1), np.inf)
            k = distance.argmin()
            if distance[k] < best[row]:
                best[row], face[row], weights[row] = distance[k], k, at[k]
    return face, weights


def correspondence_of(face, weights, donor_faces):
    heaviest = np.where(face >= 0, donor_faces[face, np.nan_to_num(weights).argmax(axis=1)], -1)
    return SimpleNamespace(face=face, barycentric=weights, vertex=heaviest)


def images_of(correspondence, donor):
    return (correspondence.barycentric[:, :, None] * donor[0][donor[1][correspondence.face]]).sum(axis=1)


def identity_map(vertices, faces, pick=0):
    """Every vertex to itself, in one of the triangles around it."""
    face, weights = np.full(len(vertices), -1, dtype=np.int32), np.full((len(vertices), 3), np.nan)
    order = np.random.default_rng(pick).permutation(len(faces))
    for f in order:
        for c in range(3):
            face[faces[f, c]] = f
            weights[faces[f, c]] = np.eye(3)[c]
    return correspondence_of(face, weights, faces)


def pair(name, sizes, turn):
    donor = SHAPES[name](*DONORS[name])
    receiver = SHAPES[name](*sizes[name], turn=turn)
    used = np.unique(receiver[1])
    face = np.full(len(receiver[0]), -1, dtype=np.int32)
    weights = np.full((len(receiver[0]), 3), np.nan)
    face[used], weights[used] = closest_points(receiver[0][used], donor[0], donor[1])
    return correspondence_of(face, weights, donor[1]), receiver, donor
