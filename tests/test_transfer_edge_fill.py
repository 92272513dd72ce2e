# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of filling values of edges."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from seamed_shapes import cylinder, grid


def edges_of(faces):
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.unique(ends, axis=0)


def flat(cells):
    faces, _ = grid(cells, cells)
    i, j = np.divmod(np.arange((cells + 1) ** 2), cells + 1)
    return np.stack([j, i, np.zeros(len(i))], axis=1).astype(float), faces, i, j


@pytest.mark.parametrize("horizontal", [True, False])
def test_lines_on_a_plane_go_straight_through_a_hole(horizontal):
    vertices, faces, i, j = flat(14)
    edges = edges_of(faces)
    line = (i if horizontal else j)[edges]
    crease = np.where((line == 7).all(axis=1), 0.75, 0.0) + np.where((line == 5).all(axis=1), 0.25, 0.0)
    near = np.abs(vertices[:, :2] - 7.0).max(axis=1) < 4.0
    known = ~near[edges].any(axis=1)
    filled = transfer.fill_edge(vertices, edges, np.where(known, crease, -1.0), known)
    np.testing.assert_array_equal(filled.filled, ~known)
    np.testing.assert_array_equal(filled.values, crease)


def test_a_line_goes_on_over_the_bend_of_a_tube_and_no_other_edge_is_marked():
    vertices, faces, _ = cylinder(20, 24)
    edges = edges_of(faces)
    row, column = np.divmod(np.arange(len(vertices)), 24)
    mark = (row[edges] == 10).all(axis=1)
    gap = (column >= 4) & (column <= 16)
    known = ~gap[edges].any(axis=1)
    filled = transfer.fill_edge(vertices, edges, mark & known, known)
    assert (mark & ~known).sum() == 14
    np.testing.assert_array_equal(filled.values, mark)


def test_values_of_any_type_are_picked_and_the_known_ones_stay():
    vertices, faces, _, _ = flat(8)
    edges = edges_of(faces)
    known = ~(np.linalg.norm(vertices[:, :2] - 4.0, axis=1) < 2.5)[edges].any(axis=1)
    names = np.array([f"edge {k}" for k in range(len(edges))])
    values, filled = transfer.fill_edge(vertices, edges, np.where(known, names, ""), known)
    np.testing.assert_array_equal(values[known], names[known])
    assert set(values[filled]) <= set(names[known])
    assert (values != "").all()


def test_an_edge_takes_that_of_one_which_runs_the_same_way():
    """On a grid every edge of a hole has one of its own direction at the border."""
    vertices, faces, _, _ = flat(9)
    edges = edges_of(faces)
    way = np.rint(np.degrees(np.arctan2(*(vertices[edges[:, 1]] - vertices[edges[:, 0]])[:, 1::-1].T))).astype(np.int32)
    known = ~((vertices[:, 0] > 2) & (vertices[:, 0] < 7) & (vertices[:, 1] > 3))[edges].any(axis=1)
    assert set(way) == {0, 45, 90}
    np.testing.assert_array_equal(transfer.fill_edge(vertices, edges, np.where(known, way, -1), known).values, way)


def test_parts_without_knowledge_stay_and_what_does_not_fit_is_refused():
    vertices, faces, _, _ = flat(3)
    both, count = np.concatenate([vertices, vertices + 9.0]), len(vertices)
    edges = edges_of(np.concatenate([faces, faces + count]))
    known = (edges < count).all(axis=1) & (np.arange(len(edges)) > 4)
    filled = transfer.fill_edge(both, edges, np.where(known, 1, 5), known)
    np.testing.assert_array_equal(filled.filled, ~known & (edges < count).all(axis=1))
    assert (filled.values[(edges >= count).all(axis=1)] == 5).all()
    with pytest.raises(isograft.InvalidInput, match=f"expected {len(edges)} rows, one per edge"):
        transfer.fill_edge(both, edges, np.zeros(3), known)
    with pytest.raises(isograft.InvalidInput, match="edges row 0 is"):
        transfer.fill_edge(vertices[:1], edges, known, known)
    with pytest.raises(isograft.Cancelled):
        transfer.fill_edge(both, edges, known, known, progress=lambda *_: False)
