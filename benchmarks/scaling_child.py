# SPDX-License-Identifier: GPL-3.0-or-later
"""One size of scripts/benchmark --scaling, in a process of its own: request on stdin, row into the file named."""

from __future__ import annotations

import json
import statistics
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import isograft
import numpy as np
from isograft.evaluation import Truth, evaluate

from benchmarks.cases import Case, read_case
from benchmarks.child import peak_mb
from benchmarks.methods import cost_unit
from benchmarks.refine import refined


def main() -> int:
    request = json.load(sys.stdin)
    case = sized(read_case(Path(request["data"]), request["pair"]), request["vertices"])
    row: dict[str, Any] = {"vertices": request["vertices"], "threads": request["threads"]}
    row["peak_before_mb"] = round(peak_mb(), 1)
    walls, busy = [], time.process_time()
    for _ in range(request["repeats"]):
        started = time.perf_counter()
        # Arrays, so that the gate's time counts too.
        result = isograft.match(case.source, case.target, threads=request["threads"], preset=request["preset"])
        walls.append(time.perf_counter() - started)
    row["cpu_seconds"] = round((time.process_time() - busy) / request["repeats"], 3)
    row["seconds"] = round(statistics.median(walls), 3)
    row["all_seconds"] = [round(wall, 3) for wall in walls]
    row["peak_mb"] = round(peak_mb(), 1)
    row["stages"] = {stage.name: round(stage.seconds, 3) for stage in result.report.stages}
    windows = int(np.clip(1_000_000 // request["vertices"], 4, 50))
    row["cost_unit_seconds"] = round(cost_unit(case, result.report, windows), 3)
    assert case.truth is not None
    measured = evaluate(result.best, case.truth, case.target, samples=100, unmatched_is_truth=False).to_dict()
    row.update({name: measured[name] for name in ("error", "coverage") if name in measured})
    Path(sys.argv[1]).write_text(json.dumps(row), encoding="utf-8")
    return 0


def sized(case: Case, count: int) -> Case:
    """Both surfaces with `count` vertices; the truth is that of the old ones."""
    (source, source_faces), (target, target_faces) = case.source, case.target
    assert source_faces is not None
    assert target_faces is not None
    assert case.truth is not None
    known = case.truth.vertex
    if known is None:
        raise isograft.InvalidInput("--scaling needs a pair whose truth is given by vertices")
    truth = np.full(count, -1, np.int64)
    truth[: len(known)] = known
    return replace(
        case,
        source=refined(source, source_faces, count),
        target=refined(target, target_faces, count),
        truth=Truth(vertex=truth),
    )


if __name__ == "__main__":
    sys.exit(main())
