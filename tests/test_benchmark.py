# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark: runs over a small folder of pairs."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import surfaces

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from isograft.evaluation import Truth, evaluate  # noqa: E402

from benchmarks import children  # noqa: E402
from benchmarks.cases import Case, read_case, reversed_case  # noqa: E402
from benchmarks.methods import find  # noqa: E402

COLUMNS = ["id", "collection", "source", "target", "gt_kind", "gt_file", "gt_bary", "gt_minus1", "category", "core"]


def write_off(path, vertices, faces):
    rows = [" ".join(map(repr, row)) for row in np.asarray(vertices, float).tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in np.asarray(faces).tolist()]
    path.write_text("\n".join(["OFF", f"{len(vertices)} {len(faces)} 0", *rows]) + "\n")


def write_pairs(folder, *pairs):
    with (folder / "pairs.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, restval="")
        writer.writeheader()
        writer.writerows({"category": "isometric", "gt_kind": "identity", "core": "1", **pair} for pair in pairs)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    """A blob, the same moved, a part of it, and a file that is cut short."""
    folder = tmp_path_factory.mktemp("data")
    vertices, faces = surfaces.blob(3)
    write_off(folder / "whole.off", vertices, faces)
    write_off(folder / "moved.off", vertices @ surfaces.rotation().T + [3.0, 1.0, -2.0], faces)
    (part, part_faces), index = surfaces.without((vertices, faces), vertices[:, 1] > 0.7)
    write_off(folder / "part.off", part, part_faces)
    (folder / "corrupt.off").write_text((folder / "whole.off").read_text()[:2000])
    (folder / "part.txt").write_text("".join(f"{i}\n" for i in np.flatnonzero(index >= 0)))
    (folder / "whole_to_part.txt").write_text("".join(f"{i}\n" for i in index))
    write_pairs(
        folder,
        {"id": "same", "collection": "full", "source": "whole.off", "target": "moved.off"},
        {"id": "broken", "collection": "full", "source": "corrupt.off", "target": "moved.off"},
        {"id": "part", "collection": "cut", "source": "part.off", "target": "whole.off", "gt_kind": "vertex",
         "gt_file": "part.txt", "category": "partial-cuts", "core": "0"},
        {"id": "whole_to_part", "collection": "cut", "source": "whole.off", "target": "part.off", "gt_kind": "vertex",
         "gt_file": "whole_to_part.txt", "gt_minus1": "unmatched", "category": "partial-cuts", "core": "0"},
    )  # fmt: skip
    return folder


def pair_of(data, name):
    with (data / "pairs.csv").open(newline="") as file:
        return next(row for row in csv.DictReader(file) if row["id"] == name)


def benchmark(data, *arguments):
    return subprocess.run(
        [ROOT / "scripts" / "benchmark", "--data", data, *arguments],
        env={**os.environ, "ISOGRAFT_PYTHON": sys.executable},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


CALL = ["--core", "--preset", "fast", "--threads", "2", "--rotations", "1"]


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    return tmp_path_factory.mktemp("results")


@pytest.fixture(scope="module")
def run(data, output):
    done = benchmark(data, *CALL, "-o", output)
    assert done.returncode == 0, done.stderr
    return done, json.loads((output / "results.json").read_text()), (output / "results.md").read_text()


def test_a_pair_is_matched_and_measured(run):
    _, results, _ = run
    rows = [row for row in results["rows"] if row["id"] == "same"]
    assert [row["rotation"] for row in rows] == [0, 1]
    for row in rows:
        assert row["status"] == "ok"
        assert row["source_vertices"] == row["target_vertices"] == row["annotated"] == 642
        assert row["error"] < 3.0
        assert row["coverage"] > 0.9
        assert row["coverage"] == row["matched_annotated"] / 642
        # The cost unit is measured where times are compared: on the pair as it is.
        assert ("ratio" in row) == (row["rotation"] == 0)
        if "ratio" in row:
            assert row["ratio"] == pytest.approx(row["seconds"] / row["cost_unit_seconds"], rel=1e-2)
        assert sum(row["stages"].values()) <= row["seconds"] * 1.01
        assert 10.0 < row["peak_mb"] <= row["process_peak_mb"] * 1.05


def test_a_row_keeps_the_sample_and_its_confidence(run, output):
    _, results, page = run
    still, moved = (row for row in results["rows"] if row["id"] == "same")
    assert len(still["sample_errors"]) == len(still["sample_confidence"]) == still["sampled"] == 250
    assert np.mean(still["sample_errors"]) == pytest.approx(still["error"], abs=0.01)
    assert all(0.0 < c <= 1.0 for c in still["sample_confidence"])
    # Pictures are made of the pairs as they are.
    assert (output / "maps" / still["map"]).is_file()
    assert "map" not in moved
    assert "## Pairs" in page


def test_a_second_run_measures_only_what_is_not_there_yet(data, run, output):
    first = [row for row in run[1]["rows"] if row["status"] == "ok"]
    done = benchmark(data, *CALL, "--jobs", "2", "-o", output)
    assert done.returncode == 0, done.stderr
    assert "2 runs, 2 measured already" in done.stdout  # the broken pair is tried again
    results = json.loads((output / "results.json").read_text())
    assert [row for row in results["rows"] if row["status"] == "ok"] == first
    assert len(results["rows"]) == 4


def test_a_run_that_is_ended_takes_its_children_along(data, tmp_path):
    started = subprocess.Popen(
        [ROOT / "scripts" / "benchmark", "--data", data, "--ids", "same", "--preset", "thorough", "-o", tmp_path],
        env={**os.environ, "ISOGRAFT_PYTHON": sys.executable},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert started.stdout is not None
    assert "1 runs" in started.stdout.readline()
    deadline = time.monotonic() + 60.0
    while not (running := _descendants(started.pid)) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert running
    started.terminate()
    _, errors = started.communicate(timeout=60)
    assert started.returncode == 130
    assert "the rows so far are kept" in errors
    assert not [child for child in running if Path(f"/proc/{child}").exists()]


def _descendants(pid):
    found = []
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with contextlib.suppress(OSError):
            found += task.read_text().split()
    return found


def test_a_corrupt_file_is_a_failed_pair_of_coverage_zero(run):
    done, results, page = run
    row = next(row for row in results["rows"] if row["id"] == "broken")
    assert row["status"] == "failed"
    assert "corrupt.off" in row["reason"]
    assert "error" not in row
    (whole,) = [entry for entry in results["collections"] if not entry["moved"]]
    same = next(row for row in results["rows"] if row["id"] == "same" and row["rotation"] == 0)
    assert (whole["pairs"], whole["failed"]) == (2, 1)
    assert whole["coverage"] == pytest.approx(same["coverage"] / 2.0)
    assert whole["error"] == same["error"]
    assert "corrupt.off" in done.stdout
    assert "corrupt.off" in page


def test_the_page_has_a_row_per_pair_with_the_numbers_of_the_json(run):
    done, results, page = run
    for row in results["rows"]:
        lines = [line for line in page.splitlines() if line.startswith(f"| {row['id']} ")]
        shown = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
        cells = next(cells for cells in shown if cells[1:3] == ["isograft", str(row["rotation"])])
        if row["status"] == "ok":
            assert cells[4:7] == [
                f"{row['error']:.2f}",
                f"{100 * row['coverage']:.1f}",
                f"{100 * row['false_matches']:.1f}",
            ]
        else:
            assert cells[4:6] == ["failed", "0"]
    assert "| full" in done.stdout


def test_a_choice_that_fits_nothing_is_wrong_usage(data, tmp_path):
    for arguments, words in (
        (["--ids", "same,absent"], "absent"),
        (["--collection", "absent"], "full"),
        (["--core", "--collection", "cut"], "no pair fits"),
        (["--set", "growth_stretch_limit"], "STAGE_FIELD=VALUE"),
    ):
        done = benchmark(data, *arguments, "-o", tmp_path)
        assert done.returncode == 2
        assert words in done.stderr


REQUEST = {
    "method": "isograft",
    "rotation": 0,
    "reverse": False,
    "threads": 1,
    "samples": 250,
    "repeats": 1,
    "preset": "fast",
    "overrides": {},
    "peer_limit": 15000,
    "build": "1",
    "settings": {},
    "jobs": 1,
    "maps": None,
}


def test_a_process_over_its_time_is_ended_and_counts_as_failed(data, tmp_path):
    started = time.perf_counter()
    row = children.run_child({**REQUEST, "data": str(data), "pair": pair_of(data, "same")}, 0.05, tmp_path)
    assert time.perf_counter() - started < 20.0
    assert row["status"] == "failed"
    assert "limit of 0.05 s" in row["reason"]


def test_a_process_that_crashes_counts_as_failed(data, tmp_path, monkeypatch):
    crash = tmp_path / "python"
    crash.write_text("#!/bin/sh\nkill -SEGV $$\n")
    crash.chmod(0o755)
    monkeypatch.setattr(children.sys, "executable", str(crash))
    row = children.run_child({**REQUEST, "data": str(data), "pair": pair_of(data, "same")}, 60.0, tmp_path)
    assert row["status"] == "failed"
    assert "SIGSEGV" in row["reason"]


def test_an_unknown_option_of_match_is_told_as_the_reason(data, tmp_path):
    request = {**REQUEST, "data": str(data), "pair": pair_of(data, "same"), "overrides": {"growth_nonsense": 1}}
    row = children.run_child(request, 60.0, tmp_path)
    assert row["status"] == "failed"
    assert "growth_nonsense" in row["reason"]


def test_a_motion_is_rigid_and_another_one_every_time(data):
    pair = pair_of(data, "same")
    still, first, again, second = (read_case(data, pair, rotation=k) for k in (0, 1, 1, 2))
    assert np.array_equal(first.source[0], again.source[0])
    assert not np.allclose(first.source[0], second.source[0])
    for side in ("source", "target"):
        before, after = getattr(still, side)[0], getattr(first, side)[0]
        frame = np.linalg.lstsq(before - before.mean(axis=0), after - after.mean(axis=0), rcond=None)[0]
        assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-9)
        assert np.linalg.det(frame) == pytest.approx(1.0)
        assert np.abs(frame - np.eye(3)).max() > 0.1


def test_reversing_a_cut_leaves_the_missing_part_without_counterpart(data):
    case = read_case(data, pair_of(data, "part"), reverse=True)
    whole, part = case.source[0], case.target[0]
    assert case.unmatched_is_truth
    known = case.truth.known
    assert known[whole[:, 1] <= 0.7].all()
    # What lies within half an edge of the cut may have a counterpart on it; the rest of the missing part has none.
    assert not known[whole[:, 1] > 0.85].any()
    points = np.einsum("ij,ijk->ik", case.truth.weights[known], part[case.target[1][case.truth.face[known]]])
    inner = whole[known][:, 1] <= 0.7
    assert points[inner] == pytest.approx(whole[known][inner], abs=1e-9)


def test_reversing_where_unmatched_is_unknown_turns_pairs_round():
    mesh = surfaces.blob(2)
    truth = Truth(vertex=np.where(np.arange(len(mesh[0])) < 5, np.arange(len(mesh[0])) + 10, -1))
    turned = reversed_case(Case(mesh, mesh, truth, False), unknown=True)
    assert not turned.unmatched_is_truth
    assert turned.truth.vertex[10:15].tolist() == [0, 1, 2, 3, 4]
    assert turned.truth.known.sum() == 5


def test_a_perfect_partial_map_has_full_overlap_both_ways(data):
    pair = pair_of(data, "whole_to_part")
    case = read_case(data, pair)
    images = find(Case(case.target, case.source, None, False), {"method": "nearest"}).correspondence
    # The part lies in the whole where it was cut out, so that the nearest point is the true one.
    reverse = read_case(data, pair, reverse=True)
    result = evaluate(images, reverse.truth, reverse.target, unmatched_is_truth=reverse.unmatched_is_truth)
    assert (result.coverage, result.overlap_iou) == (1.0, 1.0)
    assert result.error < 1e-5
    # Sent back, all of the whole is matched, though its upper part has no counterpart.
    back = find(case, {"method": "nearest"}).correspondence
    result = evaluate(back, case.truth, case.target, unmatched_is_truth=case.unmatched_is_truth)
    assert result.coverage == 1.0
    assert result.overlap_iou == pytest.approx(len(case.target[0]) / len(case.source[0]))
