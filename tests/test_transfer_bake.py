# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of baking images into the receiver's UVs."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from isograft.transfer import Channel
from seamed_shapes import COARSE, RECEIVERS, SHAPES, closest_points, correspondence_of, grid, identity_map, pair, torus

# No texel's centre lies on an edge of a triangle there.
LOW, HIGH = 0.1037, 0.8951


def cells(count):
    return int(np.ceil(np.sqrt(count)))


def own_layout(faces):
    """A layout of its own for any mesh: every triangle in a cell of a square of cells, none touching another."""
    columns = cells(len(faces))
    cell = np.stack(np.divmod(np.arange(len(faces)), columns)[::-1], axis=1)
    return (cell[:, None] + np.array([[LOW, LOW], [HIGH, LOW], [LOW, HIGH]])) / columns


def texel_points(faces, vertices, size):
    """In own_layout() per texel its triangle (-1 none) and the point there."""
    columns = cells(len(faces))
    at = (np.stack(np.meshgrid(np.arange(size), np.arange(size)), axis=-1) + 0.5) / size * columns
    cell = np.floor(at).astype(int)
    owner = cell[..., 1] * columns + cell[..., 0]
    second, third = np.moveaxis((at - cell - LOW) / (HIGH - LOW), -1, 0)
    weights = np.stack([1 - second - third, second, third], axis=-1)
    owner[(weights < 0).any(axis=-1) | (owner >= len(faces))] = -1
    points = (weights[..., None] * vertices[faces[owner]]).sum(axis=-2)
    return owner, np.where(owner[..., None] < 0, 0.0, points)


