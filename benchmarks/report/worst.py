# SPDX-License-Identifier: GPL-3.0-or-later
"""The worst pairs: which they are, and what a picture of each has to show."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
from isograft.evaluation import evaluate

from benchmarks.cases import Case, Shape, true_images
from benchmarks.children import Row
from benchmarks.levels import set_of
from benchmarks.reliability import RIGHT_ERROR

Floats = npt.NDArray[np.float64]

UNMATCHED = np.array([0.55, 0.55, 0.55])
#: Matched, though it has no counterpart.
INVENTED = np.array([0.55, 0.25, 0.75])
#: Errors and their colours.
HEAT_AT = np.array([0.0, 2.5, 5.0, 10.0, 30.0])
HEAT = np.array([[0.10, 0.45, 0.75], [0.30, 0.75, 0.70], [0.97, 0.90, 0.35], [0.93, 0.45, 0.15], [0.60, 0.05, 0.10]])
#: What points upward in the files of a collection, where it is not y.
UP = {
    **dict.fromkeys(("tosca", "tosca_remeshed", "kids", "big", "shrec16"), (0.0, 0.0, 1.0)),
    "scape": (1.0, 0.0, 0.0),
}
TITLES = ("target", "source, true colours", "source as matched", "error")


def share_right(row: Row) -> float:
    """Of the vertices with a truth; an unmatched one is not right, nor is any of a failed pair."""
    errors = row.get("sample_errors") or []
    return float(row["coverage"]) * float(np.mean(np.asarray(errors) < RIGHT_ERROR)) if errors else 0.0


def worst_pairs(rows: Iterable[Row], count: int = 10) -> list[Row]:
    """Unmoved pairs of the sets that a level is asked of, the smallest share right first."""
    chosen = []
    for row in rows:
        pair_set = set_of(row)
        ours = row["method"] == "isograft" and row["rotation"] == 0 and not row["reverse"]
        if ours and pair_set is not None and pair_set.must is not None:
            chosen.append(row)
    return sorted(chosen, key=lambda row: (share_right(row), row["id"]))[:count]


def scene_of(
    case: Case, found: Any, up: npt.ArrayLike = (0.0, 1.0, 0.0), samples: int = 1000
) -> dict[str, npt.NDArray[Any]]:
    """Arrays for blender_pictures.py: the target and the source turned to the viewer, and the colours of each panel.

    Args:
        found: face, barycentric and points of the map, or None where there is none: everything is grey.
        up: what points upward in the target's file.
        samples: vertices whose error is measured; the others show that of the nearest of these.
    """
    assert case.truth is not None
    target, target_faces = case.target
    source, source_faces = case.source
    turn = _upright(target, np.asarray(up, float))
    images = true_images(case.truth, case.target)
    known = case.truth.known
    scale, rotation = _similarity(source[known], images[known])
    low, size = target.min(axis=0), np.maximum(np.ptp(target, axis=0), 1e-12)
    by_position = 0.12 + 0.83 * (target - low) / size
    truly = 0.12 + 0.83 * np.clip((images - low) / size, 0.0, 1.0)
    truly[~known] = UNMATCHED
    if not case.unmatched_is_truth and not known.all():
        # Not annotated is not without counterpart: as the nearest vertex that is.
        rows = np.flatnonzero(~known)
        nearest, distance = _nearest(source[rows], source[known])
        close = distance < 3.0 * _edge(case.source)
        truly[rows[close]] = truly[np.flatnonzero(known)[nearest[close]]]
    matched_colours, heat = _panels(case, found, by_position, samples)
    return {
        "target": (target - target.mean(axis=0)) @ turn.T,
        "target_faces": _faces(target_faces),
        "source": scale * (source - source.mean(axis=0)) @ rotation.T @ turn.T,
        "source_faces": _faces(source_faces),
        "target_colour": by_position,
        "true_colour": truly,
        "matched_colour": matched_colours,
        "error_colour": heat,
    }


def _panels(case: Case, found: Any, by_position: Floats, samples: int) -> tuple[Floats, Floats]:
    """Colours of the source as matched, and of its errors."""
    count = len(case.source[0])
    matched_colours, heat = np.tile(UNMATCHED, (count, 1)), np.tile(UNMATCHED, (count, 1))
    if found is None or case.truth is None:
        return matched_colours, heat
    matched = np.isfinite(found.points).all(axis=1)
    faces = case.target[1]
    if faces is not None:
        corners = faces[np.maximum(found.face, 0)]
        weights = np.nan_to_num(found.barycentric)
        matched_colours[matched] = np.einsum("ij,ijk->ik", weights, by_position[corners])[matched]
    else:
        matched_colours[matched] = by_position[_nearest(found.points[matched], case.target[0])[0]]
    if (matched & case.truth.known).any():
        measured = evaluate(found, case.truth, case.target, samples=samples)
        nearest = _nearest(case.source[0], case.source[0][measured.sample])[0]
        heat[matched] = heat_colour(measured.sample_errors[nearest])[matched]
    if case.unmatched_is_truth:
        heat[matched & ~case.truth.known] = INVENTED
    return matched_colours, heat


def heat_colour(errors: npt.ArrayLike) -> Floats:
    """(n, 3) colours of errors."""
    return np.stack([np.interp(np.asarray(errors, float), HEAT_AT, HEAT[:, k]) for k in range(3)], axis=-1)


def load_map(path: Path) -> Any:
    """What child.save_map() kept."""
    with np.load(path) as arrays:
        weights = arrays["barycentric"].astype(float)
        weights /= np.where(np.isfinite(weights), weights, 1.0).sum(axis=1, keepdims=True)
        return SimpleNamespace(face=arrays["face"], barycentric=weights, points=arrays["points"].astype(float))


def _upright(points: Floats, up: Floats) -> Floats:
    """Rotation that turns `up` to z, and the flattest side to the viewer (y)."""
    level = points - points.mean(axis=0)
    level = level - np.outer(level @ up, up)
    _, _, axes = np.linalg.svd(level, full_matrices=False)
    right = axes[0]
    return np.stack([right, np.cross(up, right), up])


def _similarity(points: Floats, images: Floats) -> tuple[float, Floats]:
    """Scale and rotation that lay `points` best onto `images`."""
    a, b = points - points.mean(axis=0), images - images.mean(axis=0)
    u, _, vt = np.linalg.svd(b.T @ a)
    flip = np.diag([1.0, 1.0, np.sign(np.linalg.det(u @ vt))])
    rotation = u @ flip @ vt
    square = float((a * a).sum())
    # Of sizes, not of the fit: what bends does not shrink.
    return (float(np.sqrt((b * b).sum() / square)) if square > 0.0 else 1.0), rotation


def _nearest(points: Floats, candidates: Floats, chunk: int = 4_000_000) -> tuple[npt.NDArray[np.int64], Floats]:
    """Index of the nearest candidate of every point, and its distance."""
    index = np.zeros(len(points), np.int64)
    square = np.full(len(points), np.inf)
    step = max(1, chunk // max(len(candidates), 1))
    norms = np.einsum("ij,ij->i", candidates, candidates)
    for start in range(0, len(points), step):
        block = points[start : start + step]
        distances = norms - 2.0 * block @ candidates.T
        index[start : start + step] = np.argmin(distances, axis=1)
        offset = block - candidates[index[start : start + step]]
        square[start : start + step] = np.einsum("ij,ij->i", offset, offset)
    return index, np.sqrt(square)


def _edge(shape: Shape) -> float:
    vertices, faces = shape
    if faces is None:
        return 0.0
    corners = vertices[faces]
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())


def _faces(faces: npt.NDArray[np.int32] | None) -> npt.NDArray[np.int32]:
    return np.empty((0, 3), np.int32) if faces is None else faces
