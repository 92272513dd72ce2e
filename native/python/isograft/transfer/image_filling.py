# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked images continued over the surface into triangles that could not be baked."""

from __future__ import annotations

import numpy as np

from isograft import _native
from isograft.progress import part_of, tell
from isograft.transfer.arrays import Array, Progress, value_columns

# Where a triangle's image is looked at for its first corner: three texels do not let one hair or pore decide.
_NEAR_CORNER = np.array([[0.8, 0.1, 0.1], [0.6, 0.3, 0.1], [0.6, 0.1, 0.3]])
_FLAT = np.array([0.5, 0.5, 1.0, 1.0])
_BAKED = 1
# Of conjugate gradients; holes of a million vertices need as many.
_STEPS = 2000


def fill_images(
    vertices: Array,
    faces: Array,
    layout: Array,
    known: Array,
    images: list[Array],
    mask: Array,
    are_normals: list[bool],
    margin: int,
    threads: int,
    progress: Progress | None,
) -> Array:
    """Fill `images` in the triangles that are not `known` (F,), then their margin; `mask` says which texels.

    Every vertex beside a baked triangle has the mean colour of that side, the others are the mean of their neighbours,
    and triangles are painted between their corners. Normal maps are flat.

    Returns:
        (F,) triangles that were filled.
    """
    share = part_of(progress, 0.1, 0.5)
    sampled, sure = _at_vertices(faces, layout, known, images, mask, len(vertices))
    paintable = sure
    if sure.any():
        paintable = np.asarray(_native.nearest_known(vertices, faces, sure, part_of(progress, 0.0, 0.1)) >= 0)
    columns = []
    for index, (image, values) in enumerate(zip(images, sampled, strict=True)):
        completed = values
        if are_normals[index]:
            scale = 255.0 if image.dtype == np.uint8 else 1.0
            completed = np.broadcast_to(scale * _FLAT[: values.shape[1]], values.shape)
        elif sure.any() and not sure.all():
            part = part_of(share, index / len(images), (index + 1) / len(images))
            completed = _between(faces, values, sure, paintable, part)
        columns.append(completed)
    wanted = ~known & paintable[faces].all(axis=1)
    given = [(value_columns(values[faces.ravel()]), image) for values, image in zip(columns, images, strict=True)]
    height, width = mask.shape
    _native.paint(layout, wanted, given, width, height, margin, mask, threads, part_of(progress, 0.5, 1.0))
    return wanted


def _between(faces: Array, values: Array, sure: Array, reached: Array, progress: Progress | None) -> Array:
    """Values (n, k), those not `sure` the mean of their neighbours: never beyond the values around the hole.

    Conjugate gradients, about as many steps as the hole has vertices across.
    """
    asked = reached & ~sure
    ends = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    ends = ends[asked[ends].any(axis=1)]
    ends = np.concatenate([ends, ends[:, ::-1]])
    here, there = ends[asked[ends[:, 0]]].T
    row = np.cumsum(asked) - 1
    count = int(asked.sum())
    degree = np.maximum(np.bincount(row[here], minlength=count), 1.0)
    inner = asked[there]
    own, other = row[here[inner]], row[there[inner]]
    result = values.copy()
    for k in range(values.shape[1]):
        right = np.bincount(row[here[~inner]], weights=values[there[~inner], k], minlength=count)
        at = np.full(count, values[sure, k].mean())
        rest = right - (degree * at - np.bincount(own, weights=at[other], minlength=count))
        step = rest / degree
        energy = rest @ step
        least = 1e-12 * max(energy, 1e-300)
        for _ in range(_STEPS):
            if energy <= least:
                break
            tell(progress, "fill", k / values.shape[1])
            along = degree * step - np.bincount(own, weights=step[other], minlength=count)
            size = energy / (step @ along)
            at, rest = at + size * step, rest - size * along
            energy, before = rest @ (rest / degree), energy
            step = rest / degree + energy / before * step
        result[asked, k] = at
    return result


def _at_vertices(
    faces: Array, layout: Array, known: Array, images: list[Array], mask: Array, count: int
) -> tuple[list[Array], Array]:
    """Per image (n, k) mean values around every vertex, and which vertices (n,) have any."""
    height, width = mask.shape
    chosen = np.flatnonzero(known)
    corners = layout.reshape(-1, 3, 2)[chosen]
    sums = [np.zeros((count, image.shape[2])) for image in images]
    total = np.zeros(count)
    for corner in range(3):
        for near in _NEAR_CORNER:
            at = np.einsum("k,fkd->fd", np.roll(near, corner), corners)
            x, y = (np.floor(at[:, k] * size).astype(np.int64) for k, size in ((0, width), (1, height)))
            inside = (x >= 0) & (y >= 0) & (x < width) & (y < height)
            inside[inside] = mask[y[inside], x[inside]] == _BAKED
            vertex = faces[chosen[inside], corner]
            total += np.bincount(vertex, minlength=count)
            for values, image in zip(sums, images, strict=True):
                seen = image[y[inside], x[inside]]
                for k in range(values.shape[1]):
                    values[:, k] += np.bincount(vertex, weights=seen[:, k], minlength=count)
    return [values / np.maximum(total, 1.0)[:, None] for values in sums], total > 0
