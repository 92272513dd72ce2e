# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts that scripts/benchmark is made of, without a run."""

from __future__ import annotations

import sys
from pathlib import Path

import isograft
import numpy as np
import pytest
import surfaces

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from isograft.evaluation import Truth, evaluate  # noqa: E402

from benchmarks.cases import Case  # noqa: E402
from benchmarks.closest_point import closest_points  # noqa: E402
from benchmarks.methods import find  # noqa: E402
from benchmarks.results import Results, read_results  # noqa: E402
from benchmarks.sampling import with_noise  # noqa: E402
from benchmarks.summary import summarise  # noqa: E402
from benchmarks.tables import collection_table  # noqa: E402


def test_closest_points_are_no_farther_than_any_other_point_of_the_mesh():
    random = np.random.default_rng(11)
    vertices, faces = random.normal(size=(60, 3)), random.integers(0, 60, size=(150, 3))
    points = random.normal(size=(700, 3)) * 2.0
    face, weights, distance = closest_points(points, vertices, faces)
    assert weights.sum(axis=1) == pytest.approx(np.ones(700))
    assert weights.min() >= 0.0
    found = np.einsum("ij,ijk->ik", weights, vertices[faces[face]])
    assert np.linalg.norm(found - points, axis=1) == pytest.approx(distance)
    grid = np.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]) / 12.0
    everywhere = np.einsum("ij,fjk->fik", grid, vertices[faces]).reshape(-1, 3)
    nearest = np.array([np.linalg.norm(everywhere - point, axis=1).min() for point in points])
    assert (distance <= nearest + 1e-12).all()
    # The grid of points is at most this far from any point of a triangle.
    longest = np.linalg.norm(vertices[faces] - vertices[faces][:, [1, 2, 0]], axis=2).max()
    assert (nearest - distance).max() < longest / 12.0


def test_closest_points_of_no_points_are_none():
    face, weights, distance = closest_points(np.zeros((0, 3)), np.eye(3), np.array([[0, 1, 2]]))
    assert (len(face), weights.shape, len(distance)) == (0, (0, 3), 0)


def test_pyfm_maps_from_source_to_target():
    pytest.importorskip("pyFM", reason="scripts/benchmark --peers installs it")
    whole = surfaces.blob(3)
    shuffled = np.random.default_rng(2).permutation(642)
    source = (whole[0][shuffled], np.argsort(shuffled)[whole[1]].astype(np.int32))
    found = find(Case(source, (whole[0], whole[1].astype(np.int32)), None, False), {"method": "pyfm-zoomout"})
    result = evaluate(found.correspondence, shuffled, whole)
    assert result.coverage == 1.0
    assert result.error < 2.0


def test_sums_count_failures_and_keep_partial_pairs_apart():
    common = {"method": "isograft", "rotation": 0, "reverse": False, "has_truth": True, "has_overlap": True,
              "status": "ok"}  # fmt: skip
    rows = [
        {**common, "id": "a", "collection": "c", "category": "partial-cuts", "error": 2.0, "coverage": 0.8,
         "false_matches": 0.1, "overlap_iou": 0.6, "seconds": 1.0, "peak_mb": 5.0},
        {**common, "id": "b", "collection": "c", "category": "partial-cuts", "status": "failed"},
        {**common, "id": "d", "collection": "c", "category": "partial-holes", "error": 4.0, "coverage": 1.0,
         "false_matches": 0.3, "overlap_iou": None, "seconds": 3.0, "peak_mb": 4.0, "has_overlap": False},
        {**common, "id": "a", "collection": "c", "category": "partial-cuts", "error": 2.5, "coverage": 0.8,
         "false_matches": 0.1, "overlap_iou": 0.6, "seconds": 1.0, "peak_mb": 5.0, "rotation": 1},
    ]  # fmt: skip
    cuts, moved, holes, everything, _ = summarise(rows)
    assert (cuts["collection"], cuts["pairs"], cuts["failed"]) == ("c partial-cuts", 2, 1)
    assert (cuts["error"], cuts["coverage"], cuts["overlap_iou"]) == (2.0, 0.4, 0.3)
    assert (moved["moved"], moved["largest_change"]) == (True, 0.5)
    assert (holes["collection"], holes["overlap_iou"]) == ("c partial-holes", None)
    assert (everything["collection"], everything["error"], everything["coverage"]) == ("all", 3.0, pytest.approx(0.6))
    assert (everything["seconds"], everything["peak_mb"]) == (2.0, 5.0)


