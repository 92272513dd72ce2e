# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows and what they sum up to, as tables of Markdown."""

from __future__ import annotations

from typing import Any

from benchmarks.children import Row
from benchmarks.levels import MOTION_TOLERANCE, judged, level_cells, motions
from benchmarks.reliability import reliabilities
from benchmarks.summary import summarise

LEGEND = (
    "Error: mean geodesic distance over the root of the target's area, times 100. Coverage: matched share of the"
    " vertices with a truth. False: share of the matched ones with an error over 10. IoU: matched set against the"
    " set with a truth, where the truth says which vertices have no counterpart. A failed pair counts with coverage 0."
    " Ratio: seconds over the cost unit (one full geodesic window from every sample, one thread, same process). Times"
    " isograft: seconds of another method over isograft's on the same pairs; like seconds, comparable only where pairs"
    " ran one at a time. CPU: seconds of all threads together, which a busy machine changes least. Memory: peak of the"
    " process after matching."
)

_SHARES = ("coverage", "false_matches", "overlap_iou")
_HEADS = ("error", "coverage %", "false %", "IoU %")


def page(rows: list[Row], options: dict[str, Any]) -> str:
    settings = ", ".join(f"{key} {value}" for key, value in options.items())
    builds = sorted({f"{row['method']} {row['build']}" for row in rows})
    parts = [f"# Benchmark\n\nLast call: {settings}. Builds: {'; '.join(builds)}.\n\n{LEGEND}"]
    for title, text in (
        ("Levels", level_table(judged(rows))),
        ("Moved and turned at random", motion_table(motions(rows))),
        ("Confidence", reliability_tables(reliabilities(rows))),
    ):
        if text:
            parts.append(f"## {title}\n\n{text}")
    parts += ["## Collections\n\n" + collection_table(summarise(rows)), "## Pairs\n\n" + pair_table(rows)]
    staged = [row for row in rows if row.get("stages")]
    if staged:
        parts.append("## Seconds per stage\n\n" + _stage_table(staged))
    failed = [row for row in rows if row["status"] != "ok"]
    if failed:
        lines = [f"- {_name(row)}, {row['method']}, motion {row['rotation']}: {row['reason']}" for row in failed]
        parts.append("## Failed\n\n" + "\n".join(lines))
    return "\n\n".join(parts) + "\n"


def level_table(entries: list[Row]) -> str:
    """Empty if there is nothing to show; so are the others."""
    header = ["set", "pairs", "failed", *_HEADS, "must", "reached", "aim", "reached"]
    lines = [
        [entry["set"], str(entry["pairs"]), str(entry["failed"]), *measure_cells(entry), *level_cells(entry)]
        for entry in entries
    ]
    return table(header, lines) if lines else ""


def motion_table(entries: list[Row]) -> str:
    header = ["set", "runs", "mean error changed by", "error of a pair, at most", "coverage of a pair, at most, %",
              "matched in one place only", f"equal within {MOTION_TOLERANCE:g}"]  # fmt: skip
    lines = [
        [
            entry["set"],
            str(entry["runs"]),
            number(entry["mean_error_change"], 2),
            number(entry["largest_error_change"], 2),
            number(entry["largest_coverage_change"], 1, 100.0),
            str(entry["lost"]),
            "yes" if entry["equal"] else "no",
        ]
        for entry in entries
    ]
    return table(header, lines) if lines else ""


def reliability_tables(entries: list[Row]) -> str:
    """Over all sets the ten bins with their counts, and a line per set."""
    if not entries:
        return ""
    whole = entries[-1]
    bins = [
        [f"{b['low']:.1f} to {b['high']:.1f}", str(b["count"]), number(b["confidence"], 3), number(b["right"], 3)]
        for b in whole["bins"]
    ]
    header = ["set", "vertices", "mean confidence", "share right", "expected calibration error"]
    header += [f"{b['low']:.1f}" for b in whole["bins"]]
    lines = [
        [
            entry["set"],
            str(entry["count"]),
            *(number(entry[name], 3) for name in ("confidence", "right", "calibration_error")),
            *(f"{number(b['right'], 2)} ({b['count']})" if b["count"] else "-" for b in entry["bins"]),
        ]
        for entry in entries
    ]
    return (
        "Of the sampled vertices that are matched; right is an error below 5. Expected calibration error over"
        f" {'all sets' if whole['set'] == 'all' else 'the set'}: {number(whole['calibration_error'], 3)}.\n\n"
        + table(["confidence", "vertices", "mean confidence", "share right"], bins)
        + "\n\nPer set: the share right in each bin of confidence (named by its lower end), and the vertices in it.\n\n"
        + table(header, lines)
    )


