# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of meshes made harder: a side, or both, sampled to points; noise on the vertices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt
from isograft import InvalidInput
from isograft.evaluation import Truth

from benchmarks.cases import Case, Shape, true_images
from benchmarks.closest_point import closest_points

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


def with_points(case: Case, side: str, count: int, seed: int = 0) -> Case:
    """The pair with `count` points, evenly distributed by area, instead of the triangles of `side`.

    The true image of a source point is the mean of those of its triangle's corners, put back onto the target, unknown
    where one of them is or where they lie apart. Images on a target of points are measured on the mesh they were
    taken from, so that errors compare with those of the pair of meshes.
    """
    random = np.random.default_rng([seed, count])
    if case.source[1] is None or case.target[1] is None:
        raise InvalidInput("--as-points needs two meshes: this pair has a point cloud already")
    result = case
    if side in ("source", "both"):
        points, face, weights = _sampled(case.source, count, random)
        truth = None if case.truth is None else _truth_of(case, case.truth, face, weights)
        result = replace(result, source=(points, None), truth=truth)
    if side in ("target", "both"):
        points, _, _ = _sampled(case.target, count, random)
        result = replace(result, target=(points, None), measured_on=case.target)
    return result


def with_noise(case: Case, share: float, seed: int = 0) -> Case:
    """The pair of meshes with every vertex moved by Gaussian noise, of `share` of its mesh's mean edge an axis.

    Images are measured on the target as it was, at its nearest points.
    """
    if not 0.0 < share <= 2.0:
        raise InvalidInput(f"--noise must be in (0, 2], not {share}")
    if case.source[1] is None or case.target[1] is None:
        raise InvalidInput("--noise needs two meshes: this pair has a point cloud")
    random = np.random.default_rng(seed)
    source, target = (_moved(shape, share, random) for shape in (case.source, case.target))
    return replace(case, source=source, target=target, measured_on=case.target)


def _moved(shape: Shape, share: float, random: np.random.Generator) -> Shape:
    vertices, faces = shape
    assert faces is not None
    edge = float(np.linalg.norm(vertices[faces] - vertices[np.roll(faces, 1, axis=1)], axis=2).mean())
    return vertices + random.normal(size=vertices.shape) * share * edge, faces


def _sampled(shape: Shape, count: int, random: np.random.Generator) -> tuple[Floats, Ints, Floats]:
    vertices, faces = shape
    assert faces is not None
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    face = random.choice(len(faces), count, p=area / area.sum())
    root, other = np.sqrt(random.uniform(size=count)), random.uniform(size=count)
    weights = np.stack([1.0 - root, root * (1.0 - other), root * other], axis=1)
    return np.einsum("ij,ijk->ik", weights, corners[face]), face, weights


def _truth_of(case: Case, truth: Truth, face: Ints, weights: Floats) -> Truth:
    target, target_faces = case.target
    assert case.source[1] is not None
    assert target_faces is not None
    corners = case.source[1][face]
    known = truth.known[corners].all(axis=1)
    images = true_images(truth, case.target)[corners]
    edge = np.linalg.norm(case.source[0][corners] - np.roll(case.source[0][corners], 1, axis=1), axis=2).max(axis=1)
    apart = np.linalg.norm(images - np.roll(images, 1, axis=1), axis=2).max(axis=1)
    # Truths told by vertices are as coarse as the target's edges.
    spread = np.linalg.norm(target[target_faces] - np.roll(target[target_faces], 1, axis=1), axis=2).mean()
    known &= apart < 3.0 * edge + 3.0 * spread
    found = np.full(len(face), -1, np.int64)
    found_weights = np.full((len(face), 3), 1.0 / 3.0)
    mean = np.einsum("ij,ijk->ik", weights[known], images[known])
    found[known], found_weights[known], _ = closest_points(mean, target, target_faces)
    return Truth(face=found, weights=found_weights)
