# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark --cancel: how long a match takes to stop, asked to at random moments."""

from __future__ import annotations

import argparse
import json
import threading
import time
from pathlib import Path
from typing import Any

import isograft
import numpy as np

from benchmarks.cases import read_case
from benchmarks.scaling import PAIR, find_pair
from benchmarks.scaling_child import sized

LIMIT = 0.2


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(prog="scripts/benchmark --cancel", description=__doc__)
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="cancel.json")
    parser.add_argument("--data", metavar="DIR", type=Path, help="with pairs.csv (default: ../shared/data)")
    parser.add_argument("--pair", default=PAIR, help=f"whose two surfaces are refined (default: {PAIR})")
    parser.add_argument("--sizes", metavar="A,B", default="5100,100000,1000000", help="numbers of vertices")
    parser.add_argument("--moments", metavar="N", type=int, default=100, help="runs that are cancelled (default: 100)")
    parser.add_argument("--threads", metavar="N", type=int, help="default: all cores")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="of the moments")
    given = parser.parse_args(arguments)
    data, pair = find_pair(parser, given, root)
    given.output.mkdir(parents=True, exist_ok=True)
    rows = []
    for size in (int(text) for text in given.sizes.split(",")):
        case = sized(read_case(data, pair), size)
        random = np.random.default_rng(given.seed)
        row = measure(case.source, case.target, random, given.moments, threads=given.threads)
        rows.append({"vertices": size, **row})
        print(json.dumps({key: value for key, value in rows[-1].items() if key != "stops"}), flush=True)
        (given.output / "cancel.json").write_text(json.dumps(rows, indent=1), encoding="utf-8")
    return 0 if all(row["p99"] <= LIMIT for row in rows) else 1


def measure(source: Any, target: Any, random: np.random.Generator, moments: int, **options: Any) -> dict[str, Any]:
    """One whole match, then so many that are cancelled at moments spread evenly over its time.

    Counted from the wish, as a user's key press, to the return of match(): the wait for the next call of `progress`
    included.
    """
    start = time.perf_counter()
    isograft.match(source, target, progress=lambda stage, fraction: None, **options)
    whole = time.perf_counter() - start
    stops = []
    # One moment in each of as many equal parts of the time.
    for moment in random.permutation((np.arange(moments) + random.random(moments)) / moments * whole):
        stopped = stop_at(float(moment), source, target, **options)
        if stopped is not None:
            stops.append(stopped)
    seconds = np.array([stop["seconds"] for stop in stops])
    return {
        "seconds": round(whole, 3),
        "cancelled": len(stops),
        "median": round(float(np.median(seconds)), 4),
        "p99": round(float(np.quantile(seconds, 0.99)), 4),
        "worst": max(stops, key=lambda stop: float(stop["seconds"])),
        "stops": stops,
    }


def stop_at(moment: float, source: Any, target: Any, **options: Any) -> dict[str, Any] | None:
    """Seconds from the wish, `moment` seconds after the start, to the return; None if the match was over before."""
    wished = threading.Event()
    at = [0.0]
    last = ["", 0.0]

    def wish() -> None:
        at[0] = time.perf_counter()
        wished.set()

    def progress(stage: str, fraction: float) -> bool:
        last[:] = stage, fraction
        return not wished.is_set()

    timer = threading.Timer(moment, wish)
    timer.start()
    try:
        isograft.match(source, target, progress=progress, **options)
    except isograft.Cancelled:
        return {"seconds": round(time.perf_counter() - at[0], 4), "stage": last[0], "fraction": round(last[1], 4)}
    finally:
        timer.cancel()
        timer.join()
    return None
