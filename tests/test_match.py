# SPDX-License-Identifier: GPL-3.0-or-later
"""match() from end to end, through the installed package."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import isograft
import numpy as np
import pytest
import surfaces


@pytest.fixture(scope="module")
def blob() -> surfaces.Mesh:
    return surfaces.blob()


@pytest.fixture(scope="module")
def self_match(blob: surfaces.Mesh) -> isograft.Match:
    return isograft.match(blob, blob, preset="fast", threads=2)


def distances_to(points: surfaces.Floats, best: isograft.Correspondence) -> surfaces.Floats:
    return np.linalg.norm(best.points - points, axis=1)[best.matched]


def test_a_surface_matched_to_itself_gives_the_identity(blob: surfaces.Mesh, self_match: isograft.Match) -> None:
    best = self_match.best
    assert best.coverage > 0.95
    found = distances_to(blob[0], best)
    spacing = surfaces.sample_spacing(blob, 700)
    assert np.quantile(found, 0.95) < spacing
    assert np.median(found) < 0.25 * spacing


def test_arrays_have_the_shapes_dtypes_and_ranges_of_the_contract(
    blob: surfaces.Mesh, self_match: isograft.Match
) -> None:
    best, n = self_match.best, len(blob[0])
    for name, dtype, shape in (
        ("face", np.int32, (n,)), ("barycentric", np.float64, (n, 3)), ("points", np.float64, (n, 3)),
        ("vertex", np.int32, (n,)), ("confidence", np.float64, (n,)), ("stretch", np.float64, (n,)),
        ("region", np.int32, (n,)), ("corners", np.int32, (n, 3)),
    ):  # fmt: skip
        array = getattr(best, name)
        assert array.dtype == dtype, name
        assert array.shape == shape, name
        assert array.flags.c_contiguous, name
    matched = best.matched
    assert best.face.max() < len(blob[1])
    assert (best.barycentric[matched] >= 0).all()
    assert np.allclose(best.barycentric[matched].sum(axis=1), 1.0)
    assert ((best.confidence >= 0) & (best.confidence <= 1)).all()
    assert np.allclose(
        best.points[matched], np.einsum("ij,ijk->ik", best.barycentric[matched], blob[0][best.corners[matched]])
    )
    heaviest = best.corners[matched][np.arange(matched.sum()), best.barycentric[matched].argmax(axis=1)]
    assert (best.vertex[matched] == heaviest).all()


def test_interpolate_moves_the_target_positions_to_the_points(blob: surfaces.Mesh, self_match: isograft.Match) -> None:
    best = self_match.best
    moved = best.interpolate(blob[0])
    assert np.allclose(moved[best.matched], best.points[best.matched])
    assert np.isnan(moved[~best.matched]).all()
    assert best.interpolate(np.arange(len(blob[0]))).shape == (len(blob[0]),)


def test_interpolate_refuses_values_of_another_length(blob: surfaces.Mesh, self_match: isograft.Match) -> None:
    with pytest.raises(isograft.InvalidInput, match=f"one row per target vertex \\({len(blob[0])}\\)"):
        self_match.best.interpolate(np.zeros(len(blob[0]) + 1))


def test_the_report_tells_time_and_counts_of_the_stages(self_match: isograft.Match) -> None:
    report = self_match.report
    assert report.seconds > 0
    # Every stage of the engine has a place of its own, in the order in which they begin.
    stages = ["surface", "scale", "samples", "features", "seeds", "growth", "blend", "refinement", "dense"]
    assert [stage.name for stage in report.stages] == stages
    assert all(stage.seconds > 0 for stage in report.stages)
    assert 0.9 * report.seconds < sum(stage.seconds for stage in report.stages) <= 1.05 * report.seconds
    assert report.maps_grown > 0
    assert report.source_samples > 300
    assert report.options["hierarchy_samples"] == isograft.preset_options("fast")["hierarchy_samples"]
    assert isograft.Report.from_json(report.to_json()) == report


def test_a_rigid_motion_does_not_matter(blob: surfaces.Mesh) -> None:
    moved = blob[0] @ surfaces.rotation().T + [5.0, -3.0, 11.0]
    best = isograft.match(blob, (moved, blob[1]), preset="fast", scale="fixed", threads=2).best
    assert best.coverage > 0.95
    assert np.quantile(distances_to(moved, best), 0.95) < surfaces.sample_spacing(blob, 700)


def test_another_scale_is_found(blob: surfaces.Mesh) -> None:
    moved = 2.5 * blob[0] @ surfaces.rotation(5).T
    result = isograft.match(blob, (moved, blob[1]), preset="fast", threads=2)
    assert result.report.scale == pytest.approx(2.5, rel=0.05)
    assert result.best.coverage > 0.9
    assert np.quantile(distances_to(moved, result.best), 0.9) < 2.5 * surfaces.sample_spacing(blob, 700)


def test_what_was_cut_off_the_target_stays_unmatched(blob: surfaces.Mesh) -> None:
    dropped = blob[0][:, 1] > 0.75
    target, _ = surfaces.without(blob, dropped)
    assert 0.15 < dropped.mean() < 0.5
    best = isograft.match(blob, target, preset="fast", scale="fixed", threads=2).best
    assert best.matched[dropped].mean() < 0.35
    assert best.matched[~dropped].mean() > 0.8
    both = best.matched & ~dropped
    error = np.linalg.norm(best.points - blob[0], axis=1)[both]
    assert np.median(error) < surfaces.sample_spacing(blob, 700)
    unmatched = ~best.matched
    assert (best.face[unmatched] == -1).all()
    assert (best.vertex[unmatched] == -1).all()
    assert (best.region[unmatched] == -1).all()
    assert (best.confidence[unmatched] == 0).all()
    assert np.isnan(best.points[unmatched]).all()
    assert np.isnan(best.barycentric[unmatched]).all()
    assert np.isnan(best.stretch[unmatched]).all()


def test_one_thread_gives_the_same_bits_as_two(blob: surfaces.Mesh, self_match: isograft.Match) -> None:
    alone = isograft.match(blob, blob, preset="fast", threads=1)
    for name in ("face", "barycentric", "points", "vertex", "confidence", "stretch", "region"):
        assert getattr(alone.best, name).tobytes() == getattr(self_match.best, name).tobytes(), name


def test_landmarks_are_accepted_in_both_forms_and_lead_to_the_same_map(blob: surfaces.Mesh) -> None:
    pairs = [[0, 0], [5, 5], [9, 9]]
    lists = {"source": [0, 5, 9], "target": [0, 5, 9]}
    first, second = (
        isograft.match(blob, blob, preset="fast", scale="fixed", landmarks=marks, threads=2).best
        for marks in (pairs, lists)
    )
    assert first.points.tobytes() == second.points.tobytes()
    spacing = surfaces.sample_spacing(blob, 700)
    assert np.linalg.norm(first.points[[0, 5, 9]] - blob[0][[0, 5, 9]], axis=1).max() < 0.5 * spacing


def test_the_input_is_neither_modified_nor_kept(blob: surfaces.Mesh) -> None:
    vertices, faces = surfaces.blob(2)
    surface = isograft.Surface(vertices, faces)
    kept = surface.vertices.copy()
    vertices[:] = 0.0
    faces[:] = 0
    assert (surface.vertices == kept).all()
    source = tuple(np.array(array) for array in blob)
    isograft.match(source, source, preset="fast", scale="fixed", threads=2)
    assert (source[0] == blob[0]).all()
    assert (source[1] == blob[1]).all()


def test_progress_rises_and_ends_at_one_on_the_calling_thread(blob: surfaces.Mesh) -> None:
    calls: list[tuple[str, float, int]] = []
    isograft.match(
        blob, blob, preset="fast", scale="fixed", threads=2,
        progress=lambda stage, fraction: calls.append((stage, fraction, threading.get_ident())),
    )  # fmt: skip
    fractions = [fraction for _, fraction, _ in calls]
    assert fractions == sorted(fractions)
    assert fractions[0] >= 0.0
    assert fractions[-1] == 1.0
    assert len({stage for stage, _, _ in calls}) >= 4
    assert {thread for _, _, thread in calls} == {threading.get_ident()}


def test_other_threads_run_while_a_match_is_on(blob: surfaces.Mesh) -> None:
    done = threading.Event()
    counted = [0]

    def count() -> None:
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    start = time.monotonic()
    try:
        isograft.match(blob, blob, preset="fast", scale="fixed", threads=1)
    finally:
        seconds = time.monotonic() - start
        done.set()
        counter.join()
    assert counted[0] > 50 * seconds


def test_a_callback_that_returns_false_cancels_within_a_moment(blob: surfaces.Mesh) -> None:
    asked: list[float] = []

    def stop(stage: str, fraction: float) -> bool:
        if fraction < 0.2:
            return True
        asked.append(time.monotonic())
        return False

    with pytest.raises(isograft.Cancelled):
        isograft.match(blob, blob, preset="fast", threads=2, progress=stop)
    assert time.monotonic() - asked[0] < 0.5
    assert len(asked) == 1


@pytest.mark.parametrize("seconds", [0.3, 1.0, 2.0])
def test_another_thread_can_cancel_at_any_time(blob: surfaces.Mesh, seconds: float) -> None:
    wanted = threading.Event()
    timer = threading.Timer(seconds, wanted.set)
    timer.start()
    start = time.monotonic()
    with pytest.raises(isograft.Cancelled):
        isograft.match(blob, blob, preset="thorough", threads=2, progress=lambda stage, fraction: not wanted.is_set())
    assert time.monotonic() - start < seconds + 0.6


def test_an_exception_in_the_callback_ends_the_run_and_is_passed_on(blob: surfaces.Mesh) -> None:
    class OutOfPaperError(Exception):
        pass

    def fail(stage: str, fraction: float) -> None:
        raise OutOfPaperError(stage)

    with pytest.raises(OutOfPaperError):
        isograft.match(blob, blob, preset="fast", threads=2, progress=fail)


@pytest.mark.skipif(sys.platform == "win32", reason="needs POSIX signals")
@pytest.mark.parametrize("progress", ["None", "lambda *_: None"])
def test_an_interrupt_ends_the_run_with_and_without_a_callback(progress: str) -> None:
    code = f"""
