# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/accuracy_report: from rows to a page whose numbers are those of the rows, and pictures one can look at."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import surfaces

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from isograft.evaluation import Truth  # noqa: E402

from benchmarks.cases import Case  # noqa: E402
from benchmarks.report.worst import INVENTED, UNMATCHED, heat_colour, scene_of  # noqa: E402
from benchmarks.results import Results  # noqa: E402


def identity_map(mesh, shift=0):
    """Every vertex goes to the one `shift` further."""
    vertices, faces = mesh
    images = (np.arange(len(vertices)) + shift) % len(vertices)
    corner = np.array([np.argwhere(faces == image)[0] for image in images])
    weights = np.eye(3)[corner[:, 1]]
    return SimpleNamespace(face=corner[:, 0].astype(np.int32), barycentric=weights, points=vertices[images])


def test_a_perfect_map_is_shown_in_the_true_colours_and_without_errors():
    mesh = surfaces.blob(2)
    truth = Truth(vertex=np.arange(len(mesh[0])))
    scene = scene_of(Case(mesh, mesh, truth, False), identity_map(mesh))
    assert scene["matched_colour"] == pytest.approx(scene["true_colour"])
    assert scene["true_colour"] == pytest.approx(scene["target_colour"])
    assert scene["error_colour"] == pytest.approx(np.tile(heat_colour(0.0), (len(mesh[0]), 1)), abs=0.01)


def test_the_source_stands_as_the_target_does():
    mesh = surfaces.blob(2)
    moved = (3.0 * mesh[0] @ surfaces.rotation().T + [1.0, 2.0, 3.0], mesh[1])
    scene = scene_of(Case(moved, mesh, Truth(vertex=np.arange(len(mesh[0]))), False), None)
    assert scene["source"] == pytest.approx(scene["target"], abs=1e-9)
    # Up is up, and the viewer looks at the broad side.
    assert np.ptp(scene["target"], axis=0)[2] == pytest.approx(np.ptp(mesh[0][:, 1]))
    spread = scene["target"].std(axis=0)
    assert spread[0] >= spread[1]


def test_unmatched_vertices_are_grey_and_invented_matches_violet():
    mesh = surfaces.blob(2)
    count = len(mesh[0])
    truth = Truth(vertex=np.where(np.arange(count) < 100, np.arange(count), -1))
    found = identity_map(mesh)
    found.points[:40] = np.nan
    found.face[:40] = -1
    scene = scene_of(Case(mesh, mesh, truth, True), found)
    for name in ("matched_colour", "error_colour"):
        assert scene[name][:40] == pytest.approx(np.tile(UNMATCHED, (40, 1)))
    assert scene["error_colour"][100:] == pytest.approx(np.tile(INVENTED, (count - 100, 1)))
    assert scene["true_colour"][100:] == pytest.approx(np.tile(UNMATCHED, (count - 100, 1)))
    nothing = scene_of(Case(mesh, mesh, truth, True), None)
    assert nothing["matched_colour"] == pytest.approx(np.tile(UNMATCHED, (count, 1)))


@pytest.fixture
def measured(tmp_path):
    """A folder of data with one pair, and results in which Isograft mapped it well and a peer badly."""
    vertices, faces = surfaces.blob(2)
    rows = [" ".join(map(repr, row)) for row in vertices.tolist()]
    rows += ["3 " + " ".join(map(str, row)) for row in faces.tolist()]
    (tmp_path / "blob.off").write_text("\n".join(["OFF", f"{len(vertices)} {len(faces)} 0", *rows]) + "\n")
    (tmp_path / "pairs.csv").write_text(
        "id,collection,source,target,gt_kind,gt_file,gt_bary,gt_minus1,category,core\n"
        "blob_1,scape,blob.off,blob.off,identity,,,,isometric,1\n"
    )
    found = identity_map((vertices, faces), shift=1)
    (tmp_path / "maps").mkdir()
    np.savez(tmp_path / "maps" / "blob_1.npz", **vars(found))
    common = {
        "id": "blob_1", "collection": "scape", "category": "isometric", "rotation": 0, "reverse": False,
        "has_truth": True, "has_overlap": False, "status": "ok", "seconds": 1.5, "peak_mb": 90.0, "settings": {},
        "build": "1", "threads": 1, "jobs": 2,
    }  # fmt: skip
    results = Results(tmp_path, {}, order=["blob_1"])
    ours = {"error": 1.21, "coverage": 0.97, "false_matches": 0.011, "sample_errors": [1.0, 1.42], "map": "blob_1.npz"}
    results.add({**common, **ours, "method": "isograft", "sample_confidence": [0.9, 0.8]})
    peer = {"error": 33.3, "coverage": 1.0, "false_matches": 0.75, "sample_errors": [10.0, 56.6]}
    results.add({**common, **peer, "method": "nearest"})
    (tmp_path / "reasons.txt").write_text("# why\nblob_1: it has no features at all\n")
    return tmp_path


