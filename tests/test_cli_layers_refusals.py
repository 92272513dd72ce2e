# SPDX-License-Identifier: GPL-3.0-or-later
"""What `isograft transfer` refuses of layers and their files, in which words; nothing is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from transfer_files import assert_refused, run

REFUSALS = [
    (["--what", "weights"], "donor.obj: the donor has no vertex group; give a file that has with --target-data"),
    (["--what", "color", "--target-data", "all.npz"], "--target-data is given and none of uv, attributes, weights"),
    (["--what", "weights", "--key-scale", "2"], "--key-scale is given and none of keys is in --what"),
    (
        ["--what", "weights", "--target-data", "all.npz", "--names", "Arm*"],
        "no vertex group called Arm*; it has: Up per",
    ),
    (["--what", "weights", "--target-data", "none.npz"], "none.npz: No such file"),
    (["--what", "weights", "--target-data", "donor.obj"], "donor.obj: layers are read from .npz files"),
    (["--what", "weights", "--target-data", "map.npz"], "map.npz: the array target_size is none of point/NAME"),
    (["--what", "weights", "--source-data", "all.npz"], "all.npz: edges row"),
    (["--what", "weights", "--target-data", "all.npz", "--locked", "Arm"], "receiver has no vertex group or shape key"),
    (["--what", "weights", "--target-data", "all.npz", "--mix-factor", "2"], "--mix-factor must be from 0 to 1"),
    (["--what", "weights", "--target-data", "all.npz", "--limit-total", "0"], "--limit-total must be at least 1"),
    (["--what", "keys", "--target-data", "all.npz", "--key-scale", "tall"], "global, local or a positive number"),
    (["--what", "keys", "--target-data", "all.npz", "--key-smoothing", "-1"], "--key-smoothing must not be negative"),
    (["--what", "keys", "--target-data", "all.npz", "--data-output", "all.npz"], "would be written over, and is read"),
    (["--what", "keys", "--target-data", "all.npz", "--data-output", "keys.txt"], "must end in .npz"),
]


@pytest.mark.parametrize(("options", "words"), REFUSALS, ids=[" ".join(options) for options, _ in REFUSALS])
def test_what_cannot_be_done_is_refused_and_nothing_is_written(
    layer_folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, options, words
) -> None:
    monkeypatch.chdir(layer_folder)
    assert_refused(layer_folder, capsys, options, words)


WRONG = [
    ("point/height", np.zeros(3), "point/height has 3 rows, "),
    ("corner/tint", np.zeros(3), "1152 corners of polygons"),
    ("face/material", np.zeros(3), "288 polygons"),
    ("edge/crease", np.zeros(3), "edge/crease needs the array edges"),
    ("weights/Arm", np.zeros((312, 2)), "weights/Arm should be numbers of shape (312,)"),
    ("weights/Arm", np.full(312, -1.0), "weights: donor_weights: 312 weights are negative"),
    ("keys/Smile", np.zeros(312), "keys/Smile should be numbers of shape (312, 3)"),
    ("keys/Smile", np.full((312, 3), np.nan), "keys: donor_keys: key 0 is not finite in 312 vertices"),
    ("uv/Second", np.zeros((1152, 3)), "uv/Second should be numbers of shape (1152, 2)"),
    ("normals", np.zeros((1152, 2)), "normals should be numbers of shape (1152, 3)"),
    ("point/when", np.zeros(312, "datetime64[s]"), "point/when holds datetime64[s]"),
    ("corner/tint", np.full(1152, np.nan), "corner/tint: "),
    ("height", np.zeros(312), "the array height is none of point/NAME"),
]


@pytest.mark.parametrize(("name", "array", "words"), WRONG, ids=[f"{name} {words}" for name, _, words in WRONG])
def test_data_that_do_not_fit_are_refused_by_the_name_of_the_array(
    layer_folder: Path, capsys: pytest.CaptureFixture[str], name, array, words
) -> None:
    np.savez(layer_folder / "all.npz", **{name: array})
    kind = {"weights": "weights", "keys": "keys", "normals": "normals", "uv": "uv"}.get(
        name.partition("/")[0], "attributes"
    )
    assert run(layer_folder, "bare.obj", "--what", kind, "--target-data", str(layer_folder / "all.npz")) == 2
    assert words in capsys.readouterr().err
    assert not (layer_folder / "out.obj").exists() and not (layer_folder / "out.npz").exists()
