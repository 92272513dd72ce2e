# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of moving values of faces and edges, custom normals and seams."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from isograft.transfer import transfer_edge as move_edge
from isograft.transfer import transfer_face as move_face
from isograft.transfer import transfer_normals as move_normals
from seamed_shapes import COARSE, RECEIVERS, SHAPES, cube, cylinder, identity_map, images_of, pair, torus

TURN, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
TURN *= np.linalg.det(TURN)
KINDS = [
    np.arange(400) * 7,
    np.arange(400) % 3 == 0,
    np.array([f"face {i}" for i in range(400)]),
    np.linspace(0, 1, 400),
]


def all_edges(faces):
    return np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)


@pytest.mark.parametrize("data", KINDS, ids=["int", "bool", "string", "float"])
def test_faces_of_the_identity_keep_their_values_of_any_type(data):
    vertices, faces, _ = torus(14, 9)
    values = data[: len(faces)]
    moved, mask = transfer.transfer_face(identity_map(vertices, faces), vertices, faces, vertices, faces, values)
    assert mask.all() and moved.dtype == values.dtype
    np.testing.assert_array_equal(moved, values)


def test_polygons_take_the_polygon_under_their_centre():
    vertices, faces, _ = cylinder(6, 12)
    polygons = np.arange(len(faces)) // 2
    values = np.arange(72) + 100
    moved, mask = transfer.transfer_face(
        identity_map(vertices, faces), vertices, faces, vertices, faces, values,
        receiver_polygons=polygons, donor_polygons=polygons,
    )  # fmt: skip
    assert mask.all()
    np.testing.assert_array_equal(moved, values)


def test_faces_take_the_side_of_a_cube_that_their_centre_lies_on():
    correspondence, receiver, donor = pair("cube", RECEIVERS, 0.37)
    side = transfer.uv_islands(donor[1], donor[2])
    moved, mask = transfer.transfer_face(correspondence, *receiver[:2], *donor[:2], side)
    images = images_of(correspondence, donor)[receiver[1]]
    owner = side[correspondence.face][receiver[1]]
    whole = np.ptp(owner, axis=1) == 0
    assert mask.all() and whole.sum() > 200
    np.testing.assert_array_equal(moved[whole], owner[whole, 0])
    centre = np.abs(images.mean(axis=1)).argmax(axis=1)
    axis_of = {int(s): int(np.abs(donor[0][donor[1][side == s]].mean(axis=(0, 1))).argmax()) for s in np.unique(side)}
    agree = np.array([axis_of[int(s)] for s in moved]) == centre
    assert agree.mean() > 0.97


def test_located_points_are_those_of_the_same_weights_on_one_mesh():
    vertices, faces, _ = torus(14, 9)
    random = np.random.default_rng(0)
    face = random.integers(-1, len(faces), 500)
    weights = random.dirichlet([1, 1, 1], 500)
    found = transfer.locate(identity_map(vertices, faces), vertices, faces, vertices, faces, face, weights)
    np.testing.assert_array_equal(found.face, face)
    np.testing.assert_allclose(found.barycentric, np.where(face[:, None] < 0, 0.0, weights), rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_edges_of_the_identity_keep_their_values(name):
    vertices, faces, _ = SHAPES[name](*COARSE[name])
    edges = all_edges(faces)
    values = np.random.default_rng(0).random(len(edges))
    moved, mask = transfer.transfer_edge(
        identity_map(vertices, faces), vertices, faces, edges[:, ::-1], vertices, faces, edges, values
    )
    assert mask.all()
    np.testing.assert_array_equal(moved, values)


def test_a_marked_line_arrives_beside_where_it_was_and_nowhere_else():
    correspondence, receiver, donor = pair("cylinder", RECEIVERS, 0.0)
    edges, other = all_edges(receiver[1]), all_edges(donor[1])
    ring = (np.abs(donor[0][other][:, :, 2] - 2.0) < 1e-9).all(axis=1)
    moved, mask = transfer.transfer_edge(correspondence, *receiver[:2], edges, *donor[:2], other, ring)
    assert ring.sum() == 24 and moved.any()
    middle = receiver[0][edges].mean(axis=1)
    height = 4 / RECEIVERS["cylinder"][0]
    assert (np.abs(middle[moved, 2] - 2.0) <= height).all()
    # All the way around.
    angle = np.sort(np.arctan2(middle[moved, 1], middle[moved, 0]))
    assert np.diff(angle).max() < 2 * 2 * np.pi / RECEIVERS["cylinder"][1]
    assert mask.sum() < len(edges)


def corner_normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return np.repeat(normal / np.linalg.norm(normal, axis=1, keepdims=True), 3, axis=0)


@pytest.mark.parametrize("name", ["torus", "cube"])
def test_custom_normals_turn_with_a_rigid_motion(name):
    vertices, faces, _ = SHAPES[name](*COARSE[name])
    normals = np.random.default_rng(0).normal(size=(3 * len(faces), 3)) * 0.3 + corner_normals(vertices, faces)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    moved, mask = transfer.transfer_normals(
        identity_map(vertices, faces), 3.0 * vertices @ TURN.T, faces, vertices, faces, normals
    )
    assert mask.all()
    np.testing.assert_allclose(moved, normals @ TURN.T, rtol=0, atol=1e-7)


def test_the_sharp_edges_of_a_cube_stay_sharp():
    correspondence, receiver, donor = pair("cube", RECEIVERS, 0.0)
    moved, mask = transfer.transfer_normals(
        correspondence, *receiver[:2], *donor[:2], corner_normals(*donor[:2]), receiver_polygons=None
    )
    assert mask.all()
    inner = (np.abs(receiver[0][receiver[1]]) < 0.6).sum(axis=2).min(axis=1) == 2
    truth = corner_normals(*receiver[:2]).reshape(-1, 3, 3)
    np.testing.assert_allclose(moved.reshape(-1, 3, 3)[inner], truth[inner], rtol=0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=1), 1.0, rtol=0, atol=1e-9)


