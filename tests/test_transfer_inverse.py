# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of the inverse map."""

from __future__ import annotations

from types import SimpleNamespace

import isograft
import numpy as np
import pytest
from isograft import transfer
from seamed_shapes import COARSE, RECEIVERS, SHAPES, closest_points, correspondence_of, grid, identity_map, pair, torus


def invert(correspondence, receiver, donor, **options):
    return transfer.invert(correspondence, *receiver[:2], *donor[:2], **options)


@pytest.mark.parametrize("name", SHAPES)
def test_the_inverse_of_the_identity_is_the_identity(name):
    vertices, faces, _ = shape = SHAPES[name](*COARSE[name])
    inverse = invert(identity_map(vertices, faces), shape, shape)
    used = np.unique(faces)
    np.testing.assert_array_equal(np.flatnonzero(inverse.matched), used)
    np.testing.assert_array_equal(inverse.vertex[used], used)
    np.testing.assert_array_equal(inverse.points[used], vertices[used])
    assert inverse.target_size == len(vertices) and (inverse.confidence[used] == 1).all()


@pytest.mark.parametrize("sizes", [RECEIVERS, COARSE], ids=["similar", "coarse"])
@pytest.mark.parametrize("name", SHAPES)
def test_every_vertex_of_a_covered_target_finds_the_place_where_it_lies(name, sizes):
    correspondence, receiver, donor = pair(name, sizes, 0.37)
    inverse = invert(correspondence, receiver, donor)
    used = np.unique(donor[1])
    assert inverse.matched[used].all()
    # Both tessellations lie on one shape, so the nearest point of the receiver is a second way to find the place. The
    # two differ by how far flat triangles stand off it.
    face, weights = closest_points(donor[0][used], *receiver[:2])
    nearest = (weights[:, :, None] * receiver[0][receiver[1][face]]).sum(axis=1)
    gap = np.linalg.norm(nearest - donor[0][used], axis=1)
    off = np.linalg.norm(inverse.points[used] - donor[0][used], axis=1)
    edges = np.linalg.norm(np.diff(receiver[0][receiver[1][:, [0, 1, 2, 0]]], axis=1), axis=2)
    assert off.max() <= gap.max() + 0.25 * edges.max()
    assert np.median(off) <= 2 * np.median(gap) + 1e-9


def flat(cells, shift=0.0):
    faces, _ = grid(cells, cells)
    i, j = np.divmod(np.arange((cells + 1) ** 2), cells + 1)
    return np.stack([i / cells, j / cells, np.full(len(i), shift)], axis=1), faces


def test_on_a_plane_the_inverse_is_exact_and_ends_where_the_image_ends():
    donor, receiver = flat(8), flat(5)
    face, weights = closest_points(receiver[0], *donor)
    correspondence = correspondence_of(face, weights, donor[1])
    inverse = invert(correspondence, receiver, donor)
    np.testing.assert_allclose(inverse.points, donor[0], rtol=0, atol=1e-12)

    lost = receiver[0][:, 0] > 0.7
    correspondence.face[lost], correspondence.vertex[lost], weights[lost] = -1, -1, np.nan
    inverse = invert(correspondence, receiver, donor)
    # The last whole column of the receiver's triangles ends at x = 0.6.
    np.testing.assert_array_equal(inverse.matched, donor[0][:, 0] <= 0.6)
    assert (inverse.face[~inverse.matched] == -1).all() and np.isnan(inverse.points[~inverse.matched]).all()


def test_the_other_side_of_a_thin_sheet_is_not_taken_for_the_matched_one():
    top, bottom = flat(6), flat(6, -0.01)
    rim = np.array([[0, 6], [6, 48], [48, 42], [42, 0]])
    walls = [[a, b, b + 49] for a, b in rim] + [[a, b + 49, a + 49] for a, b in rim]
    donor = np.vstack([top[0], bottom[0]]), np.vstack([top[1], bottom[1][:, ::-1] + 49, walls]).astype(np.int32)
    inverse = invert(identity_map(*top), top, donor)
    assert inverse.matched[:49].all() and not inverse.matched[49:].any()


def test_confidence_stretch_and_region_come_along():
    vertices, faces, _ = shape = torus(12, 9)
    correspondence = identity_map(vertices, faces)
    random = np.random.default_rng(3)
    correspondence.confidence = random.random(len(vertices))
    correspondence.stretch = random.random(len(vertices))
    correspondence.region = random.integers(3, size=len(vertices)).astype(np.int32)
    inverse = invert(correspondence, shape, shape)
    np.testing.assert_array_equal(inverse.confidence, correspondence.confidence[faces[inverse.face]].min(axis=1))
    np.testing.assert_array_equal(inverse.stretch, correspondence.stretch)
    np.testing.assert_array_equal(inverse.region, correspondence.region)


def test_the_inverse_does_not_depend_on_threads_or_on_where_the_source_lies():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    one = invert(correspondence, receiver, donor, threads=1)
    three = invert(correspondence, receiver, donor, threads=3)
    for name, array in one.arrays().items():
        np.testing.assert_array_equal(array, getattr(three, name))
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    elsewhere = invert(correspondence, (3 * receiver[0] @ turn + 1, receiver[1]), donor)
    np.testing.assert_array_equal(elsewhere.face, one.face)
    np.testing.assert_allclose(elsewhere.barycentric, one.barycentric, rtol=0, atol=1e-9)


def test_a_map_to_a_point_cloud_and_arrays_that_do_not_fit_are_refused():
    vertices, faces, _ = shape = torus(12, 9)
    cloud = SimpleNamespace(
        face=np.full(len(vertices), -1),
        barycentric=np.full((len(vertices), 3), np.nan),
        vertex=np.arange(len(vertices)),
    )
    with pytest.raises(isograft.InvalidInput, match="108 rows .a point cloud.: only a map to a mesh"):
        invert(cloud, shape, shape)
    with pytest.raises(isograft.InvalidInput, match="`correspondence` has 108 rows, expected 107"):
        transfer.invert(identity_map(vertices, faces), vertices[:-1], faces % 107, vertices, faces)
    with pytest.raises(isograft.Cancelled):
        invert(identity_map(vertices, faces), shape, shape, progress=lambda *_: False)
