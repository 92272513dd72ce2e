# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of the transfer along a correspondence, on shapes whose UVs and seams are known in closed form."""

from __future__ import annotations

from types import SimpleNamespace

import isograft
import numpy as np
import pytest
from isograft import _native, transfer
from seamed_shapes import (
    COARSE,
    DONORS,
    RECEIVERS,
    SHAPES,
    closest_points,
    correspondence_of,
    cylinder,
    identity_map,
    images_of,
    pair,
    torus,
)


def move_uv(correspondence, receiver, donor, **options):
    return transfer.transfer_corner_uv(correspondence, *receiver[:2], *donor, **options)


def edge_lengths(corner_points):
    """(F, 3) lengths of the edges of triangles given by their corners (F, 3, k)."""
    return np.linalg.norm(np.roll(corner_points, -1, axis=1) - corner_points, axis=2)


def largest_stretch(vertices, faces, uv):
    """Largest singular value of any triangle's map from space to UV."""
    p = vertices[faces]
    u, v = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]
    x = np.linalg.norm(u, axis=1)
    y = np.einsum("ij,ij->i", u, v) / x
    z = np.linalg.norm(np.cross(u, v), axis=1) / x
    plane = np.stack([np.stack([x, y], 1), np.stack([np.zeros_like(x), z], 1)], 1)
    texture = np.stack([uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]], axis=2)
    return np.linalg.svd(texture @ np.linalg.inv(plane), compute_uv=False).max()


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("pick", range(4))
def test_the_identity_returns_the_donors_uvs_at_seams_too(name, pick):
    donor = SHAPES[name](*DONORS[name])
    moved = move_uv(identity_map(donor[0], donor[1], pick), donor, donor)
    assert moved.mask.all()
    np.testing.assert_allclose(moved.uv.reshape(-1, 3, 2), donor[2], rtol=0, atol=1e-12)
    np.testing.assert_array_equal(moved.island, transfer.uv_islands(donor[1], donor[2]))


@pytest.mark.parametrize("name", SHAPES)
def test_the_identity_also_holds_on_a_mesh_split_along_its_seams(name):
    vertices, faces, uv = SHAPES[name](*DONORS[name])
    corners = np.concatenate([vertices[faces].reshape(-1, 3), uv.reshape(-1, 2)], axis=1)
    split, index = np.unique(np.round(corners, 9), axis=0, return_inverse=True)
    donor = (split[:, :3], index.reshape(-1, 3).astype(np.int32), uv)
    moved = move_uv(identity_map(donor[0], donor[1]), donor, donor)
    np.testing.assert_allclose(moved.uv.reshape(-1, 3, 2), uv, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ["cylinder", "torus", "cube", "sphere"])
@pytest.mark.parametrize("sizes", [RECEIVERS, COARSE], ids=["similar", "coarse"])
@pytest.mark.parametrize("extrapolation", [0.0, 1.0])
def test_no_receiver_triangle_spans_a_seam(name, sizes, extrapolation):
    correspondence, receiver, donor = pair(name, sizes, 0.37)
    moved = move_uv(correspondence, receiver, donor, extrapolation=extrapolation)
    assert moved.mask.all()
    size = edge_lengths(images_of(correspondence, donor)[receiver[1]]).max(axis=1)
    # Chords are shorter than the way over the surface: pi / 2 times on the round shapes, and a triangle that cuts off a
    # corner of the cube is opened by the quarter turn missing there.
    allowed = 1.8 * largest_stretch(*donor) * size
    assert (edge_lengths(moved.uv.reshape(-1, 3, 2)).max(axis=1) <= allowed + 1e-9).all()


@pytest.mark.parametrize("sizes", [RECEIVERS, COARSE], ids=["similar", "coarse"])
def test_triangles_across_the_cut_of_a_tube_carry_on_its_uvs(sizes):
    correspondence, receiver, donor = pair("cylinder", sizes, 0.37)
    moved = move_uv(correspondence, receiver, donor, extrapolation=4.0)
    p = receiver[0][receiver[1]].reshape(-1, 3)
    u = np.arctan2(p[:, 1], p[:, 0]) / (2 * np.pi)
    # The true u up to whole turns, up to what the donor's 24 flat sides cost.
    off = (moved.uv[:, 0] - u + 0.5) % 1.0 - 0.5
    assert np.abs(off).max() < 0.01
    np.testing.assert_allclose(moved.uv[:, 1], p[:, 2] / 4, atol=1e-9)
    span = np.ptp(moved.uv[:, 0].reshape(-1, 3), axis=1)
    assert span.max() < 1.3 / sizes["cylinder"][1]
    assert moved.uv[:, 0].min() < 0
    assert moved.uv[:, 0].max() > 1


