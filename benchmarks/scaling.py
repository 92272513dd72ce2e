# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/benchmark --scaling: one pair at rising numbers of vertices, and the exponents of time and memory."""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from benchmarks.options import listed_pairs

Row = dict[str, Any]

SIZES = (5_100, 10_000, 20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000)
#: Two remeshed bodies of 5,000 vertices whose triangulations have nothing in common.
PAIR = "faustrem_000_004"
#: Exponents are fitted from here up: below, the fixed cost of the search is all there is.
FIT_FROM = 10_000


def main(arguments: list[str], root: Path) -> int:
    parser = argparse.ArgumentParser(prog="scripts/benchmark --scaling", description=__doc__)
    parser.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="scaling.json, scaling.md")
    parser.add_argument("--data", metavar="DIR", type=Path, help="with pairs.csv (default: ../shared/data)")
    parser.add_argument("--pair", default=PAIR, help=f"whose two surfaces are refined (default: {PAIR})")
    parser.add_argument("--sizes", metavar="A,B", help="numbers of vertices (default: 5,100 to 1 million)")
    parser.add_argument("--threads", metavar="A,B", default=f"1,{os.cpu_count() or 1}", help="(default: 1 and all)")
    parser.add_argument("--single-limit", metavar="N", type=int, default=100_000,
                        help="largest size that is also run with fewer threads (default: 100,000)")  # fmt: skip
    parser.add_argument("--repeats", metavar="N", type=int, default=1, help="runs for the median time")
    parser.add_argument("--preset", default="default")
    given = parser.parse_args(arguments)
    data, pair = find_pair(parser, given, root)
    sizes = [int(size) for size in given.sizes.split(",")] if given.sizes else list(SIZES)
    threads = sorted({int(count) for count in given.threads.split(",")})
    given.output.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    for size in sizes:
        for count in threads:
            if count < threads[-1] and size > given.single_limit:
                continue
            request = {
                "data": str(data), "pair": pair, "vertices": size, "threads": count,
                "repeats": given.repeats, "preset": given.preset,
            }  # fmt: skip
            row = run_child(request)
            rows.append(row)
            print(json.dumps({key: value for key, value in row.items() if key != "stages"}), flush=True)
            write(given.output, rows, {"pair": given.pair, "repeats": given.repeats, "preset": given.preset})
    print((given.output / "scaling.md").read_text(encoding="utf-8"))
    return 0 if all(row["status"] == "ok" for row in rows) else 1


def find_pair(parser: argparse.ArgumentParser, given: argparse.Namespace, root: Path) -> tuple[Path, dict[str, str]]:
    """The folder of pairs and the row of `given.pair`; ends with the parser's error if there is none."""
    data, listed = listed_pairs(parser, given, root)
    pair = next((row for row in listed if row["id"] == given.pair), None)
    if pair is None:
        parser.error(f"{data / 'pairs.csv'} has no pair {given.pair!r}")
    return data, pair


def run_child(request: Row) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder) / "row.json"
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            [sys.executable, "-m", "benchmarks.scaling_child", str(answer)],
            input=json.dumps(request), text=True, env=environment, check=False,
        )  # fmt: skip
        if done.returncode == 0 and answer.is_file():
            return {**json.loads(answer.read_text(encoding="utf-8")), "status": "ok"}
    return {"vertices": request["vertices"], "threads": request["threads"], "status": f"ended with {done.returncode}"}


def exponent(rows: list[Row], field: str) -> float | None:
    """Slope of log(field) over log(vertices) by least squares, from FIT_FROM up; None below three sizes."""
    points = [
        (math.log(row["vertices"]), math.log(row[field]))
        for row in rows
        if row["status"] == "ok" and row["vertices"] >= FIT_FROM and row[field] > 0
    ]
    if len(points) < 3:
        return None
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def write(folder: Path, rows: list[Row], options: dict[str, Any]) -> None:
    most = max(row["threads"] for row in rows)
    all_threads = [row for row in rows if row["threads"] == most]
    exponents = {field: exponent(all_threads, field) for field in ("seconds", "peak_mb")}
    machine = {"cores": os.cpu_count(), "platform": platform.platform()}
    content = {"options": options, "machine": machine, "exponents": exponents, "rows": rows}
    (folder / "scaling.json").write_text(json.dumps(content, indent=1), encoding="utf-8")
    (folder / "scaling.md").write_text(table(rows, exponents), encoding="utf-8")


def table(rows: list[Row], exponents: dict[str, float | None]) -> str:
    most = max(row["threads"] for row in rows)
    single = {row["vertices"]: row for row in rows if row["threads"] == 1 and row["status"] == "ok"}
    lines = [
        f"| vertices | seconds, {most} threads | 1 thread | gain | peak MB | cost unit, s | seconds / unit |"
        " error | coverage |",
        "| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in rows:
        if row["threads"] != most:
            continue
        if row["status"] != "ok":
            lines.append(f"| {row['vertices']:,} | {row['status']} |" + " |" * 7)
            continue
        alone = single.get(row["vertices"])
        wall, unit = row["seconds"], row["cost_unit_seconds"]
        ratio = f"{wall / unit:.2f}" if unit > 0 else ""
        other = f"{alone['seconds']:.2f} | {alone['seconds'] / wall:.2f}" if alone and most > 1 else "|"
        lines.append(
            f"| {row['vertices']:,} | {wall:.2f} | {other} | {row['peak_mb']:.0f} | {unit:.2f} | {ratio} "
            f"| {row.get('error') or 0:.2f} | {100 * (row.get('coverage') or 0):.0f} % |"
        )
    fitted = [
        f"{name} grows as the {value:.2f}th power of the number of vertices from {FIT_FROM:,} up"
        for name, value in (("time", exponents["seconds"]), ("peak memory", exponents["peak_mb"]))
        if value is not None
    ]
    return "\n".join(lines) + "\n" + (f"\nFitted: {'; '.join(fitted)}.\n" if fitted else "")
