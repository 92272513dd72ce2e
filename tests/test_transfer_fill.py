# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of filling what is unmatched, and of wrapping a donor onto a receiver."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from seamed_shapes import COARSE, RECEIVERS, SHAPES, cube, cylinder, grid, identity_map, pair, torus

TURN, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
TURN *= np.linalg.det(TURN)


def flat(cells):
    faces, corners = grid(cells, cells)
    i, j = np.divmod(np.arange((cells + 1) ** 2), cells + 1)
    return np.stack([j / cells, i / cells, np.zeros(len(i))], axis=1), faces, corners[..., ::-1] / cells


def test_linear_values_are_continued_linearly_on_a_plane():
    vertices, faces, _ = flat(12)
    values = np.stack([2 * vertices[:, 0] - vertices[:, 1], 1 + vertices[:, 1]], axis=1)
    known = np.linalg.norm(vertices - [0.5, 0.5, 0], axis=1) > 0.25
    spoiled = np.where(known[:, None], values, np.nan)
    filled = transfer.fill_point(vertices, faces, spoiled, known)
    np.testing.assert_array_equal(filled.filled, ~known)
    np.testing.assert_array_equal(filled.values[known], values[known])
    np.testing.assert_allclose(filled.values, values, rtol=0, atol=1e-9)


def test_a_hole_of_a_round_surface_is_continued_without_a_kink():
    vertices, faces, _ = torus(36, 18)
    known = np.linalg.norm(vertices - vertices[0], axis=1) > 1.2
    filled = transfer.fill_point(vertices, faces, vertices[:, 2], known)
    spread = np.ptp(vertices[:, 2][~known])
    assert np.abs(filled.values - vertices[:, 2]).max() < 0.15 * spread
    assert (~known).sum() > 20