import sys, time
sys.path.insert(0, {str(Path(__file__).parent)!r})
import isograft, surfaces
mesh = isograft.Surface(*surfaces.blob())
print("ready", flush=True)
try:
    isograft.match(mesh, mesh, preset="thorough", threads=2, progress={progress})
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout is not None
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.7)
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        assert child.communicate(timeout=30)[0] == "interrupted\n"
        assert time.monotonic() - start < 2.0
    finally:
        child.kill()


def test_a_saved_match_is_the_same_when_loaded(self_match: isograft.Match, tmp_path: Path) -> None:
    path = tmp_path / "map.npz"
    doubled = isograft.Match(self_match.best, [self_match.best], self_match.report)
    doubled.save(path)
    with np.load(path) as file:
        assert "face" in file.files
        assert "alternative1_points" in file.files
        assert file["report"].dtype.kind == "U"
    loaded = isograft.Match.load(path)
    assert loaded.report == self_match.report
    for correspondence in (loaded.best, *loaded.alternatives, isograft.Correspondence.load(path)):
        for name in ("face", "barycentric", "points", "vertex", "confidence", "stretch", "region", "corners"):
            assert getattr(correspondence, name).tobytes() == getattr(self_match.best, name).tobytes()
        assert correspondence.target_size == self_match.best.target_size