@pytest.mark.parametrize("name", SHAPES)
def test_without_extrapolation_every_triangle_stays_within_its_island(name):
    correspondence, receiver, donor = pair(name, RECEIVERS, 0.37)
    moved = move_uv(correspondence, receiver, donor, extrapolation=0)
    donor_island = transfer.uv_islands(donor[1], donor[2])
    assert donor_island.max() == (5 if name == "cube" else 0)
    for island in np.unique(moved.island):
        inside = donor[2][donor_island == island].reshape(-1, 2)
        uv = moved.uv.reshape(-1, 3, 2)[moved.island == island].reshape(-1, 2)
        assert (uv >= inside.min(axis=0) - 1e-12).all() and (uv <= inside.max(axis=0) + 1e-12).all()


@pytest.mark.parametrize("name", SHAPES)
def test_a_corner_is_continuous_wherever_its_triangles_do_not_lie_at_a_seam(name):
    correspondence, receiver, donor = pair(name, RECEIVERS, 0.37)
    moved = move_uv(correspondence, receiver, donor)
    own = (correspondence.barycentric[:, :, None] * donor[2][correspondence.face]).sum(axis=1)
    corner = receiver[1].reshape(-1)
    jumps = np.abs(moved.uv - own[corner]).max(axis=1) > 1e-9
    # Triangles whose images all lie on one island, far from u = 0 and u = 1, have no seam to see.
    uv = own[receiver[1]]
    islands = transfer.uv_islands(donor[1], donor[2])[correspondence.face][receiver[1]]
    cut = (uv.min(axis=(1, 2)) < 0.15) | (uv.max(axis=(1, 2)) > 0.85)
    near_cut = np.ptp(islands, axis=1) > 0 if name == "cube" else cut
    away = ~np.repeat(near_cut, 3)
    assert away.sum() > 300 and not jumps[away].any()


@pytest.mark.parametrize("name", SHAPES)
def test_the_result_does_not_depend_on_numbering_motion_or_threads(name):
    correspondence, receiver, donor = pair(name, RECEIVERS, 0.37)
    plain = move_uv(correspondence, receiver, donor, threads=1)
    for left, right in zip(plain, move_uv(correspondence, receiver, donor, threads=3), strict=True):
        np.testing.assert_array_equal(left, right)
    random = np.random.default_rng(1)
    turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
    new_vertex, new_face = random.permutation(len(donor[0])), random.permutation(len(donor[1]))
    vertices, faces, uv = np.empty_like(donor[0]), np.empty_like(donor[1]), np.empty_like(donor[2])
    vertices[new_vertex] = 7.0 * donor[0] @ turn.T + 5.0
    faces[new_face] = np.roll(new_vertex[donor[1]], 1, axis=1)
    uv[new_face] = np.roll(donor[2], 1, axis=1)
    moved = SimpleNamespace(
        face=np.where(correspondence.face < 0, -1, new_face[correspondence.face]),
        barycentric=np.roll(correspondence.barycentric, 1, axis=1),
        vertex=correspondence.vertex,
    )
    again = move_uv(moved, receiver, (vertices, faces, uv))
    np.testing.assert_array_equal(again.mask, plain.mask)
    np.testing.assert_allclose(again.uv, plain.uv, rtol=0, atol=1e-9)


def test_mirrored_and_collapsed_uvs_do_not_part_an_island():
    vertices, faces, uv = cylinder(6, 12)
    folded = np.abs(uv - [0.5, 0.0])
    assert transfer.uv_islands(faces, folded).max() == 0
    assert transfer.uv_islands(faces, np.zeros_like(uv)).max() == 0
    moved = move_uv(identity_map(vertices, faces), (vertices, faces), (vertices, faces, folded))
    np.testing.assert_allclose(moved.uv.reshape(-1, 3, 2), folded, rtol=0, atol=1e-12)