def linear_image(height, width):
    """Channels that grow linearly in u, in v, and are 1: read exactly between pixel centres."""
    u, v = (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height
    return np.stack([*np.broadcast_arrays(u[None], v[:, None]), np.ones((height, width))], axis=-1).astype(np.float32)


def flat(rows, columns):
    faces, corners = grid(rows, columns)
    i, j = np.divmod(np.arange((rows + 1) * (columns + 1)), columns + 1)
    vertices = np.stack([j / columns, i / rows, np.zeros(len(i))], axis=1)
    return vertices, faces, corners[..., ::-1] / [columns, rows]


def test_on_a_plane_every_texel_reads_the_true_place():
    donor, receiver = flat(7, 5), flat(4, 9)
    face, weights = closest_points(receiver[0], *donor[:2])
    correspondence = correspondence_of(face, weights, donor[1])
    layout, size = own_layout(receiver[1]), 96
    baked = transfer.bake(
        correspondence, *receiver[:2], layout, *donor, Channel(linear_image(64, 80), extension="extend"), size, margin=0
    )
    owner, points = texel_points(receiver[1], receiver[0], size)
    np.testing.assert_array_equal(baked.mask == 1, owner >= 0)
    assert (owner >= 0).sum() > 2000 and baked.mask.max() == 1
    # The donor's UVs are its x and y; the image's outermost half pixels are extended.
    truth = np.clip(points[..., :2], [0.5 / 80, 0.5 / 64], [1 - 0.5 / 80, 1 - 0.5 / 64])
    np.testing.assert_allclose(baked.images[0][owner >= 0][:, :2], truth[owner >= 0], rtol=0, atol=1e-6)
    assert (baked.images[0][owner < 0] == 0).all()


@pytest.mark.parametrize("name", SHAPES)
def test_the_identity_reads_every_texel_at_its_own_uv(name):
    vertices, faces, uv = SHAPES[name](*COARSE[name])
    baked = transfer.bake(
        identity_map(vertices, faces), vertices, faces, uv, vertices, faces, uv,
        Channel(linear_image(50, 50), extension="extend"), 64, margin=0,
    )  # fmt: skip
    at = (np.stack(np.meshgrid(np.arange(64), np.arange(64)), axis=-1) + 0.5) / 64
    inside = baked.mask == 1
    assert inside.mean() > 0.4
    off = np.abs(baked.images[0][..., :2] - np.clip(at, 0.01, 0.99))[inside].max(axis=-1)
    # Where two triangles meet in the layout and not in space, a texel of the edge may be either's.
    assert np.quantile(off, 0.99) < 1e-6


@pytest.mark.parametrize("name", SHAPES)
def test_a_colour_of_the_place_arrives_at_the_place_across_all_seams(name):
    """The donor's texture holds its own positions: texels get positions of the donor near the receiver's."""
    correspondence, receiver, donor = pair(name, RECEIVERS, 0.0 if name == "cube" else 0.37)
    uv = own_layout(donor[1])
    _, texture = texel_points(donor[1], donor[0], 512)
    images = Channel(texture.astype(np.float32), interpolation="closest")
    layout, size = own_layout(receiver[1]), 256
    baked = transfer.bake(correspondence, *receiver[:2], layout, *donor[:2], uv, images, size, margin=0)
    owner, points = texel_points(receiver[1], receiver[0], size)
    np.testing.assert_array_equal(baked.mask == 1, owner >= 0)
    known = (owner >= 0) & (baked.images[0] != 0).any(axis=-1)
    assert known.sum() > 0.75 * (owner >= 0).sum()
    off = np.linalg.norm(baked.images[0] - points, axis=-1)[known]
    edge = np.linalg.norm(donor[0][donor[1][:, 0]] - donor[0][donor[1][:, 1]], axis=1).max()
    # A pixel of the texture and how far the two flat tessellations lie from each other.
    assert off.max() < 0.4 * edge


def test_a_triangle_over_many_donor_triangles_is_continuous_in_place():
    """No texel jumps: neighbours on the receiver read neighbouring places of a bent donor with a cut."""
    correspondence, receiver, donor = pair("sphere", COARSE, 0.37)
    image = Channel(np.random.default_rng(0).random((8, 8, 3)).astype(np.float32))
    smooth = np.stack([donor[0][donor[1]][..., k] for k in (0, 1)], axis=-1) * 0.4 + 0.5
    texture = linear_image(400, 400)
    layout = own_layout(receiver[1])
    baked = transfer.bake(
        correspondence, *receiver[:2], layout, *donor[:2], smooth, Channel(texture, extension="extend"), 256, margin=0
    )
    owner, points = texel_points(receiver[1], receiver[0], 256)
    unit = points / np.maximum(np.linalg.norm(points, axis=-1, keepdims=True), 1e-9)
    off = np.abs(baked.images[0][..., :2] - (unit[..., :2] * 0.4 + 0.5))[owner >= 0]
    # The flat triangles of COARSE stand off the sphere by up to 0.15; projected along normals little of it is left.
    assert off.max() < 0.06 and off.mean() < 0.01
    assert image.kind == "color"


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_channels_materials_and_constants_each_give_their_own(dtype):
    vertices, faces, uv = torus(12, 9)
    full = 255 if dtype == np.uint8 else 1.0
    material = np.arange(len(faces)) % 3
    red = np.zeros((4, 4, 3), dtype)
    red[..., 0] = full
    grey = np.array([full], dtype)
    layout = own_layout(faces)
    background = [np.full((128, 128, 3), full, dtype), np.zeros((128, 128), dtype)]
    baked = transfer.bake(
        identity_map(vertices, faces), vertices, faces, layout, vertices, faces, uv,
        [Channel([red, np.array([0, full, 0], dtype), None]), Channel([grey, 0 * grey, grey])], 128,
        donor_materials=material, margin=0, background=background,
    )  # fmt: skip
    assert [image.dtype for image in baked.images] == [dtype, dtype]
    owner, _ = texel_points(faces, vertices, 128)
    expected = np.array([[full, 0, 0], [0, full, 0], [full, full, full]], dtype)
    inside = owner >= 0
    np.testing.assert_allclose(baked.images[0][inside], expected[material[owner[inside]]], atol=1e-6)
    np.testing.assert_allclose(
        baked.images[1][inside, 0], np.array([full, 0, full])[material[owner[inside]]], atol=1e-6
    )
    assert (baked.images[0][~inside] == full).all()


def test_the_margin_takes_the_nearest_texel_and_ends_where_it_should():
    vertices, faces, uv = flat(1, 1)
    layout = 0.4 + 0.2 * uv
    texture = np.random.default_rng(1).random((64, 64, 2)).astype(np.float32)
    baked = transfer.bake(
        identity_map(vertices, faces), vertices, faces, layout, vertices, faces, uv, Channel(texture), 60, margin=7
    )
    y, x = np.indices((60, 60))
    inside = baked.mask == 1
    np.testing.assert_array_equal(inside, (x >= 24) & (x < 36) & (y >= 24) & (y < 36))
    near_x, near_y = np.clip(x, 24, 35), np.clip(y, 24, 35)
    distance = np.hypot(x - near_x, y - near_y)
    np.testing.assert_array_equal(baked.mask == 2, (distance > 0) & (distance <= 7))
    filled = baked.mask > 0
    np.testing.assert_array_equal(baked.images[0][filled], baked.images[0][near_y, near_x][filled])
    assert (baked.images[0][~filled] == 0).all()


def test_extensions_and_interpolations_read_beyond_the_borders_as_they_say():
    vertices, faces, uv = flat(1, 1)
    texture = np.array([[1.0, 2.0], [3.0, 4.0]], np.float32)
    wide = 3.0 * uv - 1.0
    read = {
        (extension, interpolation): transfer.bake(
            identity_map(vertices, faces), vertices, faces, uv, vertices, faces, wide,
            Channel(texture, extension=extension, interpolation=interpolation), 12, margin=0,
        ).images[0][..., 0]
        for extension in ("repeat", "extend", "clip")
        for interpolation in ("linear", "closest")
    }  # fmt: skip
    closest = np.kron(texture, np.ones((2, 2), np.float32))
    np.testing.assert_array_equal(read["repeat", "closest"], np.tile(closest, (3, 3)))
    np.testing.assert_array_equal(read["clip", "closest"], np.pad(closest, 4))
    np.testing.assert_array_equal(read["extend", "closest"], np.pad(closest, 4, mode="edge"))
    for kind in ("repeat", "extend", "clip"):
        middle = read[kind, "linear"][5:7, 5:7]
        np.testing.assert_allclose(middle, [[1.75, 2.25], [2.75, 3.25]], atol=1e-6)
    np.testing.assert_allclose(read["repeat", "linear"][:4, :4], read["repeat", "linear"][4:8, 4:8], atol=1e-6)
    assert read["clip", "linear"][0, 0] == 0.0 and read["extend", "linear"][0, 0] == 1.0


def tangent_space(vertices, faces, uv, f, world):
    """A direction in the tangent frame of triangle f, by hand."""
    a, b, c = vertices[faces[f]]
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal)
    du = uv[f, 1:] - uv[f, 0]
    tangent = np.linalg.solve(du, np.stack([b - a, c - a]))[0]
    tangent /= np.linalg.norm(tangent)
    bitangent = np.sign(np.linalg.det(du)) * np.cross(normal, tangent)
    return np.array([world @ tangent, world @ bitangent, world @ normal])


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_normals_keep_their_direction_in_space(angle, mirrored):
    """A bump leaning one way on the donor leans that way on the receiver, however the UVs of both lie."""
    vertices, faces, uv = flat(3, 4)
    spin = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    layout = 0.5 + 0.3 * ((uv - 0.5) * [-1.0 if mirrored else 1.0, 1.0]) @ spin.T
    turn, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    world = np.array([0.48, -0.36, 0.8])
    texture = np.broadcast_to(0.5 + 0.5 * tangent_space(vertices, faces, uv, 0, world), (4, 4, 3)).astype(np.float32)
    for receiver, receiver_world in ((vertices, world), (2.0 * vertices @ turn.T, turn @ world)):
        baked = transfer.bake(
            identity_map(vertices, faces), receiver, faces, layout, vertices, faces, uv,
            Channel(texture, kind="normal"), 64, margin=0,
        )  # fmt: skip
        expected = tangent_space(receiver, faces, layout, 0, receiver_world)
        found = 2.0 * baked.images[0][baked.mask == 1] - 1.0
        np.testing.assert_allclose(found, np.broadcast_to(expected, found.shape), rtol=0, atol=1e-5)


