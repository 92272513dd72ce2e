# SPDX-License-Identifier: GPL-3.0-or-later
"""The process of one run: the request as JSON on stdin, the row as JSON into the file named on the command line."""

from __future__ import annotations

import json
import resource
import sys
import time
import traceback
from pathlib import Path
from typing import Any

import isograft
import numpy as np
from isograft.evaluation import evaluate

from benchmarks.cases import read_case
from benchmarks.methods import cost_unit, find, on_mesh
from benchmarks.sampling import with_noise, with_points


def run_request(request: dict[str, Any]) -> dict[str, Any]:
    case = read_case(Path(request["data"]), request["pair"], reverse=request["reverse"], rotation=request["rotation"])
    if request.get("as_points"):
        case = with_points(case, request["as_points"], request["points"])
    if request.get("noise"):
        case = with_noise(case, request["noise"])
    row: dict[str, Any] = {"source_vertices": len(case.source[0]), "target_vertices": len(case.target[0])}
    if request["method"] != "isograft" and case.size > request["peer_limit"]:
        return {**row, "status": "skipped"}
    row["peak_before_mb"] = round(peak_mb(), 1)
    busy = time.process_time()
    found = find(case, request)
    row["seconds"] = round(found.seconds, 4)
    row["cpu_seconds"] = round((time.process_time() - busy) / request["repeats"], 4)
    # Before the measures, which take memory of their own.
    row["peak_mb"] = round(peak_mb(), 1)
    row.update(found.details)
    if case.truth is None:
        row["measured"] = False
        row["matched"] = int(np.isfinite(found.correspondence.points).all(axis=1).sum())
    else:
        row["measured"] = True
        started = time.perf_counter()
        target = case.target if case.measured_on is None else case.measured_on
        measured = evaluate(
            found.correspondence if case.measured_on is None else on_mesh(found.correspondence, case.measured_on),
            case.truth,
            target,
            samples=request["samples"],
            unmatched_is_truth=case.unmatched_is_truth,
        )
        row["measure_seconds"] = round(time.perf_counter() - started, 3)
        row.update(measured.to_dict())
        row["sample_errors"] = np.round(measured.sample_errors, 2).tolist()
        if isinstance(found.correspondence, isograft.Correspondence):
            row["sample_confidence"] = np.round(found.correspondence.confidence[measured.sample], 3).tolist()
    if request["maps"] is not None and isinstance(found.correspondence, isograft.Correspondence):
        row["map"] = save_map(Path(request["maps"]), request, found.correspondence)
    if found.report is not None and request["rotation"] == 0 and not request["reverse"]:
        unit = cost_unit(case, found.report)
        row["cost_unit_seconds"] = round(unit, 4)
        row["ratio"] = round(found.seconds / unit, 3) if unit > 0.0 else None
    return {**row, "status": "ok"}


def save_map(folder: Path, request: dict[str, Any], correspondence: isograft.Correspondence) -> str:
    """Keep the map for pictures; its file's name."""
    name = f"{request['pair']['id']}{'.reversed' if request['reverse'] else ''}.npz"
    np.savez_compressed(
        folder / name,
        face=correspondence.face,
        barycentric=correspondence.barycentric.astype(np.float32),
        points=correspondence.points.astype(np.float32),
        confidence=correspondence.confidence.astype(np.float32),
    )
    return name


def peak_mb() -> float:
    """Of this process so far. The kernel's count of this program's own; ru_maxrss can hold the parent's."""
    try:
        for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM:"):
                return float(line.split()[1]) / 2**10
    except OSError:
        pass
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10)


def main() -> int:
    request = json.load(sys.stdin)
    try:
        row = run_request(request)
    except Exception as error:  # whatever a method raises is its failure on this pair
        traceback.print_exc()
        row = {"status": "failed", "reason": f"{type(error).__name__}: {error}"}
    Path(sys.argv[1]).write_text(json.dumps(row), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
