# SPDX-License-Identifier: GPL-3.0-or-later
"""Cumulative error curves, set by set, and how confidence and correctness go together."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import numpy.typing as npt

mpl.use("Agg")
from matplotlib import pyplot as plt

from benchmarks.children import Row
from benchmarks.levels import SETS

Floats = npt.NDArray[np.float64]

#: Errors at which the curves are told.
GRID = np.linspace(0.0, 20.0, 201)
_STYLE = {
    "isograft": ("Isograft", "#0b6e4f", 2.0),
    "pyfm-zoomout": ("pyFM with ZoomOut", "#c26a00", 1.3),
    "nearest": ("nearest point in space", "#7a7a7a", 1.3),
}


def cumulative(row: Row, grid: Floats = GRID) -> Floats:
    """Share of the vertices with a truth whose error is at most each of `grid`; an unmatched one never is."""
    errors = np.sort(np.asarray(row.get("sample_errors") or [], float))
    if not len(errors):
        return np.zeros(len(grid))
    return np.asarray(row["coverage"] * np.searchsorted(errors, grid, side="right") / len(errors))


def mean_curve(rows: list[Row], grid: Floats = GRID) -> Floats:
    """Every pair counts alike; a failed one counts as matched nowhere."""
    return np.asarray(np.mean([cumulative(row, grid) for row in rows], axis=0))


def draw_curves(rows: Iterable[Row], path: Path) -> bool:
    """One panel per set; False if there is nothing to draw."""
    still = [row for row in rows if row["rotation"] == 0]
    panels = []
    for pair_set in SETS:
        chosen = [row for row in still if pair_set.has(row)]
        if any(row["method"] == "isograft" for row in chosen):
            panels.append((pair_set.name, chosen))
    if not panels:
        return False
    columns = min(4, len(panels))
    lines = -(-len(panels) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(3.1 * columns, 2.5 * lines + 0.6), squeeze=False)
    for axis in axes.ravel()[len(panels) :]:
        axis.set_visible(False)
    handles: dict[str, Any] = {}
    for axis, (name, chosen) in zip(axes.ravel(), panels, strict=False):
        _panel(axis, name, chosen, handles)
    figure.supxlabel("error at most", fontsize=9)
    figure.supylabel("share of the vertices with a truth, %", fontsize=9)
    figure.legend(handles.values(), handles.keys(), loc="upper center", ncols=4, fontsize=9, frameon=False)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 - 0.35 / figure.get_figheight()))
    _save(figure, path)
    return True


def _panel(axis: Any, name: str, rows: list[Row], handles: dict[str, Any]) -> None:
    ours = [row for row in rows if row["method"] == "isograft"]
    for method, (words, colour, width) in _STYLE.items():
        chosen = [row for row in rows if row["method"] == method]
        if not chosen:
            continue
        if method != "isograft" and len(chosen) < len(ours):
            # The peers were run on the smaller pairs: what Isograft does on the same.
            names = {row["id"] for row in chosen}
            same = mean_curve([row for row in ours if row["id"] in names])
            (handles["Isograft, the peers' pairs only"],) = axis.plot(
                GRID, 100.0 * same, "--", color=_STYLE["isograft"][1], linewidth=1.0
            )
        (handles[words],) = axis.plot(GRID, 100.0 * mean_curve(chosen), color=colour, linewidth=width)
    axis.set_title(f"{name} ({len(ours)})", fontsize=8)
    axis.set_xlim(0.0, GRID[-1])
    axis.set_ylim(0.0, 101.0)
    axis.grid(alpha=0.3)
    axis.tick_params(labelsize=7)


def draw_reliability(entry: Row, path: Path) -> None:
    """Share right over confidence, with the counts below; the diagonal is what should be."""
    bins = [b for b in entry["bins"] if b["count"]]
    figure, (axis, counts) = plt.subplots(
        2, 1, figsize=(4.2, 4.6), sharex=True, gridspec_kw={"height_ratios": [3, 1], "hspace": 0.08}
    )
    axis.plot([0, 1], [0, 1], color="#999999", linewidth=1.0)
    axis.plot([b["confidence"] for b in bins], [b["right"] for b in bins], "o-", color=_STYLE["isograft"][1])
    axis.set_ylabel("share right (error below 5)", fontsize=9)
    axis.set_ylim(0.0, 1.02)
    axis.grid(alpha=0.3)
    axis.set_title(f"expected calibration error {entry['calibration_error']:.3f}", fontsize=9)
    counts.bar([(b["low"] + b["high"]) / 2 for b in bins], [b["count"] for b in bins], 0.09, color="#8fb8a8")
    counts.set_xlim(0.0, 1.0)
    counts.set_xlabel("confidence", fontsize=9)
    counts.set_ylabel("vertices", fontsize=9)
    for part in (axis, counts):
        part.tick_params(labelsize=8)
    _save(figure, path)


def _save(figure: Any, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110, metadata={"Software": None})
    plt.close(figure)