@pytest.mark.parametrize("name", ["torus", "sphere"])
def test_a_normal_map_baked_onto_its_own_surface_stays_what_it_was(name):
    vertices, faces, uv = SHAPES[name](*COARSE[name])
    texture = np.random.default_rng(5).random((64, 64, 3)).astype(np.float32)
    arguments = identity_map(vertices, faces), vertices, faces, uv, vertices, faces, uv
    turned = transfer.bake(*arguments, Channel(texture, kind="normal"), 64, margin=0)
    plain = transfer.bake(*arguments, Channel(texture), 64, margin=0)
    np.testing.assert_allclose(turned.images[0], plain.images[0], rtol=0, atol=2e-4)


def test_the_result_does_not_depend_on_threads_and_lands_in_out(tmp_path):
    correspondence, receiver, donor = pair("torus", COARSE, 0.37)
    layout, texture = own_layout(receiver[1]), np.random.default_rng(6).random((32, 32, 3)).astype(np.float32)
    arguments = correspondence, *receiver[:2], layout, *donor, [Channel(texture), Channel(texture, kind="normal")], 1100
    one = transfer.bake(*arguments, threads=1)
    out = [np.memmap(tmp_path / f"{i}.raw", np.float32, "w+", shape=(1100, 1100, 3)) for i in range(2)]
    three = transfer.bake(*arguments, threads=3, out=out)
    np.testing.assert_array_equal(one.mask, three.mask)
    for left, right in zip(one.images, out, strict=True):
        np.testing.assert_array_equal(left, right)


