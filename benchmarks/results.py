# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows as they come in, kept as JSON and as a Markdown page, and what they sum up to."""

from __future__ import annotations

import json
import os
import platform
import statistics
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from benchmarks.children import Row


class Results:
    """Collects rows; after each, results.json and results.md in `folder` hold all so far."""

    def __init__(self, folder: Path, options: dict[str, Any]) -> None:
        self._folder = folder
        self._options = options
        self._rows: list[Row] = []
        folder.mkdir(parents=True, exist_ok=True)

    def add(self, row: Row) -> None:
        self._rows.append(row)
        self.write()
        print(_line(row), flush=True)

    def write(self) -> None:
        content = {
            "options": self._options,
            "machine": {
                "cores": os.cpu_count(),
                "platform": platform.platform(),
                "python": platform.python_version(),
            },
            "collections": summarise(self._rows),
            "rows": self._rows,
        }
        _replace(self._folder / "results.json", json.dumps(content, indent=1, allow_nan=False))
        _replace(self._folder / "results.md", self._page())

    def summary(self) -> str:
        return _collection_table(summarise(self._rows))

    def _page(self) -> str:
        options = ", ".join(f"{key} {value}" for key, value in self._options.items())
        parts = [
            f"# Benchmark\n\n{options}\n\n{_LEGEND}",
            "## Collections\n\n" + self.summary(),
            "## Pairs\n\n" + _pair_table(self._rows),
        ]
        staged = [row for row in self._rows if row.get("stages")]
        if staged:
            parts.append("## Seconds per stage\n\n" + _stage_table(staged))
        failed = [row for row in self._rows if row["status"] != "ok"]
        if failed:
            lines = [f"- {row['id']}, {row['method']}, motion {row['rotation']}: {row['reason']}" for row in failed]
            parts.append("## Failed\n\n" + "\n".join(lines))
        return "\n\n".join(parts) + "\n"


_LEGEND = (
    "Error: mean geodesic distance over the root of the target's area, times 100. Coverage: matched share of the"
    " vertices with a truth. False: share of the matched ones with an error over 10. IoU: matched set against the"
    " set with a truth. A failed pair counts with coverage 0. Ratio: seconds over the cost unit (one full"
    " geodesic window from every sample, one thread, same process). CPU: seconds of all threads together, which"
    " a busy machine changes least. Memory: peak of the process after matching.\n"
)


def summarise(rows: Iterable[Row]) -> list[Row]:
    """One entry per collection, method, and moved or not; then one over all pairs."""
    rows = list(rows)
    unmoved = {(row["id"], row["method"]): row for row in rows if row["rotation"] == 0}
    entries = []
    labels = list(dict.fromkeys(_label(row) for row in rows))
    for label in [*labels, "all"] if len(labels) > 1 else labels:
        for method in dict.fromkeys(row["method"] for row in rows):
            for moved in (False, True):
                chosen = [
                    row
                    for row in rows
                    if label in ("all", _label(row)) and row["method"] == method and (row["rotation"] > 0) == moved
                ]
                if chosen:
                    entry = {"collection": label, "method": method, "moved": moved, **_summed(chosen)}
                    if moved:
                        entry["largest_change"] = _largest_change(chosen, unmoved)
                    entries.append(entry)
    return entries


def _label(row: Row) -> str:
    """The collection; its partial and non-isometric pairs apart, since other levels are asked of them."""
    category = str(row["category"])
    apart = category.startswith("partial") or category == "non-isometric"
    return f"{row['collection']} {category}" if apart else str(row["collection"])


def _summed(rows: list[Row]) -> Row:
    measured = [row for row in rows if row["has_truth"]]
    failed = [row for row in rows if row["status"] != "ok"]
    return {
        "pairs": len(rows),
        "failed": len(failed),
        "measured": len(measured),
        "error": _mean(row.get("error") for row in measured),
        "coverage": _mean(row.get("coverage", 0.0) for row in measured),
        "false_matches": _mean(row.get("false_matches") for row in measured),
        "overlap_iou": _mean(row.get("overlap_iou", 0.0) for row in measured if row["has_overlap"]),
        "seconds": _median(row.get("seconds") for row in rows),
        "cpu_seconds": _median(row.get("cpu_seconds") for row in rows),
        "ratio": _median(row.get("ratio") for row in rows),
        "peak_mb": max((row["peak_mb"] for row in rows if row.get("peak_mb") is not None), default=None),
    }


