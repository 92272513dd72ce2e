# SPDX-License-Identifier: GPL-3.0-or-later
"""`isograft evaluate MAP --truth FILE --target MESH`."""

from __future__ import annotations

import argparse
import json
from typing import Any

from isograft.cli_outcome import NOTHING_MATCHED, OK, BadInput, open_mesh
from isograft.evaluation import evaluate, load_truth
from isograft.files import read_map


def add_evaluate(commands: Any, epilog: str) -> None:
    parser = commands.add_parser(
        "evaluate",
        help="measure a map where the truth is known",
        description="Error (geodesic, over the root of the target's area, times 100), coverage, false matches and, "
        "with --unmatched-is-truth, overlap.",
        epilog=epilog,
    )
    parser.add_argument("map", metavar="MAP", help=".npz or .corr")
    parser.add_argument(
        "--truth",
        metavar="FILE",
        required=True,
        help="one target vertex or -1 a line, or an .npz with the arrays tri and w",
    )
    parser.add_argument("--target", metavar="MESH", required=True, help="the target that the map was made for")
    parser.add_argument("--samples", type=int, default=250, metavar="N", help="vertices measured (default: 250)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the choice of these (default: 0)")
    parser.add_argument(
        "--unmatched-is-truth", action="store_true", help="-1 in the truth says that there is no counterpart"
    )
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.set_defaults(run=run_evaluate)


def run_evaluate(arguments: argparse.Namespace) -> int:
    target = open_mesh(arguments.target).surface()
    try:
        correspondence = read_map(arguments.map, target)
        truth = load_truth(arguments.truth)
    except OSError as error:
        raise BadInput(f"{error.filename}: {error.strerror or error}") from None
    result = evaluate(
        correspondence,
        truth,
        target,
        samples=arguments.samples,
        seed=arguments.seed,
        unmatched_is_truth=arguments.unmatched_is_truth,
    )
    code = OK if correspondence.matched.any() else NOTHING_MATCHED
    values = result.to_dict()
    if arguments.json:
        print(json.dumps({"map": arguments.map, **values, "exit_code": code}))
    else:
        for name, value in values.items():
            print(f"{name.replace('_', ' ')}: {'-' if value is None else f'{value:.4g}'}")
    return code
