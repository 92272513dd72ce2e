# SPDX-License-Identifier: GPL-3.0-or-later
"""`scripts/experiments [NAME ...]`: matches, measures, draws, and writes docs/experiments.md from all that is done."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from isograft import InvalidInput

from experiments.catalogue import EXPERIMENTS, Experiment, Pair
from experiments.page import write_page
from experiments.pictures import can_render, checker_picture, curves
from experiments.run import Settings, run_pair

ROOT = Path(__file__).resolve().parent.parent


def parse(arguments: list[str]) -> argparse.Namespace:
    names = [e.name for e in EXPERIMENTS]
    parser = argparse.ArgumentParser(
        prog="scripts/experiments",
        description="Run the paper's experiments again. What is done is kept in OUT and not done again unless the "
        "version or an option of the preset has changed, so an interrupted run goes on where it stopped.",
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all: {', '.join(names)}")
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("ISOGRAFT_DATA", ROOT.parent / "shared/data")))
    parser.add_argument("--out", type=Path, default=ROOT / "build/experiments")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument(
        "--vertices",
        type=int,
        help="largest mesh of preset paper (default: that of the experiment, as the page has it)",
    )
    parser.add_argument(
        "--matches", type=int, default=200, help="oriented matches it tries (default: 200, the paper's)"
    )
    parser.add_argument("--methods", default="paper,default", help="besides the peers (default: paper,default)")
    parser.add_argument("--no-pictures", action="store_true", help="no checkerboard pictures; they need Blender")
    parser.add_argument("--page-only", action="store_true", help="write the page from what is there")
    given = parser.parse_args(arguments)
    unknown = [name for name in given.names if name not in names]
    if unknown:
        parser.error(f"there is no experiment {unknown[0]!r}; there are {', '.join(names)}")
    if not given.page_only and not (given.data / "pairs.csv").is_file():
        parser.error(f"{given.data} holds no pairs.csv; name the folder of the pairs with --data or ISOGRAFT_DATA")
    return given


def run(experiment: Experiment, given: argparse.Namespace, settings: Settings) -> None:
    pairs: list[Pair] = experiment.pairs(settings.data)
    methods = [*given.methods.split(","), *experiment.peers]
    figures = ROOT / "docs/pictures/experiments"
    figures.mkdir(parents=True, exist_ok=True)
    rows = []
    for pair in pairs:
        for method in methods:
            row = run_pair(experiment, pair, method, settings)
            told = row.get("failed") or f"error {row['error']} coverage {row['coverage']:.3f} {row['seconds']:.0f} s"
            print(f"{experiment.name} {pair.name} {method}: {told}", flush=True)
            if "curve" in row:
                rows.append(row)
    if rows and experiment.drawn:
        curves(experiment.title, rows, figures / f"{experiment.name}_curve.png")
    if experiment.drawn and not given.no_pictures and can_render():
        for pair in pairs:
            picture = figures / f"{pair.name}.jpg"
            newest = max(
                (p.stat().st_mtime for p in (settings.out / experiment.name).glob(f"{pair.name}.*.npz")), default=0.0
            )
            if newest and not (picture.exists() and picture.stat().st_mtime > newest):
                checker_picture(experiment, pair, methods, settings.out / experiment.name, picture)


def main() -> int:
    given = parse(sys.argv[1:])
    settings = Settings(given.data, given.out, given.threads, given.vertices, given.matches)
    if not given.page_only:
        for experiment in EXPERIMENTS:
            if given.names and experiment.name not in given.names:
                continue
            try:
                run(experiment, given, settings)
            except InvalidInput as error:
                print(f"{experiment.name}: {error}", file=sys.stderr)
    write_page(EXPERIMENTS, given.out, ROOT / "docs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
