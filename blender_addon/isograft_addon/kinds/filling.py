# SPDX-License-Identifier: GPL-3.0-or-later
"""Values for what is unmatched, if the user asks for them."""

from typing import Any

import numpy as np
from isograft import transfer

from ..bridge import Array
from ..job import Progress
from ..pairing import Pair


def fill_points(
    pair: Pair, values: Array, known: Array, progress: Progress, **limits: float
) -> tuple[Array, Array, Array]:
    """Values (n, ...) completed over the surface within the limits `low` and `high`.

    Like all here with which rows have values now, and the vertices (n,) that were filled.
    """
    if known.all() or not known.any():
        return values, known, np.zeros(len(known), dtype=bool)
    completed, filled = transfer.fill_point(
        pair.own.vertices, pair.own.triangles, values, known, progress=progress, **limits
    )
    return completed, known | filled, filled


def fill_corners(pair: Pair, values: Array, known: Array, progress: Progress) -> tuple[Array, Array, Array]:
    """Values (3 F, ...) completed; rows are told per triangle (F,)."""
    return _corners(transfer.fill_corner, pair, values, known, progress)


def fill_normals(pair: Pair, values: Array, known: Array, progress: Progress) -> tuple[Array, Array, Array]:
    """As fill_corners, for custom normals (3 F, 3)."""
    return _corners(transfer.fill_normals, pair, values, known, progress)


def fill_faces(pair: Pair, values: Array, known: Array, progress: Progress) -> tuple[Array, Array, Array]:
    """Values (p, ...) with those of the nearest known faces (p,)."""
    if known.all() or not known.any():
        return values, known, np.zeros(len(pair.own.vertices), dtype=bool)
    completed, filled = transfer.fill_face(
        pair.own.vertices, pair.own.triangles, values, known, polygons=pair.own.polygons, progress=progress
    )
    return completed, known | filled, marks(pair, known[pair.own.polygons], filled[pair.own.polygons])


def fill_edges(pair: Pair, values: Array, known: Array, progress: Progress) -> tuple[Array, Array, Array]:
    """Values (e, ...) of the receiver's edges carried on from the known ones (e,)."""
    edges, matched = pair.arrays.edges, pair.matched
    marked = np.zeros(len(matched), dtype=bool)
    if known.all() or not known.any():
        return values, known, marked
    completed, filled = transfer.fill_edge(pair.own.vertices, edges, values, known, progress=progress)
    marked[edges[filled]] = True
    return completed, known | filled, marked & ~matched


def _corners(fill: Any, pair: Pair, values: Array, known: Array, progress: Progress) -> tuple[Array, Array, Array]:
    # A polygon with an unmatched triangle is unmatched as a whole.
    whole = pair.whole_polygons(known)[pair.own.polygons]
    if whole.all() or not whole.any():
        return values, whole, np.zeros(len(pair.own.vertices), dtype=bool)
    completed, filled = fill(pair.own.vertices, pair.own.triangles, values, whole, progress=progress)
    return completed, whole | filled, marks(pair, whole, filled)


def marks(pair: Pair, known: Array, filled: Array) -> Array:
    """(n,) vertices of filled triangles (F,) that no known triangle (F,) touches."""
    marked = np.zeros(len(pair.own.vertices), dtype=bool)
    marked[pair.own.triangles[filled]] = True
    marked[pair.own.triangles[known]] = False
    return marked
