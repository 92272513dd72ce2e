# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of moving, mixing and tidying vertex-group weights."""

from __future__ import annotations

from types import SimpleNamespace

import isograft
import numpy as np
import pytest
from isograft import transfer
from isograft.transfer import MIX_MODES, mix_weights, tidy_weights, transfer_weights
from seamed_shapes import COARSE, identity_map, pair, torus

VERTICES, FACES, _ = torus(12, 9)
MAP = identity_map(VERTICES, FACES)
RANDOM = np.random.default_rng(5)
OWN = RANDOM.random((40, 6)) * (RANDOM.random((40, 6)) < 0.7)
MOVED = RANDOM.random((40, 6)) * (RANDOM.random((40, 6)) < 0.7)


def test_the_identity_gives_the_donors_weights_back():
    weights = RANDOM.random((len(VERTICES), 4)).astype(np.float32)
    moved, mask = transfer_weights(MAP, FACES, weights)
    assert mask.all() and moved.dtype == np.float32
    np.testing.assert_array_equal(moved, weights)


def test_weights_are_interpolated_like_any_value_and_sums_are_kept():
    correspondence, _, donor = pair("torus", COARSE, 0.37)
    correspondence.face[3], correspondence.vertex[3], correspondence.barycentric[3] = -1, -1, np.nan
    weights = RANDOM.random((len(donor[0]), 5))
    weights /= weights.sum(axis=1, keepdims=True)
    moved, mask = transfer_weights(correspondence, donor[1], weights)
    values, value_mask = transfer.transfer_point(correspondence, donor[1], weights)
    np.testing.assert_array_equal(mask, value_mask)
    np.testing.assert_allclose(moved[mask], values[mask], rtol=0, atol=1e-15)
    np.testing.assert_allclose(moved.sum(axis=1), mask.astype(float), rtol=0, atol=1e-12)


def test_a_point_cloud_gives_the_weights_of_the_nearest_vertex():
    cloud = SimpleNamespace(face=[-1, -1, -1], barycentric=np.full((3, 3), np.nan), vertex=[2, -1, 0])
    moved, mask = transfer_weights(cloud, None, [[0.1], [0.2], [0.3]])
    np.testing.assert_array_equal(moved, [[0.3], [0.0], [0.1]])
    assert mask.tolist() == [True, False, True]


def test_moving_weights_tells_how_far_it_is_and_stops_when_asked_to():
    # More rows than are moved at a time.
    count = 70_000
    correspondence = SimpleNamespace(
        face=np.arange(count) % len(FACES), barycentric=np.full((count, 3), 1 / 3), vertex=np.full(count, -1)
    )
    weights = RANDOM.random((len(VERTICES), 2))
    told = []
    moved = transfer_weights(correspondence, FACES, weights, progress=lambda *step: told.append(step))
    np.testing.assert_array_equal(moved.values, transfer_weights(correspondence, FACES, weights).values)
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions) and fractions[0] == 0.0 and fractions[-1] == 1.0
    assert len({fraction for stage, fraction in told if stage == "weights"}) >= 4
    for end in fractions[:-1]:
        with pytest.raises(isograft.Cancelled):
            transfer_weights(correspondence, FACES, weights, progress=lambda _, at, end=end: at < end)


@pytest.mark.parametrize("mode", MIX_MODES)
def test_each_mode_follows_its_formula(mode):
    mix = 0.4
    blend = {
        "replace": MOVED,
        "mix": (OWN + MOVED) / 2,
        "add": OWN + MOVED,
        "subtract": OWN - MOVED,
        "multiply": OWN * MOVED,
    }
    if mode == "above_threshold":
        expected = np.where((mix <= OWN) & (OWN > 0), MOVED, OWN)
    elif mode == "below_threshold":
        expected = np.where(mix >= OWN, MOVED, OWN)
    else:
        expected = np.clip(mix * blend[mode] + (1 - mix) * OWN, 0, 1)
    np.testing.assert_allclose(mix_weights(OWN, MOVED, mode=mode, mix=mix), expected, rtol=0, atol=1e-15)


