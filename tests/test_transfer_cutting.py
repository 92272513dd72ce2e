# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of cutting the receiver along the donor's seams."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from seamed_shapes import COARSE, RECEIVERS, SHAPES, cylinder, identity_map, images_of, pair


def areas(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_a_tube_is_cut_along_its_line_from_end_to_end():
    correspondence, receiver, donor = pair("cylinder", RECEIVERS, 0.37)
    cut = transfer.cut_along_seams(correspondence, *receiver[:2], *donor)
    count = len(receiver[0])
    # One cut in each ring and in each diagonal that crosses the line.
    assert len(cut.edges) == 18 + 17
    np.testing.assert_array_equal(cut.vertices[:count], receiver[0])
    images = images_of(cut, donor)[count:]
    np.testing.assert_allclose(images[:, 1], 0.0, rtol=0, atol=1e-5)
    assert (images[:, 0] > 0.9).all()
    # Nothing is added or lost, and every new triangle lies in its parent.
    np.testing.assert_allclose(
        np.bincount(cut.parent, weights=areas(cut.vertices, cut.faces)), areas(*receiver[:2]), rtol=0, atol=1e-12
    )


@pytest.mark.parametrize("sizes", [RECEIVERS, COARSE], ids=["similar", "coarse"])
def test_after_the_cut_all_uvs_lie_inside_the_islands_and_are_exact(sizes):
    correspondence, receiver, donor = pair("cylinder", sizes, 0.37)
    cut = transfer.cut_along_seams(correspondence, *receiver[:2], *donor)
    moved = transfer.transfer_corner_uv(cut, cut.vertices, cut.faces, *donor)
    assert moved.mask.all()
    assert moved.uv.min() > -1e-4 and moved.uv.max() < 1 + 1e-4
    angle = np.arctan2(*(images_of(cut, donor)[:, k] for k in (1, 0))) / (2 * np.pi)
    off = (moved.uv[:, 0] - angle[cut.faces.ravel()] + 0.5) % 1.0 - 0.5
    # The donor's 24 flat sides against the round angle.
    assert np.abs(off).max() < 0.002
    seams = transfer.seam_edges(cut.faces, moved.uv, tolerance=1e-3)
    line = seams[(seams >= len(receiver[0])).all(axis=1)]
    assert len(line) == len(seams) == 2 * sizes["cylinder"][0]


def test_without_a_crossing_nothing_is_cut():
    for name in ("cube", "cylinder"):
        vertices, faces, uv = SHAPES[name](*COARSE[name])
        cut = transfer.cut_along_seams(identity_map(vertices, faces), vertices, faces, vertices, faces, uv)
        assert len(cut.edges) == 0
        np.testing.assert_array_equal(cut.faces, faces)
        np.testing.assert_array_equal(cut.parent, np.arange(len(faces)))


def test_unmatched_triangles_are_left_whole_and_what_does_not_fit_is_refused():
    correspondence, receiver, donor = pair("cylinder", COARSE, 0.37)
    correspondence.face[:] = -1
    correspondence.vertex[:] = -1
    cut = transfer.cut_along_seams(correspondence, *receiver[:2], *donor)
    np.testing.assert_array_equal(cut.faces, receiver[1])
    vertices, faces, uv = cylinder(6, 12)
    with pytest.raises(isograft.InvalidInput, match="donor_corner_uv: expected 432 rows"):
        transfer.cut_along_seams(identity_map(vertices, faces), vertices, faces, vertices, faces, uv[:-1])
    with pytest.raises(isograft.InvalidInput, match="correspondence: 84 rows for 85 vertices"):
        transfer.cut_along_seams(
            identity_map(vertices, faces), np.vstack([vertices, [[0, 0, 0]]]), np.vstack([faces, [[0, 1, 84]]]),
            vertices, faces, uv,
        )  # fmt: skip
