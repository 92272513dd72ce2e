# SPDX-License-Identifier: GPL-3.0-or-later
"""Known pairs of points from elsewhere (clicked, image features), as arrays or as a JSON file."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft.arguments import to_array, to_indices, to_points
from isograft.errors import InvalidInput

#: More is no list of landmarks that a person or a feature detector made.
_LARGEST_FILE = 10_000_000
#: A position farther from every vertex than this share of the bounding box's diagonal is on another surface.
_FARTHEST = 0.05
_SIDES = ("source", "target")


@dataclass(frozen=True, eq=False)
class Landmarks:
    """Checked pairs of a source and a target vertex, (k, 2), and their weights in (0, 1]."""

    pairs: npt.NDArray[np.int32]
    weights: npt.NDArray[np.float64]


def to_landmarks(
    landmarks: Any, source_vertices: npt.NDArray[np.float64], target_vertices: npt.NDArray[np.float64]
) -> Landmarks:
    """Check landmarks as match() takes them, and put those given by position on the nearest vertex.

    Accepted: None; pairs of vertex indices, (k, 2); pairs of positions, (k, 2, 3); or a mapping with "source" and
    "target", each k vertex indices or (k, 3) positions, and perhaps "weight", k numbers in (0, 1].
    """
    if landmarks is None or (isinstance(landmarks, (list, tuple)) and len(landmarks) == 0):
        return Landmarks(np.empty((0, 2), np.int32), np.empty(0))
    if isinstance(landmarks, Mapping):
        sides, weights = _from_mapping(landmarks)
    else:
        array = to_array(landmarks, "landmarks")
        if array.ndim == 3 and array.shape[1:] == (2, 3):
            sides = [to_points(array[:, k], "landmarks") for k in range(2)]
        else:
            pairs = to_indices(landmarks, "landmarks", 2)
            sides = [pairs[:, 0], pairs[:, 1]]
        weights = np.ones(len(sides[0]))
    meshes = (source_vertices, target_vertices)
    columns = [_indices(*each) for each in zip(sides, _SIDES, meshes, strict=True)]
    return Landmarks(np.column_stack(columns).astype(np.int32), weights)


def read_landmarks(path: str | os.PathLike[str]) -> Any:
    """Read a JSON file of landmarks, for match().

    The file holds a list of pairs [source, target] or [source, target, weight], or an object with the lists "source",
    "target" and perhaps "weight". A point is a vertex index or a position [x, y, z]; either one for all of a side.
    Raises InvalidInput for anything else, naming the file and the entry.
    """
    value = _parsed(path)
    if isinstance(value, list):
        value = _lists_of(path, value)
    elif not isinstance(value, dict):
        raise InvalidInput(f'{path}: must be a list of pairs, or an object with the lists "source" and "target"')
    if not set(_SIDES) <= set(value) <= {*_SIDES, "weight"}:
        raise InvalidInput(f'{path}: there must be two lists, "source" and "target", and perhaps "weight"')
    for key, entries in value.items():
        if not isinstance(entries, list):
            raise InvalidInput(f'{path}: "{key}" must be a list of {"weights" if key == "weight" else "vertices"}')
        for i, entry in enumerate(entries):
            _check_entry(key, entry, f'{path}: "{key}" entry {i}')
    counts = [len(value[key]) for key in _SIDES]
    if counts[0] != counts[1]:
        raise InvalidInput(
            f"{path}: landmarks come in pairs, but there are {counts[0]} of the source and {counts[1]} of the target"
        )
    if len(value.get("weight", value["source"])) != counts[0]:
        raise InvalidInput(f"{path}: there are {counts[0]} landmarks and {len(value['weight'])} weights")
    for key in _SIDES:
        kinds = {isinstance(entry, list) for entry in value[key]}
        if len(kinds) > 1:
            raise InvalidInput(f'{path}: "{key}" mixes vertex indices and positions; give one kind')
    return value


def _parsed(path: str | os.PathLike[str]) -> Any:
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InvalidInput(f"{path}: {error.strerror or error}") from None
    if len(data) > _LARGEST_FILE:
        raise InvalidInput(f"{path}: {len(data)} bytes are more than a list of landmarks may have")
    try:
        value = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{path}: not JSON: {error}") from None
    return value


def _lists_of(path: Any, entries: list[Any]) -> dict[str, list[Any]]:
    result: dict[str, list[Any]] = {"source": [], "target": [], "weight": []}
    for i, entry in enumerate(entries):
        if not isinstance(entry, list) or len(entry) not in (2, 3):
            raise InvalidInput(f"{path}: entry {i} must be a pair [source vertex, target vertex], or with a weight")
        for key, part in zip(("source", "target", "weight"), [*entry, 1.0][:3], strict=True):
            _check_entry(key, part, f"{path}: entry {i}")
            result[key].append(part)
    return result


def _check_entry(key: str, entry: Any, where: str) -> None:
    number = isinstance(entry, (int, float)) and not isinstance(entry, bool)
    if key == "weight":
        if not number or not 0.0 < entry <= 1.0:
            raise InvalidInput(f"{where}: {json.dumps(entry)[:40]} is no weight in (0, 1]")
    elif isinstance(entry, list):
        numbers = all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in entry)
        if len(entry) != 3 or not numbers or not all(abs(x) < 1e300 for x in entry):
            raise InvalidInput(f"{where}: {json.dumps(entry)[:40]} is no position [x, y, z]")
    elif not number or not isinstance(entry, int) or not 0 <= entry < 2**31:
        raise InvalidInput(f"{where}: {json.dumps(entry)[:40]} is no vertex index")


def _from_mapping(landmarks: Mapping[str, Any]) -> tuple[list[npt.NDArray[Any]], npt.NDArray[np.float64]]:
    if not set(_SIDES) <= set(landmarks) <= {*_SIDES, "weight"}:
        raise InvalidInput(
            'landmarks must have the keys "source" and "target", and perhaps "weight", not '
            f"{sorted(map(str, landmarks))}"
        )
    sides: list[npt.NDArray[Any]] = []
    for side in _SIDES:
        array = to_array(landmarks[side], f"landmarks of the {side}")
        if array.shape == (0,):  # an empty list has no dtype of its own
            array = array.astype(np.int32)
        if array.ndim == 2 and array.shape[1] == 3:
            sides.append(to_points(array, f"landmarks of the {side}"))
        elif array.ndim == 1:
            sides.append(to_indices(array.reshape(-1, 1), f"landmarks of the {side}", 1)[:, 0])
        else:
            raise InvalidInput(
                f"landmarks of the {side} must be a list of vertex indices or of positions, not shape {array.shape}"
            )
    if len(sides[0]) != len(sides[1]):
        raise InvalidInput(
            f"landmarks come in pairs, but there are {len(sides[0])} of the source and {len(sides[1])} of the target"
        )
    weights = np.ones(len(sides[0]))
    if "weight" in landmarks:
        weights = to_array(landmarks["weight"], "landmark weights").astype(np.float64)
        if weights.shape != (len(sides[0]),):
            raise InvalidInput(f"there are {len(sides[0])} landmarks, but weights of shape {weights.shape}")
        bad = np.flatnonzero(~((weights > 0.0) & (weights <= 1.0)))
        if bad.size:
            raise InvalidInput(f"landmark {bad[0]}: its weight must be in (0, 1], not {weights[bad[0]]}")
    return sides, weights


def _indices(points: npt.NDArray[Any], side: str, vertices: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    if points.ndim == 2:
        indices = _nearest(points, side, vertices)
    else:
        indices = points.astype(np.int64)
        bad = np.flatnonzero((indices < 0) | (indices >= len(vertices)))
        if bad.size:
            raise InvalidInput(
                f"landmark {bad[0]}: {side} vertex {indices[bad[0]]} does not exist; the {side} has {len(vertices)} "
                f"vertices ({bad.size} such landmarks)"
            )
    _, first, counts = np.unique(indices, return_index=True, return_counts=True)
    if (counts > 1).any():
        vertex = int(indices[first[np.flatnonzero(counts > 1)[0]]])
        rows = np.flatnonzero(indices == vertex).tolist()
        raise InvalidInput(f"landmarks {rows} name the same {side} vertex {vertex}; give every vertex once")
    return indices


def _nearest(points: npt.NDArray[Any], side: str, vertices: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if bad.size:
        raise InvalidInput(f"landmark {bad[0]}: its {side} position {points[bad[0]].tolist()} is not finite")
    diagonal = float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0))) if len(vertices) else 0.0
    indices = np.empty(len(points), np.int64)
    for i, point in enumerate(points):
        squared = np.einsum("ij,ij->i", vertices - point, vertices - point)
        indices[i] = int(np.argmin(squared))
        distance = float(np.sqrt(squared[indices[i]]))
        if distance > _FARTHEST * diagonal:
            raise InvalidInput(
                f"landmark {i}: its {side} position {point.tolist()} is {distance:.4g} away from the nearest vertex, "
                f"more than {100 * _FARTHEST:.0f} % of the {side}'s size ({diagonal:.4g}); give it in the {side}'s "
                "own units and place"
            )
    return indices
