# SPDX-License-Identifier: GPL-3.0-or-later
"""What rows sum up to, collection by collection, for every method."""

from __future__ import annotations

import statistics
from collections.abc import Iterable

from benchmarks.children import Row
from benchmarks.levels import summed


def summarise(rows: Iterable[Row]) -> list[Row]:
    """One entry per collection, method, and moved or not; then one over all pairs."""
    rows = list(rows)
    unmoved = {(row["id"], row["method"], row["reverse"]): row for row in rows if row["rotation"] == 0}
    ours = {(name, reverse): row for (name, method, reverse), row in unmoved.items() if method == "isograft"}
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
                    if method != "isograft":
                        entry["times_isograft"] = _times(chosen, ours)
                    if moved:
                        entry["largest_change"] = _largest_change(chosen, unmoved)
                    entries.append(entry)
    return entries


def _label(row: Row) -> str:
    """The collection; its partial and non-isometric pairs apart, since other levels are asked of them."""
    category = str(row["category"])
    apart = category.startswith("partial") or category == "non-isometric"
    label = f"{row['collection']} {category}" if apart else str(row["collection"])
    return f"{label}, reversed" if row["reverse"] else label


def _summed(rows: list[Row]) -> Row:
    measured = [row for row in rows if row["has_truth"]]
    return {
        **summed(measured),
        "pairs": len(rows),
        "failed": sum(row["status"] != "ok" for row in rows),
        "measured": len(measured),
        "seconds": _median(row.get("seconds") for row in rows),
        "cpu_seconds": _median(row.get("cpu_seconds") for row in rows),
        "ratio": _median(row.get("ratio") for row in rows),
        "peak_mb": max((row["peak_mb"] for row in rows if row.get("peak_mb") is not None), default=None),
    }


def _times(peer: list[Row], ours: dict[tuple[str, bool], Row]) -> float | None:
    """Seconds of a peer over isograft's on the same pair: the median over the pairs that both have run."""
    seconds = ((row.get("seconds"), ours.get((row["id"], row["reverse"]), {}).get("seconds")) for row in peer)
    return _median(theirs / own for theirs, own in seconds if theirs is not None and own)


def _largest_change(moved: list[Row], unmoved: dict[tuple[str, str, bool], Row]) -> float | None:
    """Of the error, by moving a pair's shapes; over the pairs measured both ways."""
    changes = []
    for row in moved:
        still = unmoved.get((row["id"], row["method"], row["reverse"]), {})
        if row.get("error") is not None and still.get("error") is not None:
            changes.append(abs(row["error"] - still["error"]))
    return max(changes, default=None)


def _median(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return statistics.median(known) if known else None
