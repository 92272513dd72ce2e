# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the confidence means something: of the vertices with confidence c about a share c should be right."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from benchmarks.children import Row
from benchmarks.levels import SETS

#: A match with an error below this (times 100 over the root of the target's area) is right.
RIGHT_ERROR = 5.0
BINS = 10


def reliability(confidence: npt.ArrayLike, errors: npt.ArrayLike) -> Row:
    """Ten bins of equal width over the matched vertices that were measured, and the expected calibration error.

    The last bin holds 1. The expected calibration error is the mean over the vertices of the difference between the
    share right and the mean confidence in their bin.
    """
    c, right = np.asarray(confidence, float), np.asarray(errors, float) < RIGHT_ERROR
    index = np.clip((c * BINS).astype(int), 0, BINS - 1)
    counts = np.bincount(index, minlength=BINS)
    confidences = np.bincount(index, c, BINS)
    rights = np.bincount(index, right, BINS)
    bins = [
        {
            "low": k / BINS,
            "high": (k + 1) / BINS,
            "count": int(counts[k]),
            "confidence": float(confidences[k] / counts[k]) if counts[k] else None,
            "right": float(rights[k] / counts[k]) if counts[k] else None,
        }
        for k in range(BINS)
    ]
    total = int(counts.sum())
    return {
        "count": total,
        "confidence": float(c.mean()) if total else None,
        "right": float(right.mean()) if total else None,
        "calibration_error": float(np.abs(rights - confidences).sum() / total) if total else None,
        "bins": bins,
    }


def reliabilities(rows: Iterable[Row], method: str = "isograft") -> list[Row]:
    """One entry per set that a level is asked of, then one over all of them; every pair counts with its own sample."""
    measured = [
        row for row in rows if row["method"] == method and row["rotation"] == 0 and row.get("sample_confidence")
    ]
    entries, everything = [], []
    for pair_set in SETS:
        chosen = [row for row in measured if pair_set.has(row)]
        if chosen:
            entries.append({"set": pair_set.name, **_over(chosen)})
            everything += chosen if pair_set.must is not None else []
    if everything:
        entries.append({"set": "all", **_over(everything)})
    return entries


def _over(rows: list[Row]) -> Row:
    return reliability(
        np.concatenate([row["sample_confidence"] for row in rows]),
        np.concatenate([row["sample_errors"] for row in rows]),
    )
