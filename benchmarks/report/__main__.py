# SPDX-License-Identifier: GPL-3.0-or-later
"""From a results.json to docs/accuracy.md and its pictures."""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from isograft import InvalidInput

from benchmarks.cases import read_case
from benchmarks.children import Row
from benchmarks.report.compose import compose
from benchmarks.report.curves import draw_curves, draw_reliability
from benchmarks.report.page import read_reasons, write_page
from benchmarks.report.worst import UP, load_map, scene_of, worst_pairs
from benchmarks.results import read_results

ROOT = Path(__file__).resolve().parents[2]
NO_REASON = "(No reason noted yet.)"


def main(arguments: list[str]) -> int:
    given = _parse(arguments)
    if not given.results.is_file():
        print(f"accuracy_report: {given.results} does not exist; run scripts/benchmark first", file=sys.stderr)
        return 2
    if not given.no_pictures and not (given.data / "pairs.csv").is_file():
        print(
            f"accuracy_report: {given.data} holds no pairs.csv, which the pictures need; name the folder of the pairs "
            "with --data or ISOGRAFT_DATA, or take --no-pictures",
            file=sys.stderr,
        )
        return 2
    results = read_results(given.results)
    rows = results["rows"]
    given.pictures.mkdir(parents=True, exist_ok=True)
    pictures = {}
    if draw_curves(rows, given.pictures / "curves.png"):
        pictures["curves"] = given.pictures / "curves.png"
    if results["reliability"]:
        pictures["reliability"] = given.pictures / "reliability.png"
        draw_reliability(results["reliability"][-1], pictures["reliability"])
    reasons = read_reasons(given.reasons)
    worst = worst_pairs(rows, given.worst)
    drawn = {} if given.no_pictures else _draw(worst, given.data, given.results.parent / "maps", given.pictures)
    write_page(
        given.output,
        results,
        [(row, reasons.get(row["id"], NO_REASON), drawn.get(row["id"])) for row in worst],
        pictures,
    )
    print(given.output)
    without = [row["id"] for row in worst if row["id"] not in reasons]
    if without:
        print(f"no reason in {given.reasons} for: {', '.join(without)}")
    return 0


def _draw(worst: list[Row], data: Path, maps: Path, pictures: Path) -> dict[str, Path]:
    """One picture per pair, all from one Blender; those of earlier reports go once all are there."""
    with (data / "pairs.csv").open(newline="", encoding="utf-8") as file:
        pairs = {pair["id"]: pair for pair in csv.DictReader(file)}
    drawn = {}
    with tempfile.TemporaryDirectory() as folder:
        calls: list[str] = []
        for row in worst:
            name = row["id"]
            try:
                found = load_map(maps / row["map"]) if row.get("map") and (maps / row["map"]).is_file() else None
                scene = scene_of(read_case(data, pairs[name]), found, UP.get(row["collection"], (0.0, 1.0, 0.0)))
            except (InvalidInput, KeyError) as error:
                print(f"{name}: no picture: {error}", file=sys.stderr)
                continue
            np.savez(Path(folder) / f"{name}.npz", **scene)
            calls += [f"{folder}/{name}.npz", f"{folder}/{name}.png"]
            drawn[name] = pictures / f"worst_{name}.jpg"
            print(f"{name}: scene made", flush=True)
        if calls:
            _blender(calls)
        for name, path in drawn.items():
            compose(Path(folder) / f"{name}.png", path)
    for old in pictures.glob("worst_*.jpg"):
        if old not in drawn.values():
            old.unlink()
    return drawn


def _blender(calls: list[str]) -> None:
    script = Path(__file__).with_name("blender_pictures.py")
    done = subprocess.run(
        ["blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P", str(script), "--", *calls],
        env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SystemExit(f"accuracy_report: Blender failed:\n{done.stdout[-3000:]}{done.stderr[-3000:]}")


def _parse(arguments: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="scripts/accuracy_report", description=__doc__)
    parser.add_argument("results", type=Path, metavar="RESULTS.json", help="of scripts/benchmark; maps/ lies beside it")
    parser.add_argument("--data", type=Path, metavar="DIR",
                        default=Path(os.environ.get("ISOGRAFT_DATA") or ROOT.parent / "shared" / "data"))  # fmt: skip
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "accuracy.md")
    parser.add_argument(
        "--pictures", type=Path, default=ROOT / "docs" / "pictures" / "accuracy", help="folder, below the page's"
    )
    parser.add_argument("--reasons", type=Path, default=ROOT / "docs" / "accuracy_reasons.txt",
                        help="lines PAIR: REASON, why a pair fails")  # fmt: skip
    parser.add_argument("--worst", type=int, default=10, metavar="N", help="pairs to show (default: 10)")
    parser.add_argument("--no-pictures", action="store_true", help="leave out the worst pairs' pictures")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
