# SPDX-License-Identifier: GPL-3.0-or-later
"""How right a correspondence is, where the truth is known: error, coverage, false matches, overlap."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from isograft.arguments import to_int, to_points
from isograft.errors import InvalidInput
from isograft.geodesics import geodesic_distances
from isograft.surface import Surface, as_surface
from isograft.truth import BoolArray, FloatArray, IntArray, Truth, as_truth, check_range, load_truth, positions

__all__ = ["Evaluation", "SurfacePoints", "Truth", "evaluate", "load_truth", "unfolded_distance"]

#: Errors above this (times 100 over the root of the target's area) are false matches.
FALSE_MATCH_ERROR = 10.0


class SurfacePoints(Protocol):
    """What evaluate() needs of a correspondence; isograft.Correspondence has it."""

    @property
    def face(self) -> npt.NDArray[np.int32]: ...
    @property
    def barycentric(self) -> FloatArray: ...
    @property
    def points(self) -> FloatArray: ...


@dataclass(frozen=True, eq=False)
class Evaluation:
    """The measures of one correspondence, always to be quoted together: a map may not buy error with silence."""

    #: Mean over the sample of distance / sqrt(target area) * 100; NaN if nothing was matched.
    error: float
    #: Matched share of the vertices that have a truth.
    coverage: float
    #: Share of the sample with an error over 10; NaN if nothing was matched.
    false_matches: float
    #: Matched set against the set with a truth, intersection over union; None unless "no truth" means "unmatched".
    overlap_iou: float | None
    #: Numbers of source vertices: all, with a truth, matched, both.
    vertices: int
    annotated: int
    matched: int
    matched_annotated: int
    #: Sampled vertices whose image and true image no path joins (pieces of a scan): the straight line was taken.
    disconnected: int
    #: (k,) source vertices whose error was measured, ascending.
    sample: IntArray
    #: (k,) their errors.
    sample_errors: FloatArray

    def to_dict(self) -> dict[str, float | int | None]:
        """The measures and counts, ready for JSON: NaN becomes None."""
        names = ("error", "coverage", "false_matches", "overlap_iou", "vertices", "annotated", "matched")
        values = {name: getattr(self, name) for name in (*names, "matched_annotated", "disconnected")}
        values["sampled"] = len(self.sample)
        return {key: None if isinstance(value, float) and np.isnan(value) else value for key, value in values.items()}


def evaluate(
    correspondence: SurfacePoints,
    truth: Any,
    target: Any,
    *,
    samples: int = 250,
    seed: int = 0,
    unmatched_is_truth: bool = False,
) -> Evaluation:
    """Measure a correspondence against the truth; n = number of source vertices.

    The error of a vertex is the geodesic distance on the target between its image and its true image, over the root
    of the target's area, times 100. Distances come from polar marching from the true point (within 1 %) and are
    unfolded into the image's triangle, so that errors below an edge length are right too. Where no path leads, the
    straight line counts. For point clouds: straight lines over the root of the product of the two largest extents.

    Args:
        correspondence: `face` (n,), -1 unmatched, and `barycentric` (n, 3); of a cloud target `points` (n, 3) alone.
        truth: a Truth, (n,) target vertices, or (triangles (n,), weights (n, 3)); -1 where none is known.
        target: a Surface, or a tuple (vertices, faces) with faces None for a point cloud.
        samples: how many of the matched vertices with a truth to measure (all if there are fewer).
        seed: of their choice.
        unmatched_is_truth: a truth of -1 says that the vertex has no counterpart, so that overlap_iou can be told.

    Raises:
        InvalidInput: arrays that do not fit each other or the target, or a truth that names no vertex.
    """
    count = to_int(samples, "samples", 1, 2**31 - 1)
    generator = np.random.default_rng(to_int(seed, "seed", 0, 2**64 - 1))
    vertices, faces, surface = _target_of(target)
    checked = as_truth(truth)
    check_range(checked, len(vertices), len(faces))
    matched = _matched(correspondence, len(checked), len(faces), is_cloud=surface is None)
    known = checked.known
    annotated = int(known.sum())
    if annotated == 0:
        raise InvalidInput("the truth names no counterpart for any vertex: there is nothing to measure")

    both = matched & known
    sample = np.flatnonzero(both)
    if len(sample) > count:
        sample = np.sort(generator.choice(sample, count, replace=False))
    images = np.asarray(correspondence.points, np.float64)[sample]
    if surface is None:
        true_points = positions(checked, sample, vertices, faces)
        distances = np.linalg.norm(images - true_points, axis=1)
        apart = 0
        length = _cloud_length(vertices)
    else:
        image_face = np.asarray(correspondence.face, np.int64)[sample]
        image_weights = np.asarray(correspondence.barycentric, np.float64)[sample]
        distances, apart = _geodesic_errors(surface, checked, sample, image_face, image_weights)
        length = np.sqrt(_area(vertices, faces))
    errors = distances / length * 100.0
    return Evaluation(
        error=float(errors.mean()) if len(errors) else float("nan"),
        coverage=int(both.sum()) / annotated,
        false_matches=float((errors > FALSE_MATCH_ERROR).mean()) if len(errors) else float("nan"),
        overlap_iou=int(both.sum()) / int((matched | known).sum()) if unmatched_is_truth else None,
        vertices=len(checked),
        annotated=annotated,
        matched=int(matched.sum()),
        matched_annotated=int(both.sum()),
        disconnected=apart,
        sample=sample,
        sample_errors=errors,
    )


def _target_of(target: Any) -> tuple[FloatArray, npt.NDArray[np.int32], Surface | None]:
    """Vertices, triangles, and the Surface; None for a cloud."""
    is_tuple = isinstance(target, (tuple, list)) and len(target) >= 1 and (len(target) == 1 or target[1] is None)
    if is_tuple or (isinstance(target, Surface) and target.is_cloud):
        # As points alone: building its surface would tell nothing more.
        vertices = target.vertices if isinstance(target, Surface) else to_points(target[0], "target: vertices")
        if len(vertices) == 0 or not np.isfinite(vertices).all():
            raise InvalidInput("target: a point cloud needs points with finite coordinates")
        return vertices, np.empty((0, 3), np.int32), None
    surface = as_surface(target, "target")
    return surface.vertices, surface.faces, surface


def _matched(correspondence: SurfacePoints, size: int, face_count: int, *, is_cloud: bool) -> BoolArray:
    face = np.asarray(correspondence.face)
    points = np.asarray(correspondence.points)
    weights = np.asarray(correspondence.barycentric)
    if len(face) != size:
        raise InvalidInput(f"the truth has {size} rows, but the correspondence has {len(face)}: one per source vertex")
    for name, array in (("points", points), ("barycentric", weights)):
        if array.shape != (size, 3):
            raise InvalidInput(f"correspondence: {name} must have shape ({size}, 3), not {array.shape}")
    if is_cloud:
        return np.asarray(np.isfinite(points).all(axis=1))
    matched = np.asarray(face >= 0)
    bad = np.flatnonzero(matched & ((face >= face_count) | ~np.isfinite(weights).all(axis=1)))
    if bad.size:
        row = bad[0]
        raise InvalidInput(
            f"correspondence: row {row} is triangle {face[row]} with weights {weights[row].tolist()}, which the target"
            f" with {face_count} triangles does not have ({bad.size} such rows)"
        )
    return matched


def _area(vertices: FloatArray, faces: npt.NDArray[np.int32]) -> float:
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    a, b, c = (vertices[faces[first, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def _cloud_length(vertices: FloatArray) -> float:
    extents = np.sort(np.ptp(vertices, axis=0))
    length = float(np.sqrt(extents[1] * extents[2]))
    if length <= 0.0:
        raise InvalidInput("target: the points of the cloud lie on a line, so that it has no size to measure errors in")
    return length


def _geodesic_errors(
    surface: Surface, truth: Truth, rows: IntArray, image_face: IntArray, image_weights: FloatArray
) -> tuple[FloatArray, int]:
    """Distances between images and true images, and how many of them are straight lines for want of a path."""
    vertices, faces = surface.vertices, surface.faces
    starts = _Starts(surface, truth)
    true_points = positions(truth, rows, vertices, faces)
    images = np.einsum("ij,ijk->ik", image_weights, vertices[faces[image_face]])
    straight = np.linalg.norm(images - true_points, axis=1)
    sides = np.linalg.norm(vertices[faces] - np.roll(vertices[faces], 1, axis=1), axis=2)
    reach = 6.0 * float(sides.mean())

    def measured(i: int) -> float:
        candidates = starts.of(int(rows[i]))
        if any(face == image_face[i] for face, _ in candidates):  # in one triangle the straight line is the path
            return float(straight[i])
        radius = max(1.5 * float(straight[i]), reach)
        return max(_distance(surface, candidates, faces[image_face[i]], images[i], radius), float(straight[i]))

    # The windows run without the interpreter's lock.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        distances = np.fromiter(pool.map(measured, range(len(rows))), float, len(rows))
    apart = ~np.isfinite(distances)
    return np.where(apart, straight, distances), int(apart.sum())


class _Starts:
    """Triangles and weights that hold the true image of a row."""

    def __init__(self, surface: Surface, truth: Truth) -> None:
        self._truth = truth
        self._faces = surface.faces
        corners = surface.faces.ravel()
        self._order = np.argsort(corners, kind="stable")
        self._first = np.searchsorted(corners[self._order], np.arange(len(surface.vertices) + 1))

    def of(self, row: int) -> list[tuple[int, FloatArray]]:
        truth = self._truth
        if truth.face is None:
            assert truth.vertex is not None
            return self._around(int(truth.vertex[row]))
        assert truth.weights is not None
        face, weights = int(truth.face[row]), truth.weights[row]
        if weights.max() > 1.0 - 1e-9:
            return self._around(int(self._faces[face][int(np.argmax(weights))]))
        return [(face, weights)]

    def _around(self, vertex: int) -> list[tuple[int, FloatArray]]:
        entries = self._order[self._first[vertex] : self._first[vertex + 1]]
        return [(int(entry) // 3, np.eye(3)[int(entry) % 3]) for entry in entries]


def _distance(
    surface: Surface,
    candidates: list[tuple[int, FloatArray]],
    corners: npt.NDArray[np.int32],
    image: FloatArray,
    radius: float,
) -> float:
    """Geodesic distance from the point that all `candidates` describe to `image` in the triangle `corners`.

    Looked for within `radius` first and then twice as far each time: most images lie near, and that is cheap.
    """
    extent = float(np.linalg.norm(np.ptp(surface.vertices, axis=0)))
    for face, weights in candidates:
        try:
            while True:
                limit = radius if radius < extent else float("inf")
                field = geodesic_distances(surface, face, weights, radius=limit)
                found = unfolded_distance(surface.vertices[corners], field[corners], image)
                # Near the rim distances are not quite right yet.
                if limit == float("inf") or (found <= 0.9 * limit and np.isfinite(field[corners]).all()):
                    return found
                radius *= 2.0
        except InvalidInput:  # left out by the gate: another triangle at the same place will do
            continue
    return float("inf")


def unfolded_distance(corners: FloatArray, distances: FloatArray, point: FloatArray) -> float:
    """Distance of a point of a triangle from a source of which only the distances of the corners are known.

    The source is laid flat beyond each edge where the distances of the edge's ends put it; the straight line from
    there counts if it crosses the edge, the way over the nearer end otherwise. Exact where the source lies in the
    triangle across the edge.

    Args:
        corners: (3, 3) positions. distances: (3,), infinite where not known. point: (3,) in the triangle.
    """
    best = float("inf")
    for k in range(3):
        from_distance, to_distance = float(distances[k]), float(distances[(k + 1) % 3])
        edge = corners[(k + 1) % 3] - corners[k]
        length = float(np.linalg.norm(edge))
        offset = point - corners[k]
        best = min(best, from_distance + float(np.linalg.norm(offset)))
        if length <= 0.0 or not np.isfinite(from_distance + to_distance):
            continue
        along = float(offset @ edge) / length
        across = float(np.sqrt(max(float(offset @ offset) - along * along, 0.0)))
        foot = (length * length + from_distance * from_distance - to_distance * to_distance) / (2.0 * length)
        depth = float(np.sqrt(max(from_distance * from_distance - foot * foot, 0.0)))
        height = depth + across
        crossing = foot + (along - foot) * depth / height if height > 0.0 else along
        if 0.0 <= crossing <= length:
            best = min(best, float(np.hypot(along - foot, height)))
    return best
