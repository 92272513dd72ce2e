# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line, and the list of runs that it asks for."""

from __future__ import annotations

import argparse
import csv
import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks.build import build_of

#: Vertices of the larger surface up to which the peers are run.
PEER_LIMIT = 15_000

PEERS = ("nearest", "pyfm-zoomout")

COLUMNS = ("id", "collection", "source", "target", "gt_kind", "gt_file", "gt_bary", "gt_minus1", "category", "core")


@dataclass(frozen=True)
class Options:
    data: Path
    output: Path
    pairs: list[dict[str, str]]
    rotations: int
    reverse: bool
    peers: bool
    only_peers: bool
    threads: int | None
    jobs: int
    limit: float
    repeats: int
    samples: int
    preset: str
    overrides: dict[str, Any]
    as_points: str | None
    points: int
    noise: float
    fresh: bool
    #: Names of all pairs, in the order in which they are to be told.
    order: list[str]

    @property
    def settings(self) -> dict[str, Any]:
        """What a result depends on beside the build; rows with others cannot stand in one table."""
        settings = {"preset": self.preset, "overrides": self.overrides, "samples": self.samples}
        # Only where it is asked for: results kept from before stay comparable.
        settings |= {"as_points": self.as_points, "points": self.points} if self.as_points else {}
        return settings | ({"noise": self.noise} if self.noise else {})

    @property
    def methods(self) -> list[str]:
        return [*([] if self.only_peers else ["isograft"]), *(PEERS if self.peers else [])]

    @property
    def builds(self) -> dict[str, str]:
        return {method: build_of(method) for method in self.methods}

    def described(self) -> dict[str, Any]:
        """What a reader of the results must know to repeat them."""
        names = (
            "rotations",
            "reverse",
            "peers",
            "threads",
            "jobs",
            "limit",
            "repeats",
            "samples",
            "preset",
            "overrides",
            "as_points",
            "points",
            "noise",
        )
        return {"pairs": len(self.pairs), **{name: getattr(self, name) for name in names}}