def collection_table(entries: list[Row]) -> str:
    moved = any(entry["moved"] for entry in entries)
    peers = any(entry["method"] != "isograft" for entry in entries)
    header = [
        "set",
        "method",
        "pairs",
        "failed",
        *_HEADS,
        "s (median)",
        "CPU s (median)",
        "ratio (median)",
        *(["times isograft (median)"] if peers else []),
        "peak MB (max)",
    ]
    lines = []
    for entry in entries:
        name = entry["collection"] + (", moved" if entry["moved"] else "")
        cells = [name, entry["method"], str(entry["pairs"]), str(entry["failed"]), *measure_cells(entry)]
        cells += [number(entry[name], 1) for name in ("seconds", "cpu_seconds", "ratio")]
        if peers:
            cells.append(number(entry.get("times_isograft"), 2))
        cells.append(number(entry["peak_mb"], 0))
        if moved:
            cells.append(number(entry.get("largest_change"), 2))
        lines.append(cells)
    return table([*header, "error changed by at most"] if moved else header, lines)


def pair_table(rows: list[Row]) -> str:
    header = ["pair", "method", "motion", "vertices", *_HEADS, "s", "CPU s", "ratio", "peak MB"]
    lines = []
    for row in rows:
        sizes = f"{row['source_vertices']}, {row['target_vertices']}" if "source_vertices" in row else "-"
        cells = [_name(row), row["method"], str(row["rotation"]), sizes]
        cells += measure_cells(row) if row["status"] == "ok" else ["failed", "0", "-", "-"]
        cells += [number(row.get("seconds"), 2), number(row.get("cpu_seconds"), 2)]
        cells += [number(row.get("ratio"), 1), number(row.get("peak_mb"), 0)]
        lines.append(cells)
    return table(header, lines)


def _stage_table(rows: list[Row]) -> str:
    names = list(dict.fromkeys(name for row in rows for name in row["stages"]))
    lines = [
        [_name(row), str(row["rotation"]), *(number(row["stages"].get(name), 2) for name in names),
         number(row["seconds"], 2), number(row.get("cost_unit_seconds"), 3)]
        for row in rows
    ]  # fmt: skip
    return table(["pair", "motion", *names, "whole", "cost unit"], lines)


def line(row: Row) -> str:
    """One row, for the terminal."""
    name = f"{_name(row):<40} {row['method']:<12} {row['rotation']}"
    if row["status"] != "ok":
        return f"{name}  failed: {row['reason']}"
    cells = zip(("error", "coverage", "false", "IoU"), measure_cells(row), strict=True)
    measures = "  ".join(f"{head} {cell:>5}" for head, cell in cells)
    return f"{name}  {measures}  {row['seconds']:7.2f} s  ratio {number(row.get('ratio'), 1)}  {row['peak_mb']:.0f} MB"


def measure_cells(values: Row) -> list[str]:
    return [number(values.get("error"), 2), *(number(values.get(name), 1, 100.0) for name in _SHARES)]


def number(value: float | None, digits: int, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.{digits}f}"


def table(header: list[str], lines: list[list[str]]) -> str:
    widths = [max(len(row[k]) for row in [header, *lines]) for k in range(len(header))]
    padded = [
        " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in [header, *lines]
    ]
    rule = "|".join("-" * (width + 2) for width in widths)
    return "\n".join([f"| {padded[0]} |", f"|{rule}|", *(f"| {row} |" for row in padded[1:])])


def _name(row: Row) -> str:
    return f"{row['id']}, reversed" if row["reverse"] else str(row["id"])
