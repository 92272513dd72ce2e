# SPDX-License-Identifier: GPL-3.0-or-later
"""Matches one pair of an experiment by one method and measures; what is done is kept and not done again."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import isograft
import numpy as np
from isograft.evaluation import evaluate

from benchmarks.methods import VertexMap, find
from experiments.catalogue import Experiment, Pair
from experiments.hkm import heat_kernel_map

#: Vertices whose geodesic error is measured.
SAMPLES = 400
#: Errors (times 100) of the cumulative curves.
LEVELS = np.linspace(0.0, 25.0, 101)
#: Stages of the report by those of the progress, where they differ.
STAGE_NAMES = {"blend": "clustering", "merge": "merging", "dense": "merging", "done": "merging"}


@dataclass(frozen=True)
class Settings:
    data: Path
    out: Path
    threads: int
    #: Largest mesh of preset paper; None: that of the experiment.
    vertices: int | None
    matches: int

    def options(self, experiment: Experiment, pair: Pair, preset: str) -> dict[str, Any]:
        """What is set besides the preset."""
        # As in the paper, both sides of every pair are in one unit.
        options: dict[str, Any] = {"scale": "fixed"}
        if pair.landmarks is not None:
            options["seed_landmarks_only"] = True
        if preset == "paper":
            options |= experiment.options | pair.options
            options["paper_vertices"] = self.vertices or experiment.limit(pair.name)
            options["paper_matches"] = self.matches
        return options

    def kept(self, experiment: Experiment, pair: Pair, method: str) -> dict[str, Any]:
        """What a kept result has to be of: a change of the preset tells, one of the code only by its version."""
        if method not in isograft.presets():
            return {"version": isograft.__version__}
        options = isograft.preset_options(method) | self.options(experiment, pair, method)
        return {"version": isograft.__version__, "options": options}


class StageClock:
    """Seconds of the processor by stage of preset paper, told from the progress of a match.

    The search for scale and sides runs stages of its own first: all before the last `hierarchy` is `surface`.
    """

    def __init__(self, clock: Callable[[], float] = time.process_time) -> None:
        self.seconds: dict[str, float] = {}
        self._clock = clock
        self._last = clock()
        self._stage = "surface"

    def __call__(self, stage: str, _fraction: float) -> None:
        now = self._clock()
        self.seconds[self._stage] = self.seconds.get(self._stage, 0.0) + now - self._last
        self._last = now
        stage = STAGE_NAMES.get(stage, stage)
        if stage == "hierarchy" and self._stage != "hierarchy":
            self.seconds = {"surface": sum(self.seconds.values())}
        self._stage = stage


def run_pair(experiment: Experiment, pair: Pair, method: str, settings: Settings) -> dict[str, Any]:
    """The figures of one pair and method, from the kept file if it is of the same settings."""
    folder = settings.out / experiment.name
    path = folder / f"{pair.name}.{method}.json"
    wanted = settings.kept(experiment, pair, method)
    if path.exists():
        kept: dict[str, Any] = json.loads(path.read_text())
        if kept["settings"] == wanted and "failed" not in kept:
            return kept
    folder.mkdir(parents=True, exist_ok=True)
    started, began = time.perf_counter(), time.process_time()
    row: dict[str, Any] = {"experiment": experiment.name, "pair": pair.name, "method": method, "settings": wanted}
    if pair.options:
        row["options"] = pair.options
    try:
        found, extra = _find(experiment, pair, method, settings)
    except (isograft.InvalidInput, ImportError) as error:
        row["failed"] = str(error)
    else:
        row |= extra
        row["seconds"] = time.perf_counter() - started
        row["cpu_seconds"] = time.process_time() - began
        row |= measure(found, pair)
        np.savez_compressed(
            path.with_suffix(".npz"), face=found.face, barycentric=found.barycentric, points=found.points
        )
    path.write_text(json.dumps(row, indent=1))
    return row


def _find(experiment: Experiment, pair: Pair, method: str, settings: Settings) -> tuple[Any, dict[str, Any]]:
    case = pair.case
    if method == "hkm":
        landmarks = pair.landmarks if pair.landmarks is not None else two_true_matches(pair)
        assert case.source[1] is not None and case.target[1] is not None
        return _at_vertices(heat_kernel_map(case.source, case.target, landmarks), case.target), {}
    if method in ("nearest", "pyfm-zoomout"):
        return find(case, {"method": method}).correspondence, {}
    clock = StageClock()
    result = isograft.match(
        case.source,
        case.target,
        preset=method,
        landmarks=pair.landmarks,
        threads=settings.threads,
        progress=clock,
        **settings.options(experiment, pair, method),
    )
    report = result.report
    told = {"cpu_stages": clock.seconds} if method == "paper" else {}
    return result.best, told | {
        "stages": {stage.name: stage.seconds for stage in report.stages},
        "warnings": list(report.warnings),
        "alternatives": len(result.alternatives),
        "source_samples": report.source_samples,
        "seeds_tried": report.seeds_tried,
        "maps_grown": report.maps_grown,
        "maps_in_core": report.maps_in_core,
        "alternative_errors": [measure(other, pair)["error"] for other in result.alternatives],
    }


def measure(found: Any, pair: Pair) -> dict[str, Any]:
    """Error, coverage, false matches and the cumulative curve over all vertices that have a truth."""
    case = pair.case
    if case.truth is None:
        return {"coverage_all": float((np.asarray(found.face) >= 0).mean())}
    seen = evaluate(found, case.truth, case.target, samples=SAMPLES, unmatched_is_truth=case.unmatched_is_truth)
    # Unmatched vertices never come below any error.
    curve = [
        float((seen.sample_errors <= level).mean()) * seen.coverage if len(seen.sample) else 0.0 for level in LEVELS
    ]
    shares = {name: float(np.interp(at, LEVELS, curve)) for name, at in (("within_005", 5.0), ("within_01", 10.0))}
    return {**seen.to_dict(), **shares, "curve": curve}


def two_true_matches(pair: Pair) -> np.ndarray:
    """Two true matches for HKM, far apart: the highest known vertex along the longest extent and the lowest."""
    truth = pair.case.truth
    assert truth is not None and truth.vertex is not None
    points = pair.case.source[0]
    known = np.flatnonzero(truth.known)
    axis = int(np.argmax(np.ptp(points, axis=0)))
    ends = [known[np.argmax(points[known, axis])], known[np.argmin(points[known, axis])]]
    return np.array([(v, truth.vertex[v]) for v in ends], np.int32)


def _at_vertices(images: np.ndarray, target: Any) -> VertexMap:
    vertices, faces = target
    first = np.full(len(vertices), -1, np.int64)
    corners = faces.ravel()
    first[corners[::-1]] = np.arange(len(corners))[::-1]
    at = first[images]
    weights = np.eye(3)[at % 3]
    return VertexMap((at // 3).astype(np.int32), weights, vertices[images])