def test_what_has_no_mean_takes_the_nearest_known_value_along_the_surface():
    vertices, faces, _ = cylinder(6, 12)
    names = np.array([f"row {row}" for row in np.arange(len(vertices)) // 12])
    known = (vertices[:, 2] < 0.1) | (vertices[:, 2] > 3.9)
    values, filled = transfer.fill_point(vertices, faces, names, known)
    np.testing.assert_array_equal(filled, ~known)
    low, high = vertices[:, 2] < 1.9, vertices[:, 2] > 2.1
    assert set(values[low]) == {"row 0"} and set(values[high]) == {"row 6"}
    assert set(values[~low & ~high]) <= {"row 0", "row 6"}


def test_limits_hold_for_what_is_filled_only_and_parts_without_knowledge_stay():
    vertices, faces, _ = flat(8)
    both = np.vstack([vertices, vertices + 5.0]), np.vstack([faces, faces + len(vertices)])
    known = np.arange(len(both[0])) < len(vertices)
    known &= both[0][:, 0] < 0.5
    values = np.where(known, 4 * both[0][:, 0] - 0.5, 7.0)
    filled = transfer.fill_point(*both, values, known, low=0.0, high=1.0)
    np.testing.assert_array_equal(filled.filled, ~known & (np.arange(len(known)) < len(vertices)))
    np.testing.assert_array_equal(filled.values[known], values[known])
    assert filled.values[filled.filled].max() == 1.0
    assert (filled.values[len(vertices) :] == 7.0).all()


def test_uvs_of_a_plane_are_continued_exactly():
    vertices, faces, uv = flat(10)
    known = np.linalg.norm(vertices[faces].mean(axis=1) - [0.5, 0.5, 0], axis=1) > 0.3
    filled = transfer.fill_corner(vertices, faces, np.where(known[:, None, None], uv, 0.0), known)
    np.testing.assert_array_equal(filled.filled, ~known)
    np.testing.assert_allclose(filled.values.reshape(-1, 3, 2), uv, rtol=0, atol=1e-9)


def test_a_hole_between_islands_continues_the_one_it_borders_most():
    """Around a corner of a cube, off its middle, so that one side has most of the hole's border."""
    vertices, faces, uv = cube(12)
    centre = vertices[faces].mean(axis=1)
    known = np.linalg.norm(centre - [1.0, 0.75, 0.1], axis=1) > 0.45
    assert (~known).sum() > 30
    side = np.abs(centre).argmax(axis=1)
    assert len(np.unique(side[~known])) == 2
    filled = transfer.fill_corner(vertices, faces, np.where(known[:, None, None], uv, 0.0), known)
    np.testing.assert_array_equal(filled.filled, ~known)
    values = filled.values.reshape(-1, 3, 2)
    np.testing.assert_array_equal(values[known], uv[known])
    # On the side that has most of the border nothing differs much from the truth; the other side's part of the hole
    # lies beyond that island's rim in UV space, sewn to it.
    mine = ~known & (side == 0)
    assert np.abs(values[mine] - uv[mine]).max() < 0.03
    islands = transfer.uv_islands(faces, values)
    assert set(islands[~known]) == {islands[known & (side == 0) & (centre[:, 0] > 0)][0]}


def test_faces_take_the_value_of_the_nearest_known_face():
    vertices, faces, _ = cylinder(6, 12)
    row = np.arange(72) // 12
    polygons = np.arange(len(faces)) // 2
    names = np.array([f"row {r}" for r in row])
    known = (row == 0) | (row == 5)
    values, filled = transfer.fill_face(vertices, faces, names, known, polygons=polygons)
    np.testing.assert_array_equal(filled, ~known)
    np.testing.assert_array_equal(values[known], names[known])
    assert set(values[(row == 1)]) == {"row 0"} and set(values[(row == 4)]) == {"row 5"}
    nothing = transfer.fill_face(vertices, faces, names, np.zeros(72, bool), polygons=polygons)
    assert not nothing.filled.any() and (nothing.values == names).all()
    with pytest.raises(isograft.InvalidInput, match="expected 144 rows, one per face"):
        transfer.fill_face(vertices, faces, names, known)


def test_filling_of_faces_tells_how_far_it_is_and_stops_when_asked_to():
    vertices, faces, _ = cylinder(90, 60)
    known = np.zeros(len(faces), bool)
    known[0] = True
    told = []
    transfer.fill_face(vertices, faces, np.zeros(len(faces)), known, progress=lambda *step: told.append(step))
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    with pytest.raises(isograft.Cancelled):
        transfer.fill_face(vertices, faces, np.zeros(len(faces)), known, progress=lambda *_: False)


def test_filling_of_corners_tells_how_far_it_is_from_its_first_pass_on_and_stops_in_each():
    vertices, faces, uv = cube(12)
    known = np.linalg.norm(vertices[faces].mean(axis=1) - [1.0, 0.75, 0.1], axis=1) > 0.45
    told = []
    transfer.fill_corner(vertices, faces, uv, known, progress=lambda *step: told.append(step))
    stages, fractions = zip(*told, strict=True)
    assert list(dict.fromkeys(stages)) == ["groups", "islands", "fill"]
    assert list(fractions) == sorted(fractions) and fractions[-1] == 1.0
    for stopped in ("groups", "islands", "fill"):
        with pytest.raises(isograft.Cancelled):
            transfer.fill_corner(vertices, faces, uv, known, progress=lambda stage, _, end=stopped: stage != end)


def test_filling_refuses_what_does_not_fit():
    vertices, faces, uv = flat(3)
    known = np.ones(len(vertices), bool)
    with pytest.raises(isograft.InvalidInput, match="values: expected 16 rows"):
        transfer.fill_point(vertices, faces, np.zeros(3), known)
    with pytest.raises(isograft.InvalidInput, match="known: expected booleans"):
        transfer.fill_point(vertices, faces, np.zeros(16), known.astype(int))
    with pytest.raises(isograft.InvalidInput, match="NaN or infinity in row 0, which is known"):
        transfer.fill_point(vertices, faces, np.full(16, np.nan), known)
    with pytest.raises(isograft.InvalidInput, match="known: expected 18 booleans"):
        transfer.fill_corner(vertices, faces, uv, known)
    with pytest.raises(isograft.Cancelled):
        transfer.fill_point(vertices, faces, np.zeros(16), known, progress=lambda *_: False)


@pytest.mark.parametrize("method", ["rigid", "smooth"])
def test_a_wrap_along_the_identity_is_the_receiver(method):
    vertices, faces, _ = torus(14, 9)
    posed = 2.0 * vertices @ TURN.T + 1.0
    wrapped = transfer.wrap(identity_map(vertices, faces), posed, faces, vertices, faces, method=method)
    assert not wrapped.filled.any()
    np.testing.assert_allclose(wrapped.vertices, posed, rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ["rigid", "smooth"])
def test_a_part_that_is_unmatched_follows_a_rigid_motion_and_a_scale(method):
    vertices, faces, _ = torus(20, 12)
    correspondence = identity_map(vertices, faces)
    lost = np.linalg.norm(vertices - vertices[0], axis=1) < 1.5
    correspondence.face[lost], correspondence.vertex[lost], correspondence.barycentric[lost] = -1, -1, np.nan
    posed = 2.5 * vertices @ TURN.T + [3.0, 0.0, -1.0]
    wrapped = transfer.wrap(correspondence, posed, faces, vertices, faces, method=method)
    np.testing.assert_array_equal(wrapped.filled, lost)
    np.testing.assert_allclose(wrapped.vertices[~lost], posed[~lost], rtol=0, atol=1e-9)
    # A displacement field continues a turn only as far as it is smooth; the rigid completion is exact in the limit.
    edge = 2.5 * np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    assert np.abs(wrapped.vertices - posed).max() < (0.05 if method == "rigid" else 0.5) * edge


def test_a_whole_part_without_a_match_moves_with_the_others():
    vertices, faces, _ = torus(14, 9)
    both = np.vstack([vertices, 0.2 * vertices + 6.0]), np.vstack([faces, faces + len(vertices)])
    correspondence = identity_map(*both)
    lost = np.arange(len(both[0])) >= len(vertices)
    correspondence.face[lost], correspondence.vertex[lost], correspondence.barycentric[lost] = -1, -1, np.nan
    posed = 0.5 * both[0] @ TURN.T + 1.0
    wrapped = transfer.wrap(correspondence, posed, both[1], *both)
    np.testing.assert_array_equal(wrapped.filled, lost)
    np.testing.assert_allclose(wrapped.vertices, posed, rtol=0, atol=1e-9)


def test_another_tessellation_is_wrapped_onto_the_same_shape():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    wrapped = transfer.wrap(correspondence, *receiver[:2], *donor[:2])
    assert not wrapped.filled.any()
    ring = np.hypot(wrapped.vertices[:, 0], wrapped.vertices[:, 1]) - 3
    off = np.abs(np.hypot(ring, wrapped.vertices[:, 2]) - 1)
    # Points of the receiver's flat triangles, so no farther from the torus than those are.
    middles = receiver[0][receiver[1]].mean(axis=1)
    sagitta = np.abs(np.hypot(np.hypot(middles[:, 0], middles[:, 1]) - 3, middles[:, 2]) - 1).max()
    assert off.max() <= 2 * sagitta
    assert np.linalg.norm(wrapped.vertices - donor[0], axis=1).max() < 0.35


def test_wrapping_refuses_what_does_not_fit():
    correspondence, receiver, donor = pair("torus", COARSE, 0.37)
    with pytest.raises(isograft.InvalidInput, match="method must be rigid or smooth"):
        transfer.wrap(correspondence, *receiver[:2], *donor[:2], method="stiff")
    correspondence.face[:] = -1
    correspondence.vertex[:] = -1
    with pytest.raises(isograft.InvalidInput, match="0 donor vertices are matched, at least 3"):
        transfer.wrap(correspondence, *receiver[:2], *donor[:2])


def test_baked_images_go_on_smoothly_into_what_is_unmatched():
    """On a plane a colour that is linear in the place stays linear through a hole: a harmonic law."""
    vertices, faces, uv = flat(12)
    correspondence = identity_map(vertices, faces)
    hole = (np.abs(vertices[:, :2] - vertices[:, :2].mean(axis=0)) < 0.2 * np.ptp(vertices[:, 0])).all(axis=1)
    correspondence.face[hole] = correspondence.vertex[hole] = -1
    size = 64
    u, v = np.meshgrid((np.arange(size) + 0.5) / size, (np.arange(size) + 0.5) / size)
    picture = np.stack([u, 0.5 * v, 0.25 + 0.5 * u], axis=-1).astype(np.float32)
    tilted = np.broadcast_to(np.float32([0.7, 0.4, 0.9]), (4, 4, 3))
    channels = [transfer.Channel(picture, extension="extend"), transfer.Channel(tilted, kind="normal")]
    arguments = correspondence, vertices, faces, uv, vertices, faces, uv, channels, size
    plain, baked = transfer.bake(*arguments, margin=0), transfer.bake(*arguments, margin=0, fill=True)
    holes = plain.mask == 0
    assert holes.sum() > 100
    assert not plain.filled.any()
    np.testing.assert_array_equal(baked.mask == 3, holes)
    np.testing.assert_array_equal(baked.filled, hole[faces].any(axis=1))
    for one, other in zip(plain.images, baked.images, strict=True):
        np.testing.assert_array_equal(one[~holes], other[~holes])
    # Sampled beside the corners of the border, the colour there is off by a fifth of an edge.
    assert np.abs(baked.images[0] - picture)[holes].max() < 0.05
    np.testing.assert_allclose(baked.images[1][holes], [[0.5, 0.5, 1.0]] * holes.sum(), atol=1e-6)


def test_filled_texels_get_a_margin_too_and_bytes_are_rounded():
    vertices, faces, uv = flat(6)
    correspondence = identity_map(vertices, faces)
    correspondence.face[24] = correspondence.vertex[24] = -1
    layout = 0.25 + 0.5 * uv
    grey = np.full((2, 2, 1), 77, np.uint8)
    baked = transfer.bake(
        correspondence, vertices, faces, layout, vertices, faces, uv, transfer.Channel(grey), 48, margin=3, fill=True
    )
    assert set(np.unique(baked.mask)) == {0, 1, 2, 3}
    assert (baked.images[0][baked.mask > 0] == 77).all()
    assert (baked.images[0][baked.mask == 0] == 0).all()


def test_an_image_without_anything_baked_is_not_filled():
    vertices, faces, uv = flat(4)
    correspondence = identity_map(vertices, faces)
    correspondence.face[:] = correspondence.vertex[:] = -1
    channel = transfer.Channel(np.ones((2, 2, 3), np.float32))
    baked = transfer.bake(correspondence, vertices, faces, uv, vertices, faces, uv, channel, 16, fill=True)
    assert not baked.mask.any() and not baked.filled.any()


def test_custom_normals_lean_in_a_hole_as_they_lean_around_it():
    vertices, faces, _ = SHAPES["sphere"](*COARSE["sphere"])
    corners = vertices[faces].reshape(-1, 3)
    smooth = corners / np.linalg.norm(corners, axis=1, keepdims=True)
    known = ~(smooth.reshape(-1, 3, 3) @ [0.48, 0.6, 0.64] > 0.8).any(axis=1)
    given = np.where(np.repeat(known, 3)[:, None], smooth, 0.0)
    filled = transfer.fill_normals(vertices, faces, given, known)
    np.testing.assert_array_equal(filled.filled, ~known)
    np.testing.assert_array_equal(filled.values[np.repeat(known, 3)], given[np.repeat(known, 3)])
    np.testing.assert_allclose(np.linalg.norm(filled.values, axis=1), 1.0, atol=1e-9)
    # Normals of the sphere itself around the hole: those of the sphere in it, as far as coarse triangles tell.
    assert (np.einsum("ij,ij->i", filled.values, smooth) > 0.98).all()