def test_seconds_of_peers_are_told_over_ours_on_the_same_pairs():
    common = {"collection": "c", "category": "isometric", "rotation": 0, "reverse": False, "has_truth": False,
              "has_overlap": False, "status": "ok", "peak_mb": 1.0}  # fmt: skip
    seconds = {("a", "isograft"): 2.0, ("b", "isograft"): 8.0, ("c", "isograft"): 100.0,
               ("a", "nearest"): 1.0, ("b", "nearest"): 2.0, ("b", "pyfm-zoomout"): 24.0,
               ("d", "pyfm-zoomout"): 1000.0}  # fmt: skip
    rows = [{**common, "id": name, "method": method, "seconds": s} for (name, method), s in seconds.items()]
    # Ours moved, or the other way round, is another run.
    rows.append({**common, "id": "d", "method": "isograft", "seconds": 1.0, "rotation": 1})
    rows.append({**common, "id": "b", "method": "isograft", "seconds": 1.0, "reverse": True})
    entries = {(e["collection"], e["method"], e["moved"]): e for e in summarise(rows)}
    assert entries["c", "nearest", False]["times_isograft"] == pytest.approx((0.5 + 0.25) / 2)
    assert entries["c", "pyfm-zoomout", False]["times_isograft"] == 3.0
    assert "times_isograft" not in entries["c", "isograft", False]
    lines = collection_table(list(entries.values())).splitlines()
    column = [cell.strip() for cell in lines[0].split("|")].index("times isograft (median)")
    told = {tuple(cell.strip() for cell in line.split("|"))[1:3]: line.split("|")[column].strip() for line in lines[2:]}
    assert told["c", "pyfm-zoomout"] == "3.00"
    assert told["c", "isograft"] == "-"
    alone = [entry for entry in entries.values() if entry["method"] == "isograft"]
    assert "times isograft" not in collection_table(alone)


def test_rows_of_another_build_or_with_other_settings_are_set_aside(tmp_path):
    common = {
        "id": "a", "collection": "c", "category": "isometric", "has_truth": False, "has_overlap": False,
        "status": "ok", "rotation": 0, "reverse": False, "settings": {"preset": "default"}, "seconds": 1.0,
        "peak_mb": 1.0,
    }  # fmt: skip
    results = Results(tmp_path, {}, order=["a", "b"])
    results.add({**common, "id": "b", "method": "isograft", "build": "old"})
    results.add({**common, "method": "isograft", "build": "new"})
    results.add({**common, "id": "b", "method": "nearest", "build": "1"})
    assert [(row["id"], row["method"]) for row in read_results(tmp_path / "results.json")["rows"]] == [
        ("a", "isograft"), ("b", "isograft"), ("b", "nearest"),
    ]  # fmt: skip

    again = Results(tmp_path, {}, order=["a", "b"])
    assert again.set_aside({"isograft": "new"}, {"preset": "default"}) == 1
    request = {"pair": {"id": "a"}, "method": "isograft", "rotation": 0, "reverse": False}
    assert again.has(request)
    assert not again.has({**request, "pair": {"id": "b"}})
    assert not again.has({**request, "reverse": True})
    assert len(read_results(tmp_path / "results.old.json")["rows"]) == 3

    other = Results(tmp_path, {}, order=["a", "b"])
    assert other.set_aside({"isograft": "new"}, {"preset": "fast"}) == 2
    assert not other.has(request)
    assert not Results(tmp_path, {}, order=[], fresh=True).has(request)


def test_noise_moves_both_sides_by_a_share_of_their_edges_and_is_measured_on_the_target_as_it_was():
    mesh = surfaces.blob(3)
    vertices, faces = mesh
    case = with_noise(Case(mesh, (2.0 * vertices, faces), Truth(vertex=np.arange(len(vertices))), True), 0.3)
    edge = np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2).mean()
    for moved, still, scale in ((case.source, vertices, 1.0), (case.target, 2.0 * vertices, 2.0)):
        assert (moved[0] - still).std() == pytest.approx(0.3 * scale * edge, rel=0.05)
        np.testing.assert_array_equal(moved[1], faces)
    assert case.measured_on is not None
    np.testing.assert_array_equal(case.measured_on[0], 2.0 * vertices)
    with pytest.raises(isograft.InvalidInput, match="two meshes"):
        with_noise(Case((vertices, None), mesh, None, True), 0.3)