@pytest.mark.parametrize("mirrored", [False, True])
def test_islands_that_lie_on_each_other_are_told_apart_on_the_surface(mirrored):
    correspondence, receiver, donor = pair("cube", RECEIVERS, 0.37)
    apart = move_uv(correspondence, receiver, donor)
    side = transfer.uv_islands(donor[1], donor[2])
    # Every second side turned over or turned by a half, so that no two sides carry on into each other anywhere.
    shift = np.stack([donor[2][side == s].reshape(-1, 2).min(axis=0) for s in range(6)])
    turned = np.array([1.0, -1.0]) if mirrored else np.array([-1.0, -1.0])
    sign = np.where(np.arange(6)[:, None] % 2 == 1, turned, 1.0)
    own = 0.01 * np.arange(6)[:, None]

    def overlap(uv, island):
        return (uv - shift[island]) * sign[island] + 0.5 + own[island]

    onto = overlap(donor[2].reshape(-1, 2), np.repeat(side, 3))
    moved = move_uv(correspondence, receiver, (*donor[:2], onto))
    np.testing.assert_array_equal(moved.island, apart.island)
    np.testing.assert_allclose(moved.uv, overlap(apart.uv, np.repeat(apart.island, 3)), rtol=0, atol=1e-9)


@pytest.mark.parametrize("off", [1e-4, 0.004, 0.02])
def test_a_splinter_at_the_border_leads_beyond_it_as_the_triangle_behind(off):
    """A polygon with three corners in line on a seam leaves a triangle that is thin, and whose UVs are in line."""
    left = np.array([[-2.0, 0, 0], [0, 0, 0], [off, 1, 0.5 * off], [0, 2, 0], [-2, 2, 0]])
    right = np.array([[2.0, 0, 0], [2, 2, 0]])
    vertices = np.concatenate([left, right])
    faces = np.array([[1, 2, 3], [0, 1, 3], [0, 3, 4], [1, 5, 2], [5, 6, 2], [2, 6, 3]], np.int32)
    flat = np.where(np.arange(len(vertices))[:, None] == 2, [0.0, 1.1], vertices[:, :2])
    uv = flat[faces]
    uv[3:] += [10.0, 0.0]
    receiver = np.array([[-1.5, 0.4, 0.0], [0.4, 1.3, 0.0], [-1.5, 1.6, 0.0]])
    face, weights = closest_points(receiver, vertices, faces)
    map_ = SimpleNamespace(face=face, barycentric=weights, vertex=faces[face, weights.argmax(axis=1)])
    moved = move_uv(map_, (receiver, np.array([[0, 1, 2]], np.int32)), (vertices, faces, uv))
    np.testing.assert_allclose(moved.uv, receiver[:, :2], rtol=0, atol=0.05)


def test_polygons_are_never_parted_by_a_seam():
    correspondence, receiver, donor = pair("cube", RECEIVERS, 0.37)
    polygons = np.arange(len(receiver[1])) // 2
    moved = move_uv(correspondence, receiver, donor, receiver_polygons=polygons)
    assert moved.mask.all()
    np.testing.assert_array_equal(moved.island[0::2], moved.island[1::2])
    uv, faces = moved.uv.reshape(-1, 3, 2), receiver[1]
    for one, other in zip(range(0, len(faces), 2), range(1, len(faces), 2), strict=True):
        for a in range(3):
            for b in np.flatnonzero(faces[other] == faces[one, a]):
                np.testing.assert_array_equal(uv[one, a], uv[other, b])
    alone = move_uv(correspondence, receiver, donor)
    assert (alone.island[0::2] != alone.island[1::2]).any()