def test_unmatched_torn_and_unwanted_triangles_are_not_baked():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    wanted = np.arange(len(receiver[1])) % 2 == 0
    correspondence.face[5], correspondence.vertex[5], correspondence.barycentric[5] = -1, -1, np.nan
    stray = 100
    correspondence.face[stray] = (correspondence.face[stray] + len(donor[1]) // 2) % len(donor[1])
    layout = own_layout(receiver[1])
    baked = transfer.bake(
        correspondence, *receiver[:2], layout, *donor, Channel(linear_image(8, 8)), 512, margin=0, receiver_mask=wanted
    )
    owner, _ = texel_points(receiver[1], receiver[0], 512)
    bad = ~wanted | np.isin(receiver[1], [5, stray]).any(axis=1)
    np.testing.assert_array_equal(baked.mask == 1, (owner >= 0) & ~bad[owner])


BYTES = np.zeros((4, 4, 3), np.uint8)


@pytest.mark.parametrize(
    ("channel", "options", "words"),
    [
        (Channel(np.zeros((4, 4, 3))), {}, "image 0 must be uint8 or float32, not float64"),
        (Channel([BYTES, BYTES.astype(np.float32)]), {}, "one type and as many components"),
        (Channel([None]), {}, "no image at all"),
        (Channel(np.zeros((4, 4, 5), np.uint8)), {}, "image 0 must have shape"),
        (Channel(BYTES, kind="bump"), {}, "kind must be one of color, normal"),
        (Channel(BYTES[..., :2], kind="normal"), {}, "normal map and has less than 3"),
        (Channel(BYTES, uv=np.zeros((5, 2))), {}, "channel 0: uv: expected 648 rows"),
        (Channel(BYTES), {"size": 0}, "size must be from 1 to 65536"),
        (Channel(BYTES), {"margin": -1}, "margin must be from 0"),
        (
            Channel(BYTES),
            {"donor_materials": np.ones(216, int)},
            "out of range in row 0: 1, channel 0 has images for 1",
        ),
        (Channel(BYTES), {"receiver_mask": np.ones(3, bool)}, "mask has 3 rows, expected 216"),
        (Channel(BYTES), {"out": [np.zeros((8, 8, 3))]}, "writable contiguous uint8"),
        (Channel(BYTES), {"background": [np.zeros((9, 8, 3), np.uint8)]}, "background: image 0 must be uint8"),
        ([], {}, "give at least one"),
    ],
)
def test_what_does_not_fit_is_refused(channel, options, words):
    vertices, faces, uv = torus(12, 9)
    given = {"size": 8} | options
    size = given.pop("size")
    with pytest.raises(isograft.InvalidInput, match=words):
        transfer.bake(identity_map(vertices, faces), vertices, faces, uv, vertices, faces, uv, channel, size, **given)


def test_a_cancelled_bake_stops():
    vertices, faces, uv = torus(12, 9)
    with pytest.raises(isograft.Cancelled):
        transfer.bake(
            identity_map(vertices, faces), vertices, faces, uv, vertices, faces, uv, Channel(BYTES), 64,
            progress=lambda *_: False,
        )  # fmt: skip
