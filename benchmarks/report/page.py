# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/accuracy.md: the tables, the curves, the worst pairs and why they fail."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from benchmarks.children import Row
from benchmarks.levels import SETS, judged, motions, set_of, summed
from benchmarks.reliability import RIGHT_ERROR
from benchmarks.report.worst import share_right
from benchmarks.tables import (
    level_table,
    measure_cells,
    motion_table,
    number,
    pair_table,
    reliability_tables,
    table,
)

_INTRO = """# Accuracy

Made by `scripts/accuracy_report` from runs of `scripts/benchmark` over pairs of surfaces whose true correspondence is
known: {runs}. Everything is the default: no landmarks, no training, the same settings for every pair.

- *Error*: geodesic distance on the target between a vertex's image and its true image, over the root of the target's
  area, times 100; mean over a seeded sample of the matched vertices that have a truth, then over the pairs of a set.
- *Coverage*: matched share of the vertices that have a truth. A pair that fails counts with coverage 0.
- *False*: share of the matched vertices with an error over 10.
- *IoU*: matched set against the set that has a counterpart, where the truth says which vertices have none.

The truth has noise of its own: about 0.9 on faust_remeshed and pfaust, 0.7 on tosca_remeshed, 0.5 on topo, 0.15 on
scape. Better than that cannot be measured here."""

_CURVES = """Share of all vertices with a truth whose error is at most that on the axis. Unmatched ones never count, so
that a curve ends at the coverage. In brackets: pairs."""

_PEERS = """On the pairs of at most 15,000 vertices: the nearest point in space (what Blender's Data Transfer does;
positions as in the files) and functional maps with ZoomOut (pyFM). Neither leaves anything unmatched."""

_WORST = """The pairs with the smallest share of vertices that are right (matched, with an error below {right:g}). Each
picture shows, from two sides: the target, coloured by position; the source in its true colours; the source in the
colours that the map brings; and the error, from blue (none) over yellow (5) to dark red (30 and more). Grey: unmatched,
or in the second place without a known truth. Violet: matched, though it has no counterpart."""


def write_page(
    path: Path, results: dict[str, Any], worst: list[tuple[Row, str, Path | None]], pictures: dict[str, Path]
) -> None:
    """`worst` has row, reason and picture; `pictures` what curves.py drew: "curves", "reliability" or neither."""
    rows: list[Row] = results["rows"]
    parts = [_INTRO.format(runs=_counts(rows)), "## Levels\n\n" + level_table(judged(rows))]
    turned = motion_table(motions(rows))
    if turned:
        parts.append("## Moved and turned at random\n\nEither shape, each on its own.\n\n" + turned)
    if "curves" in pictures:
        image = _image("Cumulative error curves, set by set", pictures["curves"], path)
        parts.append(f"## Cumulative errors\n\n{_CURVES}\n\n{image}")
    peers = peer_table(rows)
    if peers:
        parts.append(f"## Against other methods\n\n{_PEERS}\n\n{peers}")
    confidence = reliability_tables(results["reliability"])
    if confidence:
        picture = _image("Share right over confidence", pictures["reliability"], path)
        parts.append(f"## Confidence\n\n{confidence}\n\n{picture}".rstrip())
    if worst:
        parts.append(_worst_part(worst, path))
    ours = [row for row in rows if row["method"] == "isograft" and row["rotation"] == 0]
    parts.append(
        "## Every pair\n\nSeconds are those of a run with "
        f"{_among('threads', ours)} thread(s) a pair and {_among('jobs', ours)} pair(s) at once.\n\n" + pair_table(ours)
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def peer_table(rows: list[Row]) -> str:
    """Every method on the pairs that all of them were run on."""
    still = [row for row in rows if row["rotation"] == 0 and not row["reverse"]]
    methods = list(dict.fromkeys(row["method"] for row in still))
    if len(methods) < 2:
        return ""
    lines = []
    for pair_set in SETS:
        chosen = [row for row in still if pair_set.has(row)]
        common = set.intersection(*({row["id"] for row in chosen if row["method"] == m} for m in methods))
        for method in methods:
            same = [row for row in chosen if row["method"] == method and row["id"] in common]
            if same:
                values = summed(same)
                lines.append([pair_set.name, method, str(len(same)), str(values["failed"]), *measure_cells(values)])
    header = ["set", "method", "pairs", "failed", "error", "coverage %", "false %", "IoU %"]
    return table(header, lines) if lines else ""


def read_reasons(path: Path) -> dict[str, str]:
    """Lines `pair: why it fails`; empty ones and those from # on are passed over."""
    reasons = {}
    for number_, line in enumerate(path.read_text(encoding="utf-8").splitlines() if path.is_file() else [], 1):
        if not line.strip() or line.startswith("#"):
            continue
        name, colon, reason = line.partition(":")
        if not colon or not reason.strip():
            raise SystemExit(f"{path}, line {number_}: write PAIR: REASON")
        reasons[name.strip()] = reason.strip()
    return reasons


def _worst_part(worst: list[tuple[Row, str, Path | None]], path: Path) -> str:
    parts = [f"## The {_words(len(worst))} worst pairs\n\n{_WORST.format(right=RIGHT_ERROR)}"]
    for place, (row, reason, picture) in enumerate(worst, 1):
        pair_set = set_of(row)
        where = "" if pair_set is None else f" ({pair_set.name})"
        if row["status"] == "ok":
            error, coverage, false, overlap = measure_cells(row)
            measures = f"Error {error} at {coverage} %, false {false} %"
            measures += "" if overlap == "-" else f", IoU {overlap} %"
        else:
            measures = f"Failed: {row['reason']}"
        right = number(share_right(row), 1, 100.0)
        lines = [f"### {place}. {row['id']}{where}\n\n{measures}; right {right} %. {reason}"]
        if picture is not None:
            lines.append(_image(f"{row['id']}: target, source in true colours, as matched, error", picture, path))
        parts.append("\n\n".join(lines))
    return "\n\n".join(parts)


def _image(words: str, picture: Path, page: Path) -> str:
    return f"![{words}]({picture.resolve().relative_to(page.resolve().parent).as_posix()})"


def _counts(rows: list[Row]) -> str:
    ours = [row for row in rows if row["method"] == "isograft"]
    counts = {
        "pairs": sum(row["rotation"] == 0 and not row["reverse"] for row in ours),
        "pairs reversed": sum(row["rotation"] == 0 and row["reverse"] for row in ours),
        "runs with both shapes moved and turned": sum(row["rotation"] > 0 for row in ours),
        "runs of other methods": len(rows) - len(ours),
    }
    return ", ".join(f"{count} {words}" for words, count in counts.items() if count)


def _among(name: str, rows: Iterable[Row]) -> str:
    values = sorted({row[name] or "all" for row in rows}, key=str)
    return " or ".join(map(str, values)) or "-"


def _words(count: int) -> str:
    return {10: "ten"}.get(count, str(count))