def _largest_change(moved: list[Row], unmoved: dict[tuple[str, str], Row]) -> float | None:
    """Of the error, by moving a pair's shapes; over the pairs measured both ways."""
    changes = []
    for row in moved:
        still = unmoved.get((row["id"], row["method"]), {})
        if row.get("error") is not None and still.get("error") is not None:
            changes.append(abs(row["error"] - still["error"]))
    return max(changes, default=None)


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]


def _mean(values: Iterable[float | None]) -> float | None:
    known = _known(values)
    return statistics.fmean(known) if known else None


def _median(values: Iterable[float | None]) -> float | None:
    known = _known(values)
    return statistics.median(known) if known else None


def _collection_table(entries: list[Row]) -> str:
    moved = any(entry["moved"] for entry in entries)
    header = [
        "set",
        "method",
        "pairs",
        "failed",
        *_HEADS,
        "s (median)",
        "CPU s (median)",
        "ratio (median)",
        "peak MB (max)",
    ]
    lines = []
    for entry in entries:
        name = entry["collection"] + (", moved" if entry["moved"] else "")
        cells = [name, entry["method"], str(entry["pairs"]), str(entry["failed"]), *_measure_cells(entry)]
        cells += [_number(entry[name], 1) for name in ("seconds", "cpu_seconds", "ratio")]
        cells.append(_number(entry["peak_mb"], 0))
        if moved:
            cells.append(_number(entry.get("largest_change"), 2))
        lines.append(cells)
    return _table([*header, "error changed by at most"] if moved else header, lines)


def _pair_table(rows: list[Row]) -> str:
    header = ["pair", "method", "motion", "vertices", *_HEADS, "s", "CPU s", "ratio", "peak MB"]
    lines = []
    for row in rows:
        sizes = f"{row['source_vertices']}, {row['target_vertices']}" if "source_vertices" in row else "-"
        cells = [row["id"], row["method"], str(row["rotation"]), sizes]
        cells += _measure_cells(row) if row["status"] == "ok" else ["failed", "0", "-", "-"]
        cells += [_number(row.get("seconds"), 2), _number(row.get("cpu_seconds"), 2)]
        cells += [_number(row.get("ratio"), 1), _number(row.get("peak_mb"), 0)]
        lines.append(cells)
    return _table(header, lines)


def _stage_table(rows: list[Row]) -> str:
    names = list(dict.fromkeys(name for row in rows for name in row["stages"]))
    lines = [
        [row["id"], str(row["rotation"]), *(_number(row["stages"].get(name), 2) for name in names),
         _number(row["seconds"], 2), _number(row.get("cost_unit_seconds"), 3)]
        for row in rows
    ]  # fmt: skip
    return _table(["pair", "motion", *names, "whole", "cost unit"], lines)


_SHARES = ("coverage", "false_matches", "overlap_iou")
_HEADS = ("error", "coverage %", "false %", "IoU %")


def _measure_cells(values: Row) -> list[str]:
    return [_number(values.get("error"), 2), *(_number(values.get(name), 1, 100.0) for name in _SHARES)]


def _number(value: float | None, digits: int, factor: float = 1.0) -> str:
    return "-" if value is None else f"{factor * value:.{digits}f}"


def _table(header: list[str], lines: list[list[str]]) -> str:
    widths = [max(len(row[k]) for row in [header, *lines]) for k in range(len(header))]
    padded = [
        " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in [header, *lines]
    ]
    rule = "|".join("-" * (width + 2) for width in widths)
    return "\n".join([f"| {padded[0]} |", f"|{rule}|", *(f"| {row} |" for row in padded[1:])])


def _line(row: Row) -> str:
    name = f"{row['id']:<40} {row['method']:<12} {row['rotation']}"
    if row["status"] != "ok":
        return f"{name}  failed: {row['reason']}"
    cells = zip(("error", "coverage", "false", "IoU"), _measure_cells(row), strict=True)
    measures = "  ".join(f"{head} {cell:>5}" for head, cell in cells)
    return f"{name}  {measures}  {row['seconds']:7.2f} s  ratio {_number(row.get('ratio'), 1)}  {row['peak_mb']:.0f} MB"


def _replace(path: Path, text: str) -> None:
    part = path.with_suffix(path.suffix + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