def report(folder, *arguments):
    return subprocess.run(
        [ROOT / "scripts" / "accuracy_report", folder / "results.json", "--data", folder, "-o", folder / "page.md",
         "--pictures", folder / "pictures", "--reasons", folder / "reasons.txt", *arguments],
        env={**os.environ, "ISOGRAFT_PYTHON": sys.executable}, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip


def test_the_page_tells_levels_peers_confidence_and_reasons(measured):
    done = report(measured, "--no-pictures")
    assert done.returncode == 0, done.stderr
    page = (measured / "page.md").read_text()
    (level,) = [line for line in page.splitlines() if line.startswith("| scape ") and "2.8 at 93 %" in line]
    cells = [cell.strip() for cell in level.strip("|").split("|")]
    assert cells == ["scape", "1", "0", "1.21", "97.0", "1.1", "-", "2.8 at 93 %", "yes", "1.4 at 98 %", "no"]
    assert "it has no features at all" in page
    assert any("nearest" in line and "33.30" in line for line in page.splitlines())
    assert "expected calibration error" in page
    for name in ("curves.png", "reliability.png"):
        assert f"](pictures/{name})" in page
        assert 5_000 < (measured / "pictures" / name).stat().st_size < 300_000


def test_a_pair_without_a_reason_is_named(measured):
    (measured / "reasons.txt").write_text("")
    done = report(measured, "--no-pictures")
    assert "no reason in" in done.stdout
    assert "blob_1" in done.stdout.splitlines()[-1]
    (measured / "reasons.txt").write_text("blob_1 without a colon\n")
    assert "line 1: write PAIR: REASON" in report(measured, "--no-pictures").stderr


def test_results_that_are_not_there_are_wrong_usage(tmp_path):
    done = report(tmp_path)
    assert done.returncode == 2
    assert "run scripts/benchmark first" in done.stderr


def test_without_the_data_earlier_pictures_stay(measured):
    (measured / "pairs.csv").unlink()
    (measured / "pictures").mkdir()
    earlier = measured / "pictures" / "worst_blob_0.jpg"
    earlier.write_bytes(b"a picture")
    done = report(measured)
    assert done.returncode == 2
    assert "holds no pairs.csv" in done.stderr
    assert "--no-pictures" in done.stderr
    assert earlier.read_bytes() == b"a picture"


@pytest.mark.skipif(shutil.which("blender") is None, reason="there is no Blender to render with")
def test_the_picture_of_a_pair_shows_it_in_colours(measured):
    done = report(measured)
    assert done.returncode == 0, done.stderr
    path = measured / "pictures" / "worst_blob_1.jpg"
    assert f"]({path.relative_to(measured).as_posix()})" in (measured / "page.md").read_text()
    assert path.stat().st_size < 300_000
    image = plt.imread(path).astype(float)
    # Not one grey picture: the panels of positions are colourful, the background is white.
    assert (image.max(axis=2) - image.min(axis=2) > 60).mean() > 0.1
    assert (image.min(axis=2) > 250).mean() > 0.2
    assert json.loads((measured / "results.json").read_text())["rows"][0]["id"] == "blob_1"
