# SPDX-License-Identifier: GPL-3.0-or-later
"""The sets of pairs that a level is asked of: what must be reached, and what is aimed at."""

from __future__ import annotations

import statistics
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from benchmarks.children import Row

#: By how much the error of a pair may change when its shapes are turned.
MOTION_TOLERANCE = 0.2


@dataclass(frozen=True)
class Level:
    """Error at most, coverage, overlap and share of false matches; None where nothing is asked."""

    error: float | None = None
    coverage: float | None = None
    overlap_iou: float | None = None
    false_matches: float | None = None

    def reached(self, values: Row) -> bool | None:
        """Whether `values` are at least as good in all that is asked; None if there is nothing to judge."""
        if not values["pairs"]:
            return None
        better = []
        for name, wanted in vars(self).items():
            if wanted is None:
                continue
            found = values[name]
            lower = name in ("error", "false_matches")
            better.append(found is not None and (found <= wanted if lower else found >= wanted))
        return all(better)

    def __str__(self) -> str:
        parts = [] if self.error is None else [f"{self.error:g}"]
        if self.coverage is not None:
            parts.append(f"at {100 * self.coverage:g} %")
        if self.overlap_iou is not None:
            parts.append(f"IoU {100 * self.overlap_iou:g} %")
        if self.false_matches is not None:
            parts.append(f"false {100 * self.false_matches:g} %")
        return " ".join(parts)


@dataclass(frozen=True)
class PairSet:
    name: str
    must: Level | None
    aim: Level | None
    collections: tuple[str, ...]
    #: None takes every category but those that a set of their own has.
    categories: tuple[str, ...] | None = None
    #: Of a pair's name.
    prefix: str = ""
    #: Target to source.
    reverse: bool = False
    #: Whole shapes without contacts: fewer false matches are allowed.
    full: bool = True

    def has(self, row: Row) -> bool:
        categories = self.categories
        return (
            row["collection"] in self.collections
            and (row["category"] in categories if categories else row["category"] != "non-isometric")
            and str(row["id"]).startswith(self.prefix)
            and row["reverse"] == self.reverse
            and row["has_truth"]
        )


def _at(error: float, coverage: float) -> Level:
    return Level(error=error, coverage=coverage)


SETS = (
    PairSet("faust_remeshed, faust_reg", _at(2.2, 0.92), _at(1.3, 0.98), ("faust_remeshed", "faust_reg")),
    PairSet("scape", _at(2.8, 0.93), _at(1.4, 0.98), ("scape",)),
    PairSet("tosca (same class), kids, big, textured", _at(1.8, 0.92), _at(0.7, 0.98),
            ("tosca", "kids", "big", "textured")),
    PairSet("tosca_remeshed (same class)", _at(2.2, 0.90), _at(1.1, 0.97), ("tosca_remeshed",)),
    PairSet("shrec16 cuts", _at(3.5, 0.85), _at(1.5, 0.95), ("shrec16",), ("partial-cuts",), full=False),
    PairSet("shrec16 holes", _at(5.0, 0.80), _at(2.5, 0.92), ("shrec16",), ("partial-holes",), full=False),
    PairSet("shrec16 partial-partial", Level(error=6.0, overlap_iou=0.75), Level(error=3.0, overlap_iou=0.88),
            ("shrec16",), ("partial-partial",), full=False),
    PairSet("shrec16 cuts and holes, reversed", Level(overlap_iou=0.70), Level(overlap_iou=0.85), ("shrec16",),
            ("partial-cuts", "partial-holes"), reverse=True, full=False),
    PairSet("pfaust M", _at(3.0, 0.85), _at(1.6, 0.95), ("pfaust",), prefix="pfaustm", full=False),
    PairSet("pfaust H", _at(4.0, 0.85), _at(2.0, 0.95), ("pfaust",), prefix="pfausth", full=False),
    PairSet("topo (contacts)", _at(2.5, 0.90), _at(1.5, 0.97), ("topo",), full=False),
    PairSet("rangescan, scan (annotated)", _at(4.0, 0.75), _at(2.0, 0.90), ("rangescan", "scan"), full=False),
    PairSet("faces", _at(1.5, 0.90), _at(0.7, 0.98), ("faces",)),
    PairSet("anim (samba, animals)", _at(1.8, 0.92), _at(0.8, 0.98), ("anim",)),
    # No level is asked of these.
    PairSet("tosca_remeshed, non-isometric", None, None, ("tosca_remeshed",), ("non-isometric",)),
    PairSet("point clouds", None, None, ("pointcloud",), full=False),
)  # fmt: skip

