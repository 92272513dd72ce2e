# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of local frames and of the shape keys that are carried in them."""

from __future__ import annotations

import isograft
import numpy as np
import pytest
from isograft import transfer
from seamed_shapes import COARSE, RECEIVERS, SHAPES, cylinder, identity_map, pair, torus

TURN, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
TURN *= np.linalg.det(TURN)


def normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    summed = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(summed, faces[:, k], np.cross(b - a, c - a))
    return summed / np.maximum(np.linalg.norm(summed, axis=1, keepdims=True), 1e-30)


@pytest.mark.parametrize("name", SHAPES)
def test_keys_turn_and_grow_with_a_rigid_motion_and_a_scale(name):
    correspondence, receiver, donor = pair(name, COARSE, 0.0)
    keys = np.random.default_rng(2).normal(size=(3, len(donor[0]), 3))
    still = transfer.transfer_shape_keys(correspondence, *receiver[:2], *donor[:2], keys)
    moved = transfer.transfer_shape_keys(
        correspondence, 2.5 * receiver[0] @ TURN.T + [1.0, -4.0, 2.0], receiver[1], *donor[:2], keys
    )
    np.testing.assert_array_equal(moved.mask, still.mask)
    np.testing.assert_allclose(moved.values, 2.5 * still.values @ TURN.T, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("scale", ["global", "local", 2.5])
def test_of_one_mesh_turned_and_scaled_keys_are_known_exactly(name, scale):
    vertices, faces, _ = SHAPES[name](*COARSE[name])
    keys = np.random.default_rng(2).normal(size=(2, len(vertices), 3))
    moved = transfer.transfer_shape_keys(
        identity_map(vertices, faces), 2.5 * vertices @ TURN.T, faces, vertices, faces, keys, scale=scale
    )
    used = np.unique(faces)
    assert moved.mask[used].all()
    np.testing.assert_allclose(moved.values[:, used], 2.5 * keys[:, used] @ TURN.T, rtol=0, atol=1e-9)


def test_a_winding_turned_over_changes_nothing():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    keys = np.random.default_rng(2).normal(size=(1, len(donor[0]), 3))
    plain = transfer.transfer_shape_keys(correspondence, *receiver[:2], *donor[:2], keys)
    turned = transfer.transfer_shape_keys(correspondence, receiver[0], receiver[1][:, ::-1], *donor[:2], keys)
    np.testing.assert_allclose(turned.values, plain.values, rtol=0, atol=1e-9)


def bent(points, bend):
    """A tube along z whose upper half is turned by `bend` about the x axis at z = 2."""
    c, s = np.cos(bend), np.sin(bend)
    upper = (points - [0, 0, 2]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T + [0, 0, 2]
    return np.where(points[:, 2:] > 2.0, upper, points)


def test_keys_follow_a_limb_into_its_pose():
    vertices, faces, _ = cylinder(40, 24)
    posed = bent(vertices, 0.8)
    keys = np.stack([normals(vertices, faces), np.tile([0.0, 0.0, 1.0], (len(vertices), 1))])
    moved = transfer.transfer_shape_keys(identity_map(vertices, faces), posed, faces, vertices, faces, keys)
    # Where the frames' few edges do not reach the joint, what the limb did is what the key did.
    far = (abs(vertices[:, 2] - 2.0) > 0.5) & (vertices[:, 2] > 0.5) & (vertices[:, 2] < 3.5)
    turned = np.stack([bent(vertices + key * 1e-3, 0.8) - posed for key in keys]) / 1e-3
    np.testing.assert_allclose(moved.values[:, far], turned[:, far], rtol=0, atol=1e-6)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_what_another_shape_in_the_same_pose_has_of_its_own_does_not_turn_the_keys(seed):
    """Two persons: every point moved at random and smoothly, in all directions alike, and no part turned."""
    vertices, faces, _ = torus(60, 24)
    random = np.random.default_rng(seed)
    other = vertices.copy()
    for _ in range(6):
        wave, phase, along = random.normal(size=3), random.uniform(0, 6), random.normal(size=3)
        other += 0.08 * np.sin(vertices @ wave + phase)[:, None] * along
    keys = np.stack([normals(vertices, faces), np.tile([0.0, 0.0, 1.0], (len(vertices), 1))])
    errors = []
    for smoothing in (None, 2):
        arguments = identity_map(vertices, faces), other, faces, vertices, faces
        assert transfer.local_frames(*arguments, smoothing=smoothing).one_pose == (smoothing is None)
        moved = transfer.transfer_shape_keys(*arguments, keys, smoothing=smoothing, scale=1.0)
        errors.append(np.linalg.norm(moved.values - keys, axis=2).mean())
    assert errors[0] < 0.6 * errors[1]


def test_where_a_limb_turns_frames_are_those_of_a_few_edges():
    vertices, faces, _ = cylinder(40, 24)
    arguments = identity_map(vertices, faces), bent(vertices, 0.8), faces, vertices, faces
    chosen, few = transfer.local_frames(*arguments), transfer.local_frames(*arguments, smoothing=2)
    assert not chosen.one_pose
    np.testing.assert_array_equal(chosen.rotation, few.rotation)


def test_unmatched_vertices_do_not_move_and_types_are_kept():
    vertices, faces, _ = torus(14, 9)
    correspondence = identity_map(vertices, faces)
    lost = np.arange(0, len(vertices), 10)
    correspondence.face[lost], correspondence.vertex[lost], correspondence.barycentric[lost] = -1, -1, np.nan
    key = np.random.default_rng(2).normal(size=vertices.shape).astype(np.float32)
    moved = transfer.transfer_shape_keys(correspondence, vertices, faces, vertices, faces, key)
    assert moved.values.dtype == np.float32 and moved.values.shape == vertices.shape
    assert not moved.mask[lost].any() and (moved.values[~moved.mask] == 0).all()
    np.testing.assert_allclose(moved.values[moved.mask], key[moved.mask], rtol=0, atol=1e-5)


def test_frames_do_not_depend_on_threads_and_are_rotations():
    correspondence, receiver, donor = pair("torus", RECEIVERS, 0.37)
    one = transfer.local_frames(correspondence, *receiver[:2], *donor[:2], threads=1)
    three = transfer.local_frames(correspondence, *receiver[:2], *donor[:2], threads=3)
    for left, right in zip(one, three, strict=True):
        np.testing.assert_array_equal(left, right)
    np.testing.assert_allclose(np.linalg.det(one.rotation), 1.0, rtol=0, atol=1e-9)
    gram = one.rotation @ one.rotation.transpose(0, 2, 1)
    np.testing.assert_allclose(gram, np.broadcast_to(np.eye(3), gram.shape), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"keys": np.zeros((2, 5, 3))}, r"shape \(keys, 126, 3\)"),
        ({"keys": np.full((2, 126, 3), np.nan)}, "key 0 is not finite in 126 vertices, the first is 0"),
        ({"scale": "big"}, '"global", "local" or a positive number'),
        ({"scale": -1.0}, "scale must be positive"),
        ({"smoothing": -1}, "smoothing must be from 0 to 100, got -1"),
    ],
)
def test_what_does_not_fit_is_refused(changes, words):
    vertices, faces, _ = torus(14, 9)
    options = dict(changes)
    keys = options.pop("keys", np.zeros((1, 126, 3)))
    with pytest.raises(isograft.InvalidInput, match=words):
        transfer.transfer_shape_keys(identity_map(vertices, faces), vertices, faces, vertices, faces, keys, **options)
    with pytest.raises(isograft.Cancelled):
        transfer.transfer_shape_keys(
            identity_map(vertices, faces), vertices, faces, vertices, faces, np.zeros((1, 126, 3)),
            progress=lambda *_: False,
        )  # fmt: skip
