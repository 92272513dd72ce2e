# SPDX-License-Identifier: GPL-3.0-or-later
"""Values of edges carried on into what is unmatched; only on request."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.progress import tell
from isograft.transfer.arrays import Array, Progress, check_indices, point_rows
from isograft.transfer.filling import Filled

# An edge at the place itself is taken before one beside it unless that is straighter by more than this.
_STRAIGHTER = 1e-6
# A line goes on from edge to edge where it turns by at most 45 degrees ...
_AHEAD = -np.sqrt(0.5)
# ... and ends where more edges than this meet.
_MOST = 32


def fill_edge(
    vertices: Any, edges: Any, values: npt.ArrayLike, known: npt.ArrayLike, *, progress: Progress | None = None
) -> Filled:
    """Fill values of edges, such as creases and marks, where they are not known.

    Lines of edges go on: two edges that continue each other most straightly across a vertex are in one line (the edge
    loops of a grid), and an unknown edge takes the value, of any type, of the nearest known edge of its line. The rest
    is filled ring by ring from the border of the hole: an edge takes the value of that edge which it is most parallel
    to, of those at its ends and a ring farther out.

    Args:
        vertices: (n, 3) of the mesh that has the values.
        edges: (E, 2) vertices.
        values: (E,) or (E, ...).
        known: (E,) True where the values are known; those do not change.
        progress: called with (stage, fraction) now and then; returning False cancels.

    Returns:
        Values, and which edges were filled. Parts of the mesh without any known edge stay as they are. O(E).

    Raises:
        InvalidInput: arrays that do not fit each other.
    """
    points, data, mask = point_rows(vertices, "vertices"), np.asarray(values), np.asarray(known)
    ends = np.asarray(edges)
    if ends.ndim != 2 or ends.shape[1] != 2 or (ends.size and ends.dtype.kind not in "iu"):
        raise _native.InvalidInput(f"edges: expected integers of shape (n, 2), got {ends.dtype} {ends.shape}")
    check_indices(ends, len(points), "edges")
    if data.ndim == 0 or len(data) != len(ends) or mask.shape != (len(ends),) or mask.dtype != bool:
        raise _native.InvalidInput(
            f"values and known: expected {len(ends)} rows, one per edge, the latter booleans, got {data.shape} and "
            f"{mask.dtype} {mask.shape}"
        )
    source = _sources(points, ends.astype(np.int64), mask, progress)
    filled = (source >= 0) & ~mask
    result = data.copy()
    result[filled] = data[source[filled]]
    return Filled(result, filled)


def _sources(points: Array, ends: Array, known: Array, progress: Progress | None) -> Array:
    """(E,) row of the known edge that each edge takes its value from; itself if it is known, -1 if there is none."""
    along = points[ends[:, 1]] - points[ends[:, 0]]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    at_vertex = np.argsort(ends.ravel(), kind="stable")
    start = np.searchsorted(ends.ravel()[at_vertex], np.arange(len(points) + 1))
    at_vertex //= 2
    source = _along_lines(along, ends, known, (at_vertex, start))
    # The vertex that the front came to a vertex from.
    before = np.full(len(points), -1)
    reached = np.zeros(len(points), bool)
    reached[ends[source >= 0]] = True
    left = int((source < 0).sum())
    fresh, count = np.flatnonzero(reached), max(1, left)
    while True:
        tell(progress, "fill", 1.0 - left / count)
        front = np.unique(_ranges(at_vertex, start, fresh))
        front = front[source[front] < 0]
        if not len(front):
            return source
        left -= len(front)
        taken = _straightest(along, ends, front, source, (at_vertex, start), reached, before)
        source[front] = np.where(taken >= 0, source[taken], -1)
        arrived, first = np.unique(ends[front][:, ::-1].ravel(), return_index=True)
        new = ~reached[arrived]
        fresh = arrived[new]
        before[fresh] = ends[front].ravel()[first[new]]
        reached[fresh] = True


def _along_lines(along: Array, ends: Array, known: Array, around: tuple[Array, Array]) -> Array:
    """(E,) row of the nearest known edge of the line that each edge lies in; -1 if there is none."""
    source = np.where(known, np.arange(len(ends)), -1)
    ahead = _ahead(along, ends, known, around)
    front = np.flatnonzero(known)
    while len(front):
        next_, from_ = ahead[front].T.ravel(), np.tile(front, 2)
        new = (next_ >= 0) & (source[next_] < 0)
        # The lowest of two that come from both sides at once.
        order = np.lexsort((source[from_[new]], next_[new]))
        front, first = np.unique(next_[new][order], return_index=True)
        source[front] = source[from_[new][order][first]]
    return source


def _ahead(along: Array, ends: Array, known: Array, around: tuple[Array, Array]) -> Array:
    """(E, 2) the edge that goes on beyond the first and the second vertex of each edge, -1 where none does."""
    at_vertex, start = around
    valence = np.diff(start)
    asked = np.zeros(len(valence), bool)
    asked[ends[~known]] = True
    # Half-edges: where an edge leaves a vertex.
    here = np.flatnonzero(np.repeat(asked & (valence <= _MOST), valence))
    vertex = np.repeat(np.arange(len(valence)), valence)[here]
    leaving = np.where((ends[at_vertex[here], 0] == vertex)[:, None], 1.0, -1.0) * along[at_vertex[here]]
    place = np.full(len(at_vertex), -1)
    place[here] = np.arange(len(here))
    best, opposite = np.full(len(here), _AHEAD), np.full(len(here), -1)
    for k in range(int(valence[vertex].max(initial=0))):
        rows = np.flatnonzero(valence[vertex] > k)
        other = place[start[vertex[rows]] + k]
        turn = np.einsum("ij,ij->i", leaving[rows], leaving[other])
        better = turn < best[rows]
        best[rows[better]], opposite[rows[better]] = turn[better], other[better]
    mutual = (opposite >= 0) & (opposite[opposite] == np.arange(len(here)))
    rows = np.flatnonzero(mutual)
    ahead = np.full(ends.shape, -1)
    edge = at_vertex[here[rows]]
    ahead[edge, (ends[edge, 1] == vertex[rows]).astype(np.int64)] = at_vertex[here[opposite[rows]]]
    return ahead


def _straightest(
    along: Array,
    ends: Array,
    front: Array,
    source: Array,
    around: tuple[Array, Array],
    reached: Array,
    before: Array,
) -> Array:
    """Per edge of the front the edge with a value that it continues most straightly."""
    at_vertex, start = around
    best, taken = np.full(len(front), -np.inf), np.full(len(front), -1)
    own = np.where(reached[ends[front]], ends[front], -1)
    for places in (own[:, 0], own[:, 1], *(np.where(own[:, k] >= 0, before[own[:, k]], -1) for k in range(2))):
        valence = np.where(places >= 0, start[places + 1] - start[places], 0)
        for k in range(int(valence.max(initial=0))):
            here = np.flatnonzero(valence > k)
            candidate = at_vertex[start[places[here]] + k]
            straight = np.abs(np.einsum("ij,ij->i", along[candidate], along[front[here]]))
            better = (source[candidate] >= 0) & (straight > best[here] + _STRAIGHTER)
            best[here[better]], taken[here[better]] = straight[better], candidate[better]
    return taken


def _ranges(values: Array, start: Array, rows: Array) -> Array:
    """All values[start[row]:start[row + 1]] one after the other."""
    count = start[rows + 1] - start[rows]
    offset = np.repeat(start[rows] - np.concatenate([[0], np.cumsum(count)[:-1]]), count)
    return values[offset + np.arange(int(count.sum()))]
