# SPDX-License-Identifier: GPL-3.0-or-later
"""From the implicit creature to a triangle mesh, by numpy."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from demo.creature_shape import BOX
from demo.implicit import Array, Shape
from demo.isosurface import surface_nets


def sample_grid(shape: Shape, spacing: float, block: int = 4) -> tuple[Array, Array]:
    """Values on the grid over the creature's box, exact near the surface; returns (values, origin)."""
    low, high = BOX
    blocks = np.ceil((high - low) / (spacing * block)).astype(int) + 1
    coarse = _grid_values(shape, low, spacing * block, blocks)
    near = np.abs(coarse) < 0.1 + spacing * block
    for axis in range(3):
        near = near | np.roll(near, 1, axis) | np.roll(near, -1, axis)
    values = coarse.repeat(block, 0).repeat(block, 1).repeat(block, 2)
    fine = near.repeat(block, 0).repeat(block, 1).repeat(block, 2)
    points = low + spacing * np.argwhere(fine)
    values[fine] = np.concatenate([shape.value(chunk) for chunk in np.array_split(points, 8)])
    return values, low


def _grid_values(shape: Shape, low: Array, spacing: float, counts: Array) -> Array:
    axes = [low[i] + spacing * np.arange(counts[i]) for i in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return shape.value(points).reshape(tuple(counts))


def polygonize(shape: Shape, spacing: float) -> tuple[Array, Array]:
    """Closed quad mesh of the shape, evened out along the surface; vertices (n, 3), quads (m, 4)."""
    values, origin = sample_grid(shape, spacing)
    vertices, quads = largest_component(*surface_nets(values, origin, spacing))
    for _ in range(10):
        pinched = np.union1d(crowded_edges(quads), pinched_vertices(len(vertices), quads))
        if not len(pinched):
            break
        # Two sheets share a grid cell: fill the cells in question, which merges the sheets there.
        cells = np.floor((vertices[pinched] - origin) / spacing).astype(int)
        for corner in np.ndindex(2, 2, 2):
            i, j, k = (cells + corner).T
            values[i, j, k] = np.minimum(values[i, j, k], -0.1 * spacing)
        vertices, quads = largest_component(*surface_nets(values, origin, spacing))
    else:
        raise RuntimeError("the creature's surface stays non-manifold; choose another grid spacing")
    for _ in range(3):
        vertices = shape.project(neighbour_mean(vertices, quads), steps=1)
    return vertices, quads


def edges_of(faces: Array) -> Array:
    """Undirected edges (k, 2), each once."""
    pairs = np.concatenate([faces[:, [i, (i + 1) % faces.shape[1]]] for i in range(faces.shape[1])])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def crowded_edges(faces: Array) -> Array:
    """Edges (k, 2) with more than two faces."""
    pairs = np.concatenate([faces[:, [i, (i + 1) % faces.shape[1]]] for i in range(faces.shape[1])])
    edges, uses = np.unique(np.sort(pairs, axis=1), axis=0, return_counts=True)
    return edges[uses > 2]


def pinched_vertices(count: int, faces: Array) -> Array:
    """Vertices of a mesh without crowded edges at which more than one fan of faces meets."""
    corners = np.arange(faces.size).reshape(faces.shape)
    following = np.roll(corners, -1, axis=1)
    ends = np.stack([faces.ravel()[corners], faces.ravel()[following]], axis=-1).reshape(-1, 2)
    sides = np.stack([corners, following], axis=-1).reshape(-1, 2)
    flipped = ends[:, 0] > ends[:, 1]
    ends[flipped], sides[flipped] = ends[flipped][:, ::-1], sides[flipped][:, ::-1]
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1)
    links = np.concatenate([np.stack([sides[order[:-1]][same][:, i], sides[order[1:]][same][:, i]], 1) for i in (0, 1)])
    fans = components(faces.size, links)
    roots = np.flatnonzero(fans == np.arange(faces.size))
    return np.flatnonzero(np.bincount(faces.ravel()[roots], minlength=count) > 1)


def neighbour_mean(values: Array, faces: Array) -> Array:
    """Mean over the neighbours of each vertex; vertices without neighbours keep their value."""
    edges = edges_of(faces)
    total, count = np.zeros_like(values), np.zeros(len(values))
    for a, b in ((0, 1), (1, 0)):
        np.add.at(total, edges[:, a], values[edges[:, b]])
        np.add.at(count, edges[:, a], 1)
    return np.where(count[:, None] > 0, total / np.maximum(count, 1)[:, None], values)


def components(count: int, faces: Array) -> Array:
    """Component label per vertex: the smallest vertex index of its component."""
    label = np.arange(count)
    edges = edges_of(faces)
    while True:
        lowest = label.copy()
        np.minimum.at(lowest, edges[:, 0], label[edges[:, 1]])
        np.minimum.at(lowest, edges[:, 1], label[edges[:, 0]])
        lowest = lowest[lowest]
        if np.array_equal(lowest, label):
            return label
        label = lowest


def keep_vertices(vertices: Array, faces: Array, keep: Array) -> tuple[Array, Array]:
    """The mesh of the faces whose vertices are all kept, without unused vertices."""
    faces = faces[keep[faces].all(axis=1)]
    used = np.unique(faces)
    renumber = np.full(len(vertices), -1)
    renumber[used] = np.arange(len(used))
    return vertices[used], renumber[faces]


def largest_component(vertices: Array, faces: Array) -> tuple[Array, Array]:
    label = components(len(vertices), faces)
    return keep_vertices(vertices, faces, label == np.bincount(label).argmax())


def write_ply(path: Path, vertices: Array, triangles: Array) -> None:
    """Binary little-endian PLY with single-precision positions."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(triangles), dtype=[("n", "u1"), ("v", "<i4", 3)])
    rows["n"], rows["v"] = 3, triangles
    with path.open("wb") as file:
        file.write(header.encode("ascii"))
        file.write(np.ascontiguousarray(vertices, "<f4").tobytes())
        file.write(rows.tobytes())