_FALSE = (
    ("false matches: full shapes", True, Level(false_matches=0.05), Level(false_matches=0.01)),
    ("false matches: partial, contacts, scans", False, Level(false_matches=0.10), Level(false_matches=0.03)),
)


def mean(values: Iterable[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return statistics.fmean(known) if known else None


def summed(rows: list[Row]) -> Row:
    """Means over pairs. A failed pair has coverage and overlap 0; it has no error to enter the mean of errors."""
    return {
        "pairs": len(rows),
        "failed": sum(row["status"] != "ok" for row in rows),
        "error": mean(row.get("error") for row in rows),
        "coverage": mean(row.get("coverage", 0.0) for row in rows),
        "false_matches": mean(row.get("false_matches") for row in rows),
        "overlap_iou": mean(row.get("overlap_iou", 0.0) for row in rows if row["has_overlap"]),
    }


def judged(rows: Iterable[Row], method: str = "isograft") -> list[Row]:
    """One entry per set that was measured, in the order of SETS, then those of the false matches."""
    still = [row for row in rows if row["method"] == method and row["rotation"] == 0]
    entries = []
    for pair_set in SETS:
        chosen = [row for row in still if pair_set.has(row)]
        if chosen:
            entries.append(_entry(pair_set.name, summed(chosen), pair_set.must, pair_set.aim))
    for name, full, must, aim in _FALSE:
        sets = [s for s in SETS if s.full == full and s.must is not None and not s.reverse]
        chosen = [row for row in still if any(s.has(row) for s in sets)]
        if chosen:
            values = summed(chosen)
            only = {**dict.fromkeys(values), "pairs": values["pairs"], "failed": values["failed"]}
            entries.append(_entry(name, {**only, "false_matches": values["false_matches"]}, must, aim))
    return entries


def _entry(name: str, values: Row, must: Level | None, aim: Level | None) -> Row:
    result: Row = {"set": name, **values}
    for word, level in (("must", must), ("aim", aim)):
        result[word] = None if level is None else str(level)
        result[f"{word}_reached"] = None if level is None else level.reached(values)
    return result


def set_of(row: Row) -> PairSet | None:
    return next((pair_set for pair_set in SETS if pair_set.has(row)), None)


def motions(rows: Iterable[Row], method: str = "isograft") -> list[Row]:
    """Per set: how far a motion of the shapes changes the mean error, and the error and coverage of a pair at most."""
    chosen = [row for row in rows if row["method"] == method]
    still = {(row["id"], row["reverse"]): row for row in chosen if row["rotation"] == 0}
    entries = []
    for pair_set in SETS:
        pairs = [
            (still[row["id"], row["reverse"]], row)
            for row in chosen
            if row["rotation"] > 0 and pair_set.has(row) and (row["id"], row["reverse"]) in still
        ]
        if not pairs:
            continue
        both = [(a, b) for a, b in pairs if a.get("error") is not None and b.get("error") is not None]
        errors = [abs(a["error"] - b["error"]) for a, b in both]
        lost = sum((a.get("error") is None) != (b.get("error") is None) for a, b in pairs)
        change = None if not both else abs(_mean_error(both, 0) - _mean_error(both, 1))
        entries.append(
            {
                "set": pair_set.name,
                "runs": len(pairs),
                "mean_error_change": change,
                "largest_error_change": max(errors, default=None),
                "largest_coverage_change": max(abs(a.get("coverage", 0.0) - b.get("coverage", 0.0)) for a, b in pairs),
                # A pair that is matched in one position and not in the other is not equal.
                "lost": lost,
                "equal": lost == 0 and all(change <= MOTION_TOLERANCE for change in errors),
            }
        )
    return entries


def _mean_error(pairs: list[tuple[Row, Row]], side: int) -> float:
    return statistics.fmean(float(pair[side]["error"]) for pair in pairs)


def level_cells(entry: Row) -> list[Any]:
    """The words of a row of the table: must, reached, aim, reached."""
    words = {True: "yes", False: "no", None: "-"}
    cells: list[Any] = []
    for name in ("must", "aim"):
        cells += [entry[name] or "-", words[entry[f"{name}_reached"]]]
    return cells