@pytest.mark.parametrize("mode", MIX_MODES)
def test_locked_groups_and_unmatched_vertices_stay_bit_for_bit(mode):
    locked = np.arange(6) == 2
    mask = np.arange(40) % 3 > 0
    mixed = mix_weights(OWN, MOVED, mode=mode, mix=0.3, mask=mask, locked=locked)
    np.testing.assert_array_equal(mixed[:, 2], OWN[:, 2])
    np.testing.assert_array_equal(mixed[~mask], OWN[~mask])
    tidied = tidy_weights(mixed, normalise=True, limit=2, prune=0.2, mask=mask, locked=locked)
    np.testing.assert_array_equal(tidied[:, 2], OWN[:, 2])
    np.testing.assert_array_equal(tidied[~mask], OWN[~mask])
    assert not np.array_equal(tidied, OWN)


def test_whole_factors_are_exact():
    np.testing.assert_array_equal(mix_weights(OWN, MOVED), MOVED)
    np.testing.assert_array_equal(mix_weights(OWN, MOVED, mix=0.0), OWN)


def test_the_largest_weights_stay_and_the_first_of_equal_ones():
    weights = np.array([[0.2, 0.5, 0.2, 0.1], [0.3, 0.3, 0.3, 0.3], [0.0, 0.0, 0.9, 0.0]])
    np.testing.assert_array_equal(
        tidy_weights(weights, limit=2), [[0.2, 0.5, 0.0, 0.0], [0.3, 0.3, 0.0, 0.0], [0.0, 0.0, 0.9, 0.0]]
    )
    locked = np.array([False, False, False, True])
    np.testing.assert_array_equal(
        tidy_weights(weights, limit=2, locked=locked),
        [[0.0, 0.5, 0.0, 0.1], [0.3, 0.0, 0.0, 0.3], [0.0, 0.0, 0.9, 0.0]],
    )


def test_normalised_rows_sum_to_one_around_what_is_locked():
    locked = np.arange(6) == 1
    tidied = tidy_weights(OWN, normalise=True, locked=locked)
    free = OWN[:, ~locked].sum(axis=1)
    np.testing.assert_allclose(tidied[free > 0].sum(axis=1), 1.0, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(tidied[free == 0], OWN[free == 0])
    # Proportions between the free groups do not change.
    cross = tidied[:, 0] * OWN[:, 3] - tidied[:, 3] * OWN[:, 0]
    np.testing.assert_allclose(cross, 0.0, rtol=0, atol=1e-12)
    full = tidy_weights([[1.0, 0.5]], normalise=True, locked=np.array([True, False]))
    np.testing.assert_array_equal(full, [[1.0, 0.0]])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: transfer_weights(MAP, FACES, np.full((108, 2), -1.0)),
         "donor_weights: 216 weights are negative or not finite, the first is -1.0 in row 0, group 0"),
        (lambda: transfer_weights(MAP, FACES, np.ones(108)), r"\(vertices, groups\)"),
        (lambda: transfer_weights(MAP, FACES, np.ones((90, 2))), "out of range"),
        (lambda: mix_weights(OWN, MOVED[:-1]), "one shape"),
        (lambda: mix_weights(OWN, MOVED, mode="divide"), "mode must be one of replace, above_threshold"),
        (lambda: mix_weights(OWN, MOVED, mix=1.5), "mix must be from 0 to 1"),
        (lambda: mix_weights(OWN, MOVED, locked=np.zeros(5, bool)), r"locked must be booleans of shape \(6,\)"),
        (lambda: tidy_weights(OWN, limit=0), "limit must be at least 1"),
        (lambda: tidy_weights(OWN, mask=np.ones(3, bool)), r"mask must be booleans of shape \(40,\)"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_refused(call, words):
    with pytest.raises(isograft.InvalidInput, match=words):
        call()
