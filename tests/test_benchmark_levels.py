# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark: levels, confidence, motions and curves, on rows whose sums are known beforehand."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from benchmarks.levels import SETS, Level, judged, motions, set_of  # noqa: E402
from benchmarks.reliability import reliabilities, reliability  # noqa: E402
from benchmarks.report.curves import GRID, cumulative, mean_curve  # noqa: E402
from benchmarks.report.worst import share_right, worst_pairs  # noqa: E402
from benchmarks.tables import level_table, motion_table, reliability_tables  # noqa: E402


def row(name="a", **values):
    """A measured pair of SCAPE, but for what `values` say."""
    return {
        "id": name, "collection": "scape", "category": "near-isometric", "method": "isograft", "rotation": 0,
        "reverse": False, "has_truth": True, "has_overlap": False, "status": "ok", "error": 2.0, "coverage": 0.95,
        "false_matches": 0.02, "overlap_iou": None, **values,
    }  # fmt: skip


def failed(name="b", **values):
    kept = row(name, status="failed", reason="it broke", **values)
    return {key: kept[key] for key in kept if key not in ("error", "coverage", "false_matches", "overlap_iou")}


def test_a_set_reaches_its_level_only_in_error_and_coverage_at_once():
    for error, coverage, must, aim in (
        (2.8, 0.93, True, False),
        (2.9, 1.0, False, False),
        (0.1, 0.92, False, False),
        (1.4, 0.98, True, True),
    ):
        entry = judged([row(error=error, coverage=coverage)])[0]
        assert entry["set"] == "scape"
        assert (entry["must_reached"], entry["aim_reached"]) == (must, aim)


def test_a_failed_pair_has_coverage_zero_and_is_not_left_out():
    (entry, false) = judged([row(), failed()])
    assert (entry["pairs"], entry["failed"], entry["error"]) == (2, 1, 2.0)
    assert entry["coverage"] == pytest.approx(0.475)
    assert not entry["must_reached"]
    assert (false["set"], false["false_matches"]) == ("false matches: full shapes", 0.02)


def test_a_set_of_failures_only_reaches_nothing():
    entry = judged([failed()])[0]
    assert (entry["error"], entry["coverage"], entry["must_reached"]) == (None, 0.0, False)


def test_partial_pairs_and_reversed_ones_are_judged_by_their_overlap():
    overlapping = {"collection": "shrec16", "has_overlap": True, "false_matches": 0.2}
    both = row("p", category="partial-partial", overlap_iou=0.8, error=5.0, **overlapping)
    back = row("q", category="partial-cuts", overlap_iou=0.65, reverse=True, error=0.0, **overlapping)
    partial, reverse, false = judged([both, back])
    assert (partial["set"], partial["must_reached"], partial["aim_reached"]) == ("shrec16 partial-partial", True, False)
    assert (reverse["set"], reverse["must_reached"]) == ("shrec16 cuts and holes, reversed", False)
    # False matches are those of the pairs as they are.
    assert (false["set"], false["pairs"], false["must_reached"]) == (
        "false matches: partial, contacts, scans",
        1,
        False,
    )


def test_no_pair_belongs_to_two_sets():
    collections = sorted({name for pair_set in SETS for name in pair_set.collections})
    categories = ["isometric", "near-isometric", "non-isometric", "partial-cuts", "partial-holes", "partial-partial"]
    for collection in collections:
        for category in categories:
            for name in ("pfaustm_1", "pfausth_1"):
                for reverse in (False, True):
                    one = row(name, collection=collection, category=category, reverse=reverse)
                    assert sum(pair_set.has(one) for pair_set in SETS) <= 1
    assert set_of(row(collection="tosca_remeshed", category="non-isometric")).must is None
    assert set_of(row(collection="tosca_remeshed", category="isometric")).must is not None


def test_a_level_is_told_in_the_words_of_the_table():
    assert str(Level(error=2.2, coverage=0.92)) == "2.2 at 92 %"
    assert str(Level(error=6.0, overlap_iou=0.75)) == "6 IoU 75 %"
    page = level_table(judged([row(error=2.0, coverage=0.95)]))
    assert "| 2.8 at 93 % | yes" in page
    assert "| 1.4 at 98 % | no" in page


