# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress is honest: it rises, it comes often, and every stage's part of it is about its part of the work.

Measured by the processor time of one thread, so that what else runs on the machine does not count.
"""

from __future__ import annotations

import csv
import os
import threading
import time
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces
from isograft.matching import make_surfaces

from benchmarks.cases import read_case
from benchmarks.scaling_child import sized

DATA = Path(os.environ.get("ISOGRAFT_DATA") or Path(__file__).resolve().parents[2] / "shared" / "data")
Row = tuple[float, str, float]
POINTS = -1


def progress_of(source: Any, target: Any, **options: Any) -> list[Row]:
    """Seconds of processor time, stage and fraction at every call."""
    rows: list[Row] = []
    start = time.process_time()
    isograft.match(
        source, target, threads=1,
        progress=lambda *told: rows.append((time.process_time() - start, *told)), **options,
    )  # fmt: skip
    return rows


def check_rising_and_frequent(rows: list[Row]) -> None:
    fractions = [fraction for _, _, fraction in rows]
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0
    assert max(np.diff([0.0, *[now for now, _, _ in rows]])) < 0.5  # two updates a second
    moved = [now for (now, _, fraction), before in zip(rows, [-1.0, *fractions], strict=False) if fraction > before]
    assert max(np.diff([0.0, *moved])) < 1.0  # and they say something new


def test_progress_rises_and_comes_often() -> None:
    blob = surfaces.blob(4)
    check_rising_and_frequent(progress_of(blob, blob, preset="fast"))


def test_surfaces_checked_side_by_side_leave_the_rest_of_the_progress_to_their_matches() -> None:
    vertices, faces = surfaces.blob(5)
    rows: list[tuple[str, float]] = []
    threads: set[int] = set()

    def progress(stage: str, fraction: float) -> None:
        rows.append((stage, fraction))
        threads.add(threading.get_ident())

    sources = [("one", (vertices, faces)), ("two", (2.0 * vertices, faces))]
    made, target, rest = make_surfaces(sources, ("three", (vertices, faces)), threads=2, progress=progress)
    assert rest is not None
    assert [np.abs(s.vertices).max() for s in (*made, target)] == [f * np.abs(vertices).max() for f in (1.0, 2.0, 1.0)]
    assert {stage for stage, _ in rows} == {"surface"}
    assert threads == {threading.get_ident()}
    end = rows[-1][1]
    assert 0.0 < end < 0.2  # a few milliseconds beside matches of seconds
    rest("match", 0.0)
    rest("match", 1.0)
    fractions = [fraction for _, fraction in rows]
    assert fractions == sorted(fractions)
    assert rows[-2:] == [("match", pytest.approx(end, rel=1e-9)), ("match", 1.0)]
    with pytest.raises(isograft.InvalidInput, match=r"^two: .*indices"):
        make_surfaces([sources[0], ("two", (vertices, faces + 1_000_000))], ("three", (vertices, faces)))


@pytest.mark.skipif(not (DATA / "pairs.csv").is_file(), reason=f"no data in {DATA}")
@pytest.mark.parametrize(("pair", "vertices"), [
    ("faustrem_000_004", 0), ("shrec16_cuts_cat_shape_4", 0), ("faustrem_000_004", 50_000),
    ("shrec16_cuts_dog_shape_15", 0),  # searched twice
    ("faustrem_000_004", POINTS),
])  # fmt: skip
def test_every_stage_is_told_as_about_the_part_of_the_work_that_it_is(pair: str, vertices: int) -> None:
    with (DATA / "pairs.csv").open(newline="", encoding="utf-8") as file:
        case = read_case(DATA, next(row for row in csv.DictReader(file) if row["id"] == pair))
    if vertices > 0:
        case = sized(case, vertices)
    if vertices == POINTS:
        case = replace(case, source=(case.source[0], None))
    rows = progress_of(case.source, case.target)
    check_rising_and_frequent(rows)
    spent: dict[str, float] = defaultdict(float)
    told: dict[str, float] = defaultdict(float)
    before: Row = (0.0, "", 0.0)
    for row in rows:
        spent[row[1]] += (row[0] - before[0]) / rows[-1][0]
        told[row[1]] += row[2] - before[2]
        before = row
    # What a stage of a few per cent costs cannot be foreseen within a factor, nor would anybody see it.
    few = 0.02
    for stage, share in spent.items():
        assert told[stage] <= 2.0 * share + few, (stage, told, spent)
        assert share <= 2.0 * told[stage] + few, (stage, told, spent)
