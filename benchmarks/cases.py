# SPDX-License-Identifier: GPL-3.0-or-later
"""One pair, read from its files: two surfaces and the truth between them, perhaps reversed, perhaps moved."""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from isograft import InvalidInput
from isograft.evaluation import Truth, load_truth
from isograft.files import read_mesh

from benchmarks.closest_point import closest_points

Floats = npt.NDArray[np.float64]
#: Vertices, and triangles or None for a point cloud.
Shape = tuple[Floats, npt.NDArray[np.int32] | None]


@dataclass(frozen=True)
class Case:
    source: Shape
    target: Shape
    #: None where nothing is known.
    truth: Truth | None
    #: A truth of -1 says that the vertex has no counterpart, and not that none is known.
    unmatched_is_truth: bool
    #: The mesh that the target's points were taken from; errors are measured on it. None: on the target itself.
    measured_on: Shape | None = None

    @property
    def size(self) -> int:
        """Vertices of the larger surface."""
        return max(len(self.source[0]), len(self.target[0]))


def read_case(data: Path, pair: dict[str, str], *, reverse: bool = False, rotation: int = 0) -> Case:
    """Read a pair of pairs.csv.

    Args:
        reverse: swap the two, and invert the truth.
        rotation: 0 leaves both where they are; every other number is another random motion of either.
    """
    source, target = (_read_shape(data / pair[side]) for side in ("source", "target"))
    truth = _read_truth(data, pair, len(source[0]), len(target[0]))
    unmatched_is_truth = pair["gt_minus1"] == "unmatched"
    if truth is not None and len(truth) != len(source[0]):
        raise InvalidInput(f"{pair['gt_file']}: {len(truth)} rows, but the source has {len(source[0])} vertices")
    case = Case(source, target, truth, unmatched_is_truth)
    if reverse:
        case = reversed_case(case, unknown=pair["gt_minus1"] == "unknown" or pair["gt_kind"] == "identity")
    if rotation:
        random = np.random.default_rng([rotation, zlib.crc32(pair["id"].encode())])
        case = replace(case, source=_moved(case.source, random), target=_moved(case.target, random))
    return case


def reversed_case(case: Case, *, unknown: bool) -> Case:
    """Target to source.

    Where -1 in the truth (or its absence) means "unknown", every pair of vertices is turned round. Otherwise a
    target vertex has a counterpart where it lies on the image of the source (`covering`): on the source's triangles
    with their corners at their true images. Elsewhere it has none.
    """
    swapped = replace(case, source=case.target, target=case.source)
    truth, faces = case.truth, case.source[1]
    if truth is None:
        return swapped
    vertices = case.target[0]
    if unknown or faces is None or case.target[1] is None:
        inverse = np.full(len(vertices), -1, np.int64)
        images = _dominant(truth, case.target)
        rows = np.flatnonzero(images >= 0)[::-1]  # of several, the first stays
        inverse[images[rows]] = rows
        return replace(swapped, truth=Truth(vertex=inverse), unmatched_is_truth=False)

    known = truth.known
    positions = np.zeros((len(known), 3))
    positions[known] = true_images(truth, case.target)[known]
    kept = np.flatnonzero(known[faces].all(axis=1))
    if not len(kept):
        raise InvalidInput("the truth cannot be turned round: no source triangle has three known corners")
    corners = positions[faces[kept]]
    edge = float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
    face, weights = covering(vertices, positions, faces[kept], edge)
    face = np.where(face >= 0, kept[face], -1)
    return replace(swapped, truth=Truth(face=face, weights=weights), unmatched_is_truth=True)


def covering(
    points: Floats, positions: Floats, faces: npt.NDArray[np.int32], edge: float
) -> tuple[npt.NDArray[np.int64], Floats]:
    """The triangle (n,) over each point and the weights (n, 3) of its corners; -1 where the mesh does not cover it.

    Within half of `edge`, which is what flat triangles deviate from a curved surface. Where the nearest of the mesh is
    its boundary, a tenth is allowed: beyond it the point lies outside.
    """
    face, weights, distance = closest_points(points, positions, faces)
    tolerance = np.where(_on_boundary(faces, face, weights), 0.1 * edge, 0.5 * edge)
    return np.where(distance <= tolerance, face, -1), weights


def _read_shape(path: Path) -> Shape:
    mesh = read_mesh(path)
    return mesh.vertices, mesh.faces if len(mesh.faces) else None


def _read_truth(data: Path, pair: dict[str, str], source_size: int, target_size: int) -> Truth | None:
    kind = pair["gt_kind"]
    if kind == "none":
        return None
    if kind == "identity":
        if source_size != target_size:
            raise InvalidInput(f"an identity needs equal numbers of vertices, not {source_size} and {target_size}")
        return Truth(vertex=np.arange(source_size))
    if kind == "vertex":
        return load_truth(data / (pair["gt_bary"] or pair["gt_file"]))
    raise InvalidInput(f"gt_kind {kind!r} is none of identity, vertex, none")


def true_images(truth: Truth, target: Shape) -> Floats:
    """(n, 3) true images; anything where there is none."""
    if truth.face is None:
        assert truth.vertex is not None
        return target[0][truth.vertex]
    assert truth.weights is not None
    assert target[1] is not None
    return np.asarray(np.einsum("ij,ijk->ik", truth.weights, target[0][target[1][truth.face]]))


def _on_boundary(faces: npt.NDArray[np.int32], face: npt.NDArray[np.int64], weights: Floats) -> npt.NDArray[np.bool_]:
    """Whether each point, in triangle `face` of `faces`, lies on an edge or at a corner where the surface ends."""
    edges = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2)  # edge k lies opposite to corner k
    _, first, counts = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True)
    ends = (counts[first] == 1).reshape(-1, 3)
    at_end = np.zeros(int(faces.max()) + 1, bool)
    at_end[edges[ends]] = True
    zero = weights <= 1e-9
    on_edge = (zero & ends[face]).any(axis=1)
    at_corner = (zero.sum(axis=1) == 2) & at_end[faces[face, np.argmax(weights, axis=1)]]
    return np.asarray(on_edge | at_corner)


def _dominant(truth: Truth, target: Shape) -> npt.NDArray[np.int64]:
    """(n,) nearest target vertex of the true image, -1 where there is none."""
    if truth.face is None:
        assert truth.vertex is not None
        return truth.vertex
    assert truth.weights is not None
    assert target[1] is not None
    corner = target[1][truth.face, np.argmax(truth.weights, axis=1)]
    return np.where(truth.face >= 0, corner, -1)


def _moved(shape: Shape, random: Any) -> Shape:
    """Turned about its centre and pushed about as far as it is large."""
    vertices, faces = shape
    turn, scale = np.linalg.qr(random.normal(size=(3, 3)))
    turn = turn * np.sign(np.diag(scale))  # uniform over all rotations
    if np.linalg.det(turn) < 0:
        turn[:, 0] = -turn[:, 0]
    centre = vertices.mean(axis=0)
    push = random.normal(size=3) * np.ptp(vertices, axis=0).max()
    return (vertices - centre) @ turn.T + centre + push, faces