def test_confidence_that_tells_the_share_right_has_no_calibration_error():
    confidence = np.concatenate([np.full(100, 0.75), np.full(50, 0.2), np.full(10, 1.0)])
    errors = np.concatenate([np.full(75, 1.0), np.full(25, 60.0), np.full(10, 4.99), np.full(40, 5.0), np.zeros(10)])
    found = reliability(confidence, errors)
    assert found["calibration_error"] == pytest.approx(0.0)
    assert (found["count"], found["right"]) == (160, pytest.approx(95 / 160))
    assert [b["count"] for b in found["bins"]] == [0, 0, 50, 0, 0, 0, 0, 100, 0, 10]
    assert found["bins"][7]["right"] == 0.75
    assert found["bins"][0]["right"] is None


def test_confidence_that_is_too_high_has_its_excess_as_calibration_error():
    found = reliability(np.full(200, 0.9), np.r_[np.zeros(100), np.full(100, 30.0)])
    assert found["calibration_error"] == pytest.approx(0.4)
    # Two bins weigh by their counts.
    found = reliability(np.r_[np.full(100, 0.9), np.full(300, 0.1)], np.r_[np.full(100, 30.0), np.full(300, 30.0)])
    assert found["calibration_error"] == pytest.approx((100 * 0.9 + 300 * 0.1) / 400)


def test_reliability_is_told_per_set_and_over_the_sets_of_the_levels():
    sampled = {"sample_errors": [1.0, 1.0, 9.0, 9.0], "sample_confidence": [0.5, 0.5, 0.5, 0.5]}
    rows = [
        row("a", **sampled),
        row("b", collection="faces", sample_errors=[1.0], sample_confidence=[0.95]),
        row("c", collection="tosca_remeshed", category="non-isometric", **sampled),
        row("d", method="nearest", sample_errors=[1.0]),
        row("a", rotation=1, **sampled),
        failed(),
    ]
    entries = reliabilities(rows)
    assert [(e["set"], e["count"]) for e in entries] == [
        ("scape", 4), ("faces", 1), ("tosca_remeshed, non-isometric", 4), ("all", 5),
    ]  # fmt: skip
    assert entries[0]["calibration_error"] == pytest.approx(0.0)
    assert entries[-1]["calibration_error"] == pytest.approx(0.05 / 5)
    page = reliability_tables(entries)
    assert "| 0.5 to 0.6 | 4 " in " ".join(page.split())
    assert reliability_tables([]) == ""


def test_a_motion_may_change_the_error_of_no_pair_by_more_than_a_fifth():
    rows = [row("a"), row("b"), row("a", rotation=1, error=2.15), row("b", rotation=1, error=1.85, coverage=0.94)]
    (entry,) = motions(rows)
    assert (entry["runs"], entry["equal"]) == (2, True)
    assert entry["mean_error_change"] == pytest.approx(0.0)
    assert entry["largest_error_change"] == pytest.approx(0.15)
    assert entry["largest_coverage_change"] == pytest.approx(0.01)
    (entry,) = motions([*rows, row("a", rotation=2, error=2.21)])
    assert not entry["equal"]
    # A pair that is lost where it is turned is no equal one, though it has no error to compare.
    (entry,) = motions([row("a"), failed("a", rotation=1)])
    assert (entry["lost"], entry["equal"], entry["largest_error_change"]) == (1, False, None)
    assert "| no" in motion_table([entry])


def test_a_curve_ends_at_the_coverage_and_counts_a_failed_pair():
    curve = cumulative(row(coverage=0.8, sample_errors=[1.0, 3.0, 3.0, 50.0]))
    at = dict(zip(np.round(GRID, 1).tolist(), curve, strict=True))
    assert (at[0.9], at[1.0], at[3.0], at[20.0]) == pytest.approx((0.0, 0.2, 0.6, 0.6))
    both = mean_curve([row(coverage=0.8, sample_errors=[1.0]), failed()])
    assert both[-1] == pytest.approx(0.4)


def test_the_worst_pairs_are_those_with_the_fewest_vertices_right():
    rows = [
        row("good", coverage=0.9, sample_errors=[1.0, 1.0]),
        row("silent", coverage=0.1, sample_errors=[1.0, 1.0]),
        row("wrong", coverage=1.0, sample_errors=[1.0, 90.0, 90.0, 90.0]),
        failed("broken"),
        row("other", collection="pointcloud", coverage=0.0),
        row("good", rotation=1, coverage=0.0),
        row("good", method="nearest", coverage=0.0),
        row("cut", reverse=True, coverage=0.0, collection="shrec16", category="partial-cuts"),
    ]
    assert [one["id"] for one in worst_pairs(rows)] == ["broken", "silent", "wrong", "good"]
    assert [one["id"] for one in worst_pairs(rows, 2)] == ["broken", "silent"]
    assert share_right(rows[2]) == 0.25