def test_smooth_normals_of_a_pose_are_those_of_the_pose():
    vertices, faces, _ = torus(36, 18)
    bend = 0.25 * vertices[:, :1] ** 2
    posed = vertices + bend * [0.0, 0.0, 1.0]

    def smooth(points):
        summed = np.zeros_like(points)
        a, b, c = (points[faces[:, k]] for k in range(3))
        for k in range(3):
            np.add.at(summed, faces[:, k], np.cross(b - a, c - a))
        return (summed / np.linalg.norm(summed, axis=1, keepdims=True))[faces.ravel()]

    moved, mask = transfer.transfer_normals(
        identity_map(vertices, faces), posed, faces, vertices, faces, smooth(vertices)
    )
    assert mask.all()
    np.testing.assert_allclose(moved, smooth(posed), rtol=0, atol=1e-9)


def test_seams_of_the_identity_are_the_donors_own():
    vertices, faces, uv = cube(5)
    seams = transfer.seam_edges(faces, uv)
    ends = vertices[seams]
    along_an_edge = ((np.abs(ends[:, 0]) > 1 - 1e-9) & (np.abs(ends[:, 1]) > 1 - 1e-9)).sum(axis=1)
    assert len(seams) == 12 * 5 and (along_an_edge >= 2).all()
    moved = transfer.transfer_corner_uv(identity_map(vertices, faces), vertices, faces, vertices, faces, uv)
    np.testing.assert_array_equal(transfer.seam_edges(faces, moved.uv), seams)


def test_seams_of_a_tube_run_along_receiver_edges_from_end_to_end():
    correspondence, receiver, donor = pair("cylinder", RECEIVERS, 0.37)
    moved = transfer.transfer_corner_uv(correspondence, *receiver[:2], *donor)
    polygons = np.arange(len(receiver[1])) // 2
    seams = transfer.seam_edges(receiver[1], moved.uv)
    degree = np.bincount(seams.ravel(), minlength=len(receiver[0]))
    # One line: two ends on the rims, all between with two edges.
    assert (degree == 1).sum() == 2 and degree.max() == 2
    assert set(receiver[0][degree == 1][:, 2]) == {0.0, 4.0}
    whole = transfer.transfer_corner_uv(correspondence, *receiver[:2], *donor, receiver_polygons=polygons)
    halves = receiver[1][0::2].tolist(), receiver[1][1::2].tolist()
    diagonals = {tuple(sorted(set(a) & set(b))) for a, b in zip(halves[0], halves[1], strict=True)}
    seams = transfer.seam_edges(receiver[1], whole.uv, polygons=polygons)
    assert not diagonals & {tuple(edge) for edge in seams.tolist()}


def test_seams_are_none_beside_what_is_unmatched():
    _, faces, uv = cylinder(6, 12)
    mask = np.arange(len(faces)) % 2 == 0
    spoiled = np.where(mask[:, None, None], uv, 0.0)
    assert len(transfer.seam_edges(faces, spoiled)) > 100
    assert len(transfer.seam_edges(faces, spoiled, mask=mask)) == 0


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda m, v, f: move_face(m, v, f, v, f, np.arange(5)), "expected at least 252 rows, one per face"),
        (lambda m, v, f: move_face(m, v, f + 1, v, f, np.arange(252)), "receiver_faces row"),
        (lambda m, v, f: move_edge(m, v, f, [[0, 999]], v, f, [[0, 1]], [1]), "receiver_edges row 0 is .0, 999"),
        (lambda m, v, f: move_edge(m, v, f, [[0, 1]], v, f, [[0, 1]], [1, 2]), "expected 1 rows, one per edge"),
        (lambda m, v, f: move_normals(m, v, f, v, f, np.zeros((5, 3))), "donor_normals: expected 756 rows"),
        (lambda m, v, f: transfer.locate(m, v, f, v, f, [0], [[2.0, 0, 0]]), "not >= 0 with sum 1 in row 0"),
        (lambda m, v, f: transfer.locate(m, v, f, v, f, [999], [[1.0, 0, 0]]), "out of range in row 0: 999"),
        (lambda m, v, f: transfer.seam_edges(f, np.zeros((5, 2))), "corner_values: expected 756 rows"),
        (lambda m, v, f: transfer.seam_edges(f, np.zeros((756, 2)), mask=[True]), "mask: expected 252 booleans"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(call, words):
    vertices, faces, _ = torus(14, 9)
    with pytest.raises(isograft.InvalidInput, match=words):
        call(identity_map(vertices, faces), vertices, faces)
