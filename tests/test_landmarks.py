# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks: arrays and files, by vertex or by position, with weights; and what is refused, in which words."""

import json
from pathlib import Path
from typing import Any

import isograft
import numpy as np
import pytest
from isograft.landmarks import read_landmarks, to_landmarks

from tests import surfaces

POINTS = np.random.default_rng(0).normal(size=(40, 3))
OTHERS = POINTS[::-1].copy()


@pytest.mark.parametrize(
    "given",
    [
        [[3, 36], [7, 32]],
        np.stack([POINTS[[3, 7]], OTHERS[[36, 32]]], axis=1),
        {"source": [3, 7], "target": [36, 32]},
        {"source": POINTS[[3, 7]], "target": [36, 32]},
        {"source": [3, 7], "target": OTHERS[[36, 32]] + 1e-3, "weight": [1.0, 1.0]},
    ],
)
def test_indices_positions_and_lists_say_the_same(given: Any) -> None:
    marks = to_landmarks(given, POINTS, OTHERS)
    assert marks.pairs.tolist() == [[3, 36], [7, 32]]
    assert marks.weights.tolist() == [1.0, 1.0]


def test_none_is_no_landmark() -> None:
    for given in (None, [], {"source": [], "target": []}):
        assert to_landmarks(given, POINTS, OTHERS).pairs.shape == (0, 2)


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("[[3, 36], [7, 32]]", [1.0, 1.0]),
        ("[[3, 36, 0.5], [7, 32]]", [0.5, 1.0]),
        ('{"source": [3, 7], "target": [36, 32], "weight": [0.25, 1]}', [0.25, 1.0]),
        (json.dumps([[POINTS[3].tolist(), 36], [POINTS[7].tolist(), 32, 0.1]]), [1.0, 0.1]),
    ],
)
def test_files_hold_pairs_or_lists_with_weights(tmp_path: Path, text: str, wanted: list[float]) -> None:
    path = tmp_path / "marks.json"
    path.write_text(text)
    marks = to_landmarks(read_landmarks(path), POINTS, OTHERS)
    assert marks.pairs.tolist() == [[3, 36], [7, 32]]
    assert marks.weights.tolist() == wanted


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"source": [1], "target": [2], "weight": [0.0]}, r"landmark 0: its weight must be in \(0, 1\]"),
        ({"source": [1], "target": [2], "weight": [0.5, 0.5]}, "1 landmarks, but weights of shape"),
        ({"source": [1], "target": [2], "colour": [0]}, 'perhaps "weight"'),
        ({"source": POINTS[:2] + 9.0, "target": [1, 2]}, "landmark 0: its source position .* away from the nearest"),
        ({"source": [[np.nan] * 3], "target": [1]}, "landmark 0: its source position .* not finite"),
        ({"source": POINTS[[4, 4]], "target": [1, 2]}, r"landmarks \[0, 1\] name the same source vertex 4"),
        ([[1, 2], [1, 3]], r"landmarks \[0, 1\] name the same source vertex 1"),
        (np.zeros((2, 2, 2)), r"shape \(k, 2\)"),
    ],
)
def test_what_cannot_be_used_is_refused_by_entry(given: Any, words: str) -> None:
    with pytest.raises(isograft.InvalidInput, match=words):
        to_landmarks(given, POINTS, OTHERS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[0, 1, 2.0]]", "entry 0: 2.0 is no weight"),
        ("[[0, 1, 1, 1]]", "entry 0 must be a pair"),
        ("[[[0, 0], 1]]", r"entry 0: \[0, 0\] is no position"),
        ("[[[0, 0, 1e999], 1]]", "is no position"),
        ("[[[0, 0, 0], 1], [5, 2]]", '"source" mixes vertex indices and positions'),
        ('{"source": [0], "target": [1], "weight": []}', "1 landmarks and 0 weights"),
        ('{"source": [0], "target": [1], "name": []}', 'two lists, "source" and "target"'),
    ],
)
def test_files_are_refused_by_name_and_entry(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "marks.json"
    path.write_text(text)
    with pytest.raises(isograft.InvalidInput, match=f"marks.json: .*{words}"):
        read_landmarks(path)


@pytest.fixture(scope="module")
def blob() -> surfaces.Mesh:
    return surfaces.blob()


def test_landmarks_alone_lead_both_engines(blob: surfaces.Mesh) -> None:
    marks = [[0, 0], [9, 9], [40, 40], [100, 100]]
    for preset in ("fast", "paper"):
        found = isograft.match(
            blob, blob, preset=preset, scale="fixed", landmarks=marks, threads=2, seed_landmarks_only=True
        )
        assert found.report.seeds_tried <= 12
        errors = np.linalg.norm(found.best.points - blob[0], axis=1)
        assert np.nanmedian(errors) < 0.1, preset
        assert found.best.coverage > 0.8, preset


@pytest.mark.parametrize("only", [False, True])
def test_two_landmarks_decide_where_the_shape_cannot(only: bool) -> None:
    # A sheet of twice the length lies on itself in two ways, and at every place as well as at any other.
    x, y = (side.ravel() for side in np.meshgrid(np.linspace(0.0, 1.0, 49), np.linspace(0.0, 0.5, 25)))
    sheet = np.stack([x, y, np.zeros_like(x)], axis=1)
    corner = (49 * np.arange(24)[:, None] + np.arange(48)).ravel()
    faces = np.concatenate([corner[:, None] + (0, 1, 50), corner[:, None] + (0, 50, 49)])
    near, far = 49 * 4 + 4, 49 * 18 + 40
    for marks, wanted in ([[near, near], [far, far]], sheet), ([[near, 1224 - near], [far, 1224 - far]], sheet[::-1]):
        found = isograft.match(
            (sheet, faces), (sheet, faces), preset="fast", landmarks=marks, threads=2, seed_landmarks_only=only
        )
        errors = np.linalg.norm(found.best.points - wanted, axis=1)
        assert found.best.coverage > 0.7
        assert np.nanmax(errors) < 0.1


def test_landmarks_that_contradict_the_shape_are_outvoted(blob: surfaces.Mesh) -> None:
    wrong = [[v, int(np.argmax(np.linalg.norm(blob[0] - blob[0][v], axis=1)))] for v in (0, 500, 1500)]
    found = isograft.match(blob, blob, preset="fast", scale="fixed", landmarks=[*wrong, [40, 40]], threads=2)
    errors = np.linalg.norm(found.best.points - blob[0], axis=1)
    assert found.best.coverage > 0.8
    assert np.nanmean(errors < 0.1) > 0.9


def test_landmarks_alone_without_landmarks_are_refused(blob: surfaces.Mesh) -> None:
    with pytest.raises(isograft.InvalidInput, match="landmarks_only needs landmarks"):
        isograft.match(blob, blob, preset="fast", seed_landmarks_only=True)
    with pytest.raises(isograft.InvalidInput, match="at least 2 landmarks"):
        isograft.match(blob, blob, preset="paper", landmarks=[[0, 0]], seed_landmarks_only=True)


def test_presets_take_q_and_radii_by_keyword() -> None:
    options = isograft.preset_options("paper")
    assert options["paper_threshold"] == 1.0
    assert (options["paper_radius_min"], options["paper_radius_max"]) == (0.9, 1.7)
    assert "paper" in isograft.presets()
