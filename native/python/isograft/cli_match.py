# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft match SOURCE TARGET -o MAP`."""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from isograft.cli_outcome import NOTHING_MATCHED, OK, BadInput, ProgressLine, check_output, open_mesh
from isograft.files import MAP_SUFFIXES, MESH_SUFFIXES, write_map
from isograft.landmarks import read_landmarks
from isograft.matching import match


def add_match(commands: Any, epilog: str) -> None:
    parser = commands.add_parser(
        "match",
        help="find the map from one surface to another",
        description=f"Find the map from SOURCE to TARGET (files: {', '.join(MESH_SUFFIXES)}). Rows of the result are "
        "the source's vertices, its triangle indices the target's triangles. A file without faces is a point cloud.",
        epilog=epilog,
    )
    parser.add_argument("source", metavar="SOURCE")
    parser.add_argument("target", metavar="TARGET")
    parser.add_argument(
        "-o",
        "--output",
        metavar="MAP",
        required=True,
        help=".npz (everything), .corr (SHREC'16) or .ply (the source with attributes)",
    )
    parser.add_argument("--preset", choices=("fast", "default", "thorough", "noisy", "paper"), default="default")
    parser.add_argument(
        "--landmarks",
        metavar="FILE",
        help='JSON: [[source, target], ...], each with a weight if wanted, or {"source": [...], "target": [...]}; '
        "points are vertex indices or positions",
    )
    parser.add_argument(
        "--scale", default="auto", metavar="auto|fixed|NUMBER", help="target units per source unit (default: auto)"
    )
    parser.add_argument("--threads", type=int, metavar="N", help="default: all cores")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of every random choice (default: 0)")
    parser.add_argument(
        "--memory-limit", type=float, metavar="GB", help="refuse a match that is estimated to take more than this"
    )
    parser.add_argument("--progress", action="store_true", help="also where standard error is no terminal")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.set_defaults(run=run_match)


def run_match(arguments: argparse.Namespace) -> int:
    scale = _scale(arguments.scale)
    check_output(arguments.output, MAP_SUFFIXES)
    landmarks = None if arguments.landmarks is None else read_landmarks(arguments.landmarks)
    source = open_mesh(arguments.source)
    target = open_mesh(arguments.target)
    if arguments.output.lower().endswith(".corr") and not len(target.polygons.sizes):
        raise BadInput(f"{arguments.output}: .corr names triangles, and TARGET is a point cloud: write .npz or .ply")
    progress = ProgressLine() if arguments.progress or sys.stderr.isatty() else None
    try:
        result = match(
            source.parts,
            target.parts,
            names=(source.path, target.path),
            preset=arguments.preset,
            landmarks=landmarks,
            scale=scale,
            threads=arguments.threads,
            seed=arguments.seed,
            memory_limit=None if arguments.memory_limit is None else max(1, round(arguments.memory_limit * 1e9)),
            progress=progress,
        )
    finally:
        if progress is not None:
            progress.close()
    write_map(arguments.output, result, source)

    best, report = result.best, result.report
    code = OK if best.matched.any() else NOTHING_MATCHED
    warnings = [*(f"source: {text}" for text in source.warnings), *(f"target: {text}" for text in target.warnings)]
    warnings += report.warnings
    for warning in warnings:
        print(f"isograft match: warning: {warning}", file=sys.stderr)
    if arguments.json:
        summary = {
            "map": arguments.output,
            "vertices": len(best),
            "matched": int(best.matched.sum()),
            "coverage": best.coverage,
            "regions": int(best.region.max(initial=-1)) + 1,
            "alternatives": len(result.alternatives),
            "warnings": warnings,
            "report": report.to_dict(),
            "exit_code": code,
        }
        print(json.dumps(summary))
    else:
        print(
            f"{int(best.matched.sum())} of {len(best)} vertices matched ({100 * best.coverage:.1f} %), scale "
            f"{report.scale:.4g}, {report.seconds:.1f} s: {arguments.output}"
        )
    return code


def _scale(text: str) -> str | float:
    if text in ("auto", "fixed"):
        return text
    try:
        return float(text)
    except ValueError:
        raise BadInput(f'--scale must be "auto", "fixed" or a number, not "{text}"') from None
