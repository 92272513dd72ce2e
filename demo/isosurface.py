# SPDX-License-Identifier: GPL-3.0-or-later
"""Naive surface nets (Gibson 1998): a quad mesh of the zero set of a grid, in numpy alone."""

from __future__ import annotations

import numpy as np

Array = np.ndarray
_CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def surface_nets(values: Array, origin: Array, spacing: float, known: Array | None = None) -> tuple[Array, Array]:
    """Mesh of `values == 0` (inside negative).

    `values` is (a, b, c), `origin` the place of its first entry. Cells with a corner that is not `known` give no
    vertex, so unseen places stay open. Returns vertices (n, 3) and quads (m, 4), wound to face the positive side.
    """
    a, b, c = (n - 1 for n in values.shape)
    corner = [values[i : i + a, j : j + b, k : k + c] for i, j, k in _CORNERS]
    inside = np.stack([v < 0 for v in corner])
    active = inside.any(axis=0) & ~inside.all(axis=0)
    if known is not None:
        for i, j, k in _CORNERS:
            active &= known[i : i + a, j : j + b, k : k + c]
    cells = np.argwhere(active)
    cell_values = np.stack([v[active] for v in corner], axis=1)
    vertices = origin + spacing * (cells + _crossing_mean(cell_values))
    index = np.full(active.shape, -1, np.int64)
    index[active] = np.arange(len(cells))
    quads = [_quads_of_axis(values, index, axis) for axis in range(3)]
    return vertices, np.concatenate(quads)


def _crossing_mean(cell_values: Array) -> Array:
    """Mean of the zero crossings on the twelve edges of each cell, in cell coordinates (n, 3)."""
    total = np.zeros((len(cell_values), 3))
    count = np.zeros(len(cell_values))
    for p in range(8):
        for q in range(p + 1, 8):
            if np.abs(_CORNERS[p] - _CORNERS[q]).sum() != 1:
                continue
            u, v = cell_values[:, p], cell_values[:, q]
            crosses = (u < 0) != (v < 0)
            t = np.where(crosses, u / np.where(crosses, u - v, 1.0), 0.0)
            place = _CORNERS[p] + t[:, None] * (_CORNERS[q] - _CORNERS[p])
            total += np.where(crosses[:, None], place, 0.0)
            count += crosses
    return total / count[:, None]


def _quads_of_axis(values: Array, index: Array, axis: int) -> Array:
    """One quad round every grid edge along `axis` that crosses zero and has all four cells."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    here = np.moveaxis(values, (axis, u, v), (0, 1, 2))
    cells = np.moveaxis(index, (axis, u, v), (0, 1, 2))
    first, second = here[:-1, 1:-1, 1:-1], here[1:, 1:-1, 1:-1]
    leaving = (first < 0) & (second >= 0)
    entering = (first >= 0) & (second < 0)
    around = np.stack([cells[:, :-1, :-1], cells[:, 1:, :-1], cells[:, 1:, 1:], cells[:, :-1, 1:]], axis=-1)
    whole = (around >= 0).all(axis=-1)
    return np.concatenate([around[leaving & whole], around[entering & whole][:, ::-1]])
