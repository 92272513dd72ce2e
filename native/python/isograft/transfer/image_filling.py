# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked images continued over the surface into triangles that could not be baked."""

from __future__ import annotations

import numpy as np

from isograft import _native
from isograft.transfer.arrays import Array, Progress, value_columns
from isograft.transfer.filling import fill_point
from isograft.transfer.progress import part_of

# Where a triangle's image is looked at for its first corner: three texels do not let one hair or pore decide.
_NEAR_CORNER = np.array([[0.8, 0.1, 0.1], [0.6, 0.3, 0.1], [0.6, 0.1, 0.3]])
_FLAT = np.array([0.5, 0.5, 1.0, 1.0])
_BAKED = 1


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

    Every vertex beside a baked triangle has the mean colour of that side, the others continue it smoothly over the
    surface, and triangles are painted between their corners. Normal maps are flat.

    Returns:
        (F,) triangles that were filled.
    """
    share = part_of(progress, 0.0, 0.5)
    sampled, sure = _at_vertices(faces, layout, known, images, mask, len(vertices))
    paintable = np.zeros(len(vertices), bool)
    columns = []
    for index, (image, values) in enumerate(zip(images, sampled, strict=True)):
        completed = values
        if are_normals[index]:
            scale = 255.0 if image.dtype == np.uint8 else 1.0
            completed = np.broadcast_to(scale * _FLAT[: values.shape[1]], values.shape)
        elif sure.any() and not sure.all():
            # Without a limit thin plates would run out of the range of colours.
            limits = {"low": float(values[sure].min()), "high": float(values[sure].max())}
            part = part_of(share, index / len(images), (index + 1) / len(images))
            completed, filled = fill_point(vertices, faces, values, sure, **limits, progress=part)
            paintable = sure | filled
        columns.append(completed)
    if all(are_normals) and sure.any():
        paintable = sure | fill_point(vertices, faces, sure.astype(float), sure, progress=share).filled
    wanted = ~known & (paintable | sure)[faces].all(axis=1)
    given = [(value_columns(values[faces.ravel()]), image) for values, image in zip(columns, images, strict=True)]
    height, width = mask.shape
    _native.paint(layout, wanted, given, width, height, margin, mask, threads, part_of(progress, 0.5, 1.0))
    return wanted


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
