# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfers on scanned and modelled surfaces whose truth is known; data as for test_accuracy.py."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from isograft import transfer
from isograft.files import read_mesh
from seamed_shapes import identity_map

ROOT = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("ISOGRAFT_DATA") or ROOT.parent / "shared" / "data")
TURN, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
TURN *= np.linalg.det(TURN)

if not DATA.is_dir():
    pytest.skip(f"no pairs with a known truth in {DATA}", allow_module_level=True)


def test_face_expressions_arrive_on_another_persons_face():
    """In this data an expression moves every person's vertices alike: the truth, but for how the shapes differ."""
    person, other = (read_mesh(DATA / f"faces/ict_{name}_neutral.obj") for name in ("s101", "s102"))
    keys = np.stack(
        [read_mesh(DATA / f"faces/ict_s101_{name}.obj").vertices - person.vertices for name in ("smile", "jawopen")]
    )
    correspondence = identity_map(person.vertices, person.faces)
    moved = transfer.transfer_shape_keys(
        correspondence, other.vertices, other.faces, person.vertices, person.faces, keys
    )
    assert moved.mask.all()
    off = np.linalg.norm(moved.values - keys, axis=2).mean(axis=1) / np.linalg.norm(keys, axis=2).mean(axis=1)
    assert (off < 0.25).all()
    # On a face that is only turned and scaled there is no such difference.
    turned = transfer.transfer_shape_keys(
        correspondence, 0.01 * person.vertices @ TURN.T, person.faces, person.vertices, person.faces, keys
    )
    np.testing.assert_allclose(turned.values, 0.01 * keys @ TURN.T, rtol=0, atol=1e-6)