def test_unmatched_vertices_leave_their_triangles_unmatched_and_no_others():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    whole = move_uv(correspondence, receiver, donor)
    lost = np.arange(0, len(receiver[0]), 50)
    correspondence.face[lost], correspondence.vertex[lost], correspondence.barycentric[lost] = -1, -1, np.nan
    moved = move_uv(correspondence, receiver, donor)
    expected = ~np.isin(receiver[1], lost).any(axis=1)
    np.testing.assert_array_equal(moved.mask, expected)
    # Faces on the seam ask their neighbours, and of those some are gone: they may lie on its other side.
    seams = np.unique(transfer.seam_edges(receiver[1], whole.uv))
    away = expected & ~np.isin(receiver[1], seams).any(axis=1)
    assert 0.5 < away.mean() < expected.mean()
    rows, kept = np.repeat(away, 3), np.repeat(expected, 3)
    np.testing.assert_array_equal(moved.uv[rows], whole.uv[rows])
    turns = moved.uv[kept] - whole.uv[kept]
    np.testing.assert_allclose(turns, np.rint(turns), rtol=0, atol=0.02)
    assert (moved.uv[~kept] == 0.0).all()
    assert (moved.island[~expected] == -1).all()


def test_triangles_torn_apart_by_the_map_are_unmatched():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    stray = 100
    correspondence.face[stray] = (correspondence.face[stray] + len(donor[1]) // 2) % len(donor[1])
    moved = move_uv(correspondence, receiver, donor)
    np.testing.assert_array_equal(moved.mask, ~(receiver[1] == stray).any(axis=1))


def test_a_map_of_noise_is_left_unmatched_in_a_bounded_time():
    donor, receiver = torus(*DONORS["torus"]), torus(200, 150)
    random = np.random.default_rng(0)
    face = random.integers(len(donor[1]), size=len(receiver[0])).astype(np.int32)
    moved = move_uv(correspondence_of(face, np.full((len(face), 3), 1 / 3), donor[1]), receiver, donor)
    assert moved.mask.mean() < 0.1


def test_values_per_point_are_interpolated_if_floats_and_picked_otherwise():
    correspondence, _, donor = pair("torus", COARSE, 0.37)
    correspondence.face[3], correspondence.vertex[3], correspondence.barycentric[3] = -1, -1, np.nan
    matched = correspondence.face >= 0
    images = images_of(correspondence, donor)
    values, mask = transfer.transfer_point(correspondence, donor[1], donor[0])
    np.testing.assert_array_equal(mask, matched)
    np.testing.assert_allclose(values[matched], images[matched], atol=1e-12)
    assert np.isnan(values[~matched]).all()

    nearest = correspondence.vertex[matched]
    names = np.array([f"bone {v}" for v in range(len(donor[0]))])
    for data in (names, np.arange(len(names), dtype=np.int16), np.arange(len(names)) % 2 == 0):
        values, _ = transfer.transfer_point(correspondence, donor[1], data)
        assert values.dtype == data.dtype
        np.testing.assert_array_equal(values[matched], data[nearest])
        assert values[3] == np.zeros(1, dtype=data.dtype)[0]
    colours = np.full((len(donor[0]), 4), 255, dtype=np.uint8)
    values, _ = transfer.transfer_point(correspondence, donor[1], colours, mode="barycentric")
    assert values.dtype == np.uint8 and (values[matched] == 255).all() and (values[3] == 0).all()
    with pytest.raises(_native.InvalidInput, match="have no mean"):
        transfer.transfer_point(correspondence, donor[1], names, mode="barycentric")


@pytest.mark.parametrize("call", ["floats", "names", "islands"])
def test_values_per_point_and_islands_tell_how_far_they_are_and_stop_when_asked_to(call):
    correspondence, _, donor = pair("torus", COARSE, 0.37)
    names = np.array([f"bone {v}" for v in range(len(donor[0]))])

    def run(progress):
        if call == "islands":
            return transfer.uv_islands(donor[1], donor[2], vertices=donor[0], progress=progress)
        data = donor[0] if call == "floats" else names
        return transfer.transfer_point(correspondence, donor[1], data, progress=progress).values

    told = []
    np.testing.assert_array_equal(run(lambda *step: told.append(step)), run(None))
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[-1] == 1.0
    assert {stage for stage, _ in told} == {"islands" if call == "islands" else "points"}
    with pytest.raises(isograft.Cancelled):
        run(lambda *_: False)


def test_a_point_cloud_gives_the_value_of_the_nearest_vertex():
    correspondence = SimpleNamespace(face=[-1, -1, -1], barycentric=np.full((3, 3), np.nan), vertex=[2, -1, 0])
    values, mask = transfer.transfer_point(correspondence, None, np.array([0.5, 1.5, 2.5], dtype=np.float32))
    assert values.dtype == np.float32 and mask.tolist() == [True, False, True]
    np.testing.assert_array_equal(values, np.array([2.5, np.nan, 0.5], dtype=np.float32))


@pytest.mark.parametrize("kind", ["float", "integer", "string"])
def test_corner_values_that_jump_between_sides_do_not_mix(kind):
    correspondence, receiver, donor = pair("cube", RECEIVERS, 0.37)
    side = np.repeat(transfer.uv_islands(donor[1], donor[2]), 3)
    data = {"float": side * 10.0, "integer": side * 10, "string": np.array([f"side {s}" for s in side])}[kind]
    values, mask = transfer.transfer_corner(correspondence, *receiver[:2], *donor[:2], data)
    assert mask.all() and values.dtype == data.dtype
    island = move_uv(correspondence, receiver, donor).island
    for f, (a, b, c) in enumerate(values.reshape(-1, 3)):
        assert a == b == c == data[side == island[f]][0]


def test_smooth_corner_colours_are_interpolated_within_their_range():
    correspondence, receiver, donor = pair("sphere", RECEIVERS, 0.37)
    colour = 0.5 + 0.5 * donor[0][donor[1]]
    values, mask = transfer.transfer_corner(correspondence, *receiver[:2], *donor[:2], colour)
    images = images_of(correspondence, donor)
    assert mask.all() and values.shape == (3 * len(receiver[1]), 3)
    np.testing.assert_allclose(values, 0.5 + 0.5 * images[receiver[1].reshape(-1)], atol=1e-6)
    flat = np.repeat(np.arange(len(donor[1]), dtype=np.float64), 3)
    values, _ = transfer.transfer_corner(correspondence, *receiver[:2], *donor[:2], flat)
    assert np.isin(values, flat).all() and (np.ptp(values.reshape(-1, 3), axis=1) == 0).all()


def spoil(**changes):
    vertices, faces, uv = cylinder(4, 8)
    given = {"rv": vertices, "rf": faces, "dv": vertices, "df": faces, "uv": uv, "options": {}}
    given |= {"map": identity_map(vertices, faces)} | changes
    transfer.transfer_corner_uv(*(given[key] for key in ("map", "rv", "rf", "dv", "df", "uv")), **given["options"])


def bad_map(**changes):
    vertices, faces, _ = cylinder(4, 8)
    return SimpleNamespace(**(vars(identity_map(vertices, faces)) | changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"uv": np.zeros((5, 2))}, "192 rows.*64 triangles"),
        ({"uv": np.full((192, 2), np.nan)}, "NaN or infinity in 192 rows, the first is row 0"),
        ({"uv": np.zeros((192, 3))}, "2 columns, got 3"),
        ({"rv": np.zeros((39, 3))}, "`receiver_faces` holds indices out of range in"),
        ({"rv": np.zeros((41, 3))}, "`correspondence` has 40 rows, expected 41"),
        ({"df": np.full((64, 3), 40)}, "`donor_faces` holds indices out of range in 64 rows.*0 to 39"),
        ({"rf": np.zeros((64, 4), dtype=int)}, r"receiver_faces.*\(n, 3\)"),
        ({"map": bad_map(face=np.full(40, 64))}, "out of range in 40 rows.*64 triangles"),
        ({"map": bad_map(barycentric=np.ones((40, 3)))}, "no weights in 40 rows"),
        ({"map": bad_map(face=np.zeros(39))}, r"\(39,\)"),
        ({"options": {"tolerance": -1.0}}, "tolerance"),
        ({"options": {"extrapolation": np.inf}}, "extrapolation"),
        ({"options": {"receiver_polygons": np.zeros(3, dtype=int)}}, "receiver_polygons.*3 rows, expected 64"),
    ],
)
def test_input_that_does_not_fit_is_refused_with_what_where_and_how_many(changes, words):
    spoil()
    with pytest.raises(_native.InvalidInput, match=words):
        spoil(**changes)
