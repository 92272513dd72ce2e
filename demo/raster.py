# SPDX-License-Identifier: GPL-3.0-or-later
"""What of a surface lies under each texel of its UV map, and colours bled over island borders; numpy alone."""

from __future__ import annotations

import numpy as np

from demo.implicit import Array


def rasterize(uv: Array, size: int) -> tuple[Array, Array, Array]:
    """Texels whose centres lie in a UV triangle.

    `uv` is (m, 3, 2) in the unit square. Returns texel indices (k,) into a size x size image whose row 0 is v = 0,
    the triangle of each (k,), and its barycentric weights (k, 3); a texel appears once.
    """
    pixel = uv * size - 0.5
    low = np.floor(pixel.min(axis=1)).astype(int)
    extent = (np.ceil(pixel.max(axis=1)).astype(int) - low).max(axis=1) + 1
    found = []
    smaller = 0
    while smaller < extent.max():
        limit = max(8, 2 * smaller)
        bucket = np.flatnonzero((extent > smaller) & (extent <= limit))
        chunks = np.array_split(bucket, max(1, len(bucket) * limit * limit // 2_000_000))
        found.extend(_covered(pixel, low, chunk, limit, size) for chunk in chunks)
        smaller = limit
    texel, triangle, weights = (np.concatenate(columns) for columns in zip(*found, strict=True))
    _, first = np.unique(texel, return_index=True)
    return texel[first], triangle[first], weights[first]


def _covered(pixel: Array, low: Array, chunk: Array, limit: int, size: int) -> tuple[Array, Array, Array]:
    offsets = np.stack(np.meshgrid(np.arange(limit), np.arange(limit), indexing="ij"), axis=-1).reshape(-1, 2)
    spots = low[chunk][:, None] + offsets
    a, b, c = (pixel[chunk][:, None, i] for i in range(3))
    u, v, p = b - a, c - a, spots - a
    det = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    det = np.where(np.abs(det) < 1e-12, np.nan, det)
    second = (p[..., 0] * v[..., 1] - p[..., 1] * v[..., 0]) / det
    third = (u[..., 0] * p[..., 1] - u[..., 1] * p[..., 0]) / det
    weights = np.stack([1.0 - second - third, second, third], axis=-1)
    with np.errstate(invalid="ignore"):
        hit = (weights >= -1e-9).all(axis=-1) & (spots >= 0).all(axis=-1) & (spots < size).all(axis=-1)
    return (
        (spots[..., 1] * size + spots[..., 0])[hit],
        np.repeat(chunk, len(offsets)).reshape(hit.shape)[hit],
        weights[hit],
    )


def bleed(image: Array, painted: Array, texels: int) -> Array:
    """Image (s, s, c) with its painted texels (s, s) spread outwards, so that filtering never meets an empty one."""
    image, painted = image.copy(), painted.copy()
    for step in range(texels):
        shifts = (
            ((1, 0), (-1, 0), (0, 1), (0, -1)) if step % 2 else ((1, 1), (-1, -1), (1, -1), (-1, 1), (1, 0), (0, 1))
        )
        for shift in shifts:
            other = np.roll(painted, shift, (0, 1)) & ~painted
            image[other] = np.roll(image, shift, (0, 1))[other]
            painted |= other
    return image