def parse_options(arguments: list[str], root: Path) -> Options:
    parser = argparse.ArgumentParser(
        prog="scripts/benchmark",
        description="Match pairs of surfaces whose true correspondence is known, and measure.",
        epilog="A crash, an error or a timeout is a failed pair of coverage 0; it stops nothing.",
    )
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="results.json and results.md")
    parser.add_argument("--data", metavar="DIR", type=Path, help="with pairs.csv (default: ../shared/data, or "
                        "the environment's ISOGRAFT_DATA)")  # fmt: skip
    parser.add_argument("--core", action="store_true", help="only the smaller, balanced subset")
    parser.add_argument("--category", metavar="C", action="append", default=[])
    parser.add_argument("--collection", metavar="C", action="append", default=[])
    parser.add_argument("--ids", metavar="A,B", action="append", default=[])
    parser.add_argument("--reverse", action="store_true", help="match target to source, with the truth inverted")
    parser.add_argument("--rotations", metavar="N", type=_count(0), default=0,
                        help="repeat every pair N times with either shape moved and turned at random")  # fmt: skip
    parser.add_argument("--peers", action="store_true",
                        help=f"also nearest point and pyFM with ZoomOut, up to {PEER_LIMIT} vertices")  # fmt: skip
    parser.add_argument("--only-peers", action="store_true", help="the peers without isograft")
    parser.add_argument("--preset", default="default")
    parser.add_argument("--set", metavar="STAGE_FIELD=VALUE", action="append", default=[], dest="overrides")
    parser.add_argument("--threads", metavar="N", type=_count(1), help="of match() (default: the cores over --jobs)")
    parser.add_argument("--jobs", metavar="N", type=_count(1), default=1,
                        help="pairs at once; times are only comparable with 1 (default)")  # fmt: skip
    parser.add_argument("--limit", metavar="SECONDS", type=float, default=1800.0, help="per pair (default: 1800)")
    parser.add_argument("--repeats", metavar="N", type=_count(1), default=1, help="runs of match() for the median time")
    parser.add_argument("--samples", metavar="N", type=_count(1), default=250, help="vertices measured per pair")
    parser.add_argument("--as-points", choices=("source", "target", "both"),
                        help="sample this side of a pair of meshes to points")  # fmt: skip
    parser.add_argument("--points", metavar="N", type=_count(50), default=8000, help="of --as-points (default: 8000)")
    parser.add_argument("--noise", metavar="SHARE", type=float, default=0.0,
                        help="move vertices of both meshes at random: sigma an axis in mean edges")  # fmt: skip
    parser.add_argument("--fresh", action="store_true",
                        help="forget what DIR holds; else what this build measured is not run again")  # fmt: skip
    given = parser.parse_args(arguments)

    data, listed = listed_pairs(parser, given, root)
    pairs = _choose(listed, given, parser)
    threads = given.threads
    if threads is None and given.jobs > 1:
        threads = max(1, (os.cpu_count() or 1) // given.jobs)
    return Options(
        data=data,
        output=given.output,
        pairs=pairs,
        rotations=given.rotations,
        reverse=given.reverse,
        peers=given.peers or given.only_peers,
        only_peers=given.only_peers,
        threads=threads,
        jobs=given.jobs,
        limit=given.limit,
        repeats=given.repeats,
        samples=given.samples,
        preset=given.preset,
        overrides=_overrides(given.overrides, parser),
        as_points=given.as_points,
        points=given.points,
        noise=given.noise,
        fresh=given.fresh,
        order=[pair["id"] for pair in listed],
    )


def requests_of(options: Options) -> list[dict[str, Any]]:
    """One request per process: plain data, as children.run_child() hands it on."""
    builds = options.builds
    common = {
        "data": str(options.data),
        "reverse": options.reverse,
        "threads": options.threads,
        "jobs": options.jobs,
        "samples": options.samples,
        "preset": options.preset,
        "overrides": options.overrides,
        "settings": options.settings,
        "as_points": options.as_points,
        "points": options.points,
        "noise": options.noise,
        "peer_limit": PEER_LIMIT,
    }
    requests = []
    for pair in options.pairs:
        for method in options.methods:
            ours = method == "isograft"
            for rotation in range(options.rotations + 1 if ours else 1):
                own = {
                    "pair": pair,
                    "method": method,
                    "rotation": rotation,
                    "build": builds[method],
                    "repeats": options.repeats if ours else 1,
                    "maps": str(options.output / "maps") if ours and rotation == 0 else None,
                }
                requests.append({**common, **own})
    return requests


def largest_first(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """By the size of the files, so that several at once end at about the same time."""

    def size(request: dict[str, Any]) -> int:
        paths = [Path(request["data"]) / request["pair"][side] for side in ("source", "target")]
        return sum(path.stat().st_size for path in paths if path.is_file())

    return sorted(requests, key=size, reverse=True)


def _count(least: int) -> Any:
    def count(text: str) -> int:
        value = int(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"at least {least}, not {value}")
        return value

    return count


def listed_pairs(
    parser: argparse.ArgumentParser, given: argparse.Namespace, root: Path
) -> tuple[Path, list[dict[str, str]]]:
    """The folder of pairs, `given.data` or the usual one, and the rows of its pairs.csv; the parser's error without."""
    data = given.data or Path(os.environ.get("ISOGRAFT_DATA") or root.parent / "shared" / "data")
    listing = data / "pairs.csv"
    if not listing.is_file():
        parser.error(f"{listing} does not exist; name the folder with --data")
    with listing.open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    missing = set(COLUMNS) - set(rows[0] if rows else ())
    if missing:
        parser.error(f"{listing} lacks the columns {', '.join(sorted(missing))}")
    return data, [{name: row[name] or "" for name in COLUMNS} for row in rows]


def _choose(
    pairs: list[dict[str, str]], given: argparse.Namespace, parser: argparse.ArgumentParser
) -> list[dict[str, str]]:
    ids = [name for part in given.ids for name in part.split(",") if name]
    for what, wanted, known in (
        ("id", ids, {pair["id"] for pair in pairs}),
        ("category", given.category, {pair["category"] for pair in pairs}),
        ("collection", given.collection, {pair["collection"] for pair in pairs}),
    ):
        unknown = [name for name in wanted if name not in known]
        if unknown:
            parser.error(f"no pair has the {what} {unknown[0]!r}; there are {', '.join(sorted(known))}")
    chosen = [
        pair
        for pair in pairs
        if (not ids or pair["id"] in ids)
        and (not given.core or pair["core"] == "1")
        and (not given.category or pair["category"] in given.category)
        and (not given.collection or pair["collection"] in given.collection)
    ]
    if not chosen:
        parser.error("no pair fits all of these choices")
    return chosen


def _overrides(texts: list[str], parser: argparse.ArgumentParser) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            if not equals:
                raise ValueError
            values[name] = json.loads(value)
        except ValueError:
            parser.error(f"--set {text}: write STAGE_FIELD=VALUE with a number, true or false")
    return values
