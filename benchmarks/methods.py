# SPDX-License-Identifier: GPL-3.0-or-later
"""What finds a correspondence: isograft, and the peers it is compared with, all measured alike."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass, field
from typing import Any

import isograft
import numpy as np
import numpy.typing as npt
from isograft.evaluation import SurfacePoints

from benchmarks.cases import Case, Shape
from benchmarks.closest_point import closest_points


@dataclass
class Found:
    """`correspondence` has face, barycentric and points; `seconds` is the time to find it, without reading files."""

    correspondence: SurfacePoints
    seconds: float
    report: isograft.Report | None = None
    details: dict[str, Any] = field(default_factory=dict)


@dataclass
class VertexMap:
    """A correspondence of a peer."""

    face: npt.NDArray[np.int32]
    barycentric: npt.NDArray[np.float64]
    points: npt.NDArray[np.float64]


def find(case: Case, request: dict[str, Any]) -> Found:
    method = request["method"]
    if method == "isograft":
        return _isograft(case, request)
    return {"nearest": _nearest, "pyfm-zoomout": _pyfm_zoomout}[method](case)


def _isograft(case: Case, request: dict[str, Any]) -> Found:
    times = []
    for _ in range(request["repeats"]):
        started = time.perf_counter()
        # Arrays, so that the gate's time counts too.
        result = isograft.match(
            case.source,
            case.target,
            preset=request["preset"],
            threads=request["threads"],
            **request["overrides"],
        )
        times.append(time.perf_counter() - started)
    report = result.report
    details = {
        "stages": {stage.name: round(stage.seconds, 4) for stage in report.stages},
        "scale": report.scale,
        "source_samples": report.source_samples,
        "target_samples": report.target_samples,
        "alternatives": len(result.alternatives),
        "warnings": list(report.warnings),
        "all_seconds": [round(seconds, 4) for seconds in times],
    }
    return Found(result.best, statistics.median(times), report, details)


def _nearest(case: Case) -> Found:
    """The nearest point in space, positions as they are in the files: what Blender's Data Transfer does."""
    started = time.perf_counter()
    points, (vertices, faces) = case.source[0], case.target
    if faces is None:
        nearest = np.array([int(np.argmin(np.einsum("ij,ij->i", vertices - p, vertices - p))) for p in points])
        return Found(_at_vertices(nearest, case.target), time.perf_counter() - started)
    face, weights, _ = closest_points(points, vertices, faces)
    images = np.einsum("ij,ijk->ik", weights, vertices[faces[face]])
    return Found(VertexMap(face.astype(np.int32), weights, images), time.perf_counter() - started)


def _pyfm_zoomout(case: Case) -> Found:
    """pyFM's functional maps as its front page fits them (WKS, orientation term), ZoomOut from 30 to 120 functions."""
    # Installed only where peers are asked for.
    from pyFM.functional import FunctionalMapping
    from pyFM.mesh import TriMesh

    if case.source[1] is None or case.target[1] is None:
        raise isograft.InvalidInput("pyFM with ZoomOut is run on meshes only")
    started = time.perf_counter()
    # pyFM's maps lead from its second mesh to its first.
    target, source = (
        TriMesh(vertices, faces, area_normalize=True, center=True) for vertices, faces in (case.target, case.source)
    )
    model = FunctionalMapping(target, source)
    model.preprocess(descr_type="WKS", n_descr=100, subsample_step=2, k_process=130)
    model.fit(K=30, w_descr=1e0, w_lap=1e-1, w_dcomm=1e0, w_orient=1e0)
    refined = model.zoomout_refine(nit=18, step=5)
    images = np.asarray(model.get_p2p(refined), np.int64)
    seconds = time.perf_counter() - started
    return Found(_at_vertices(images, case.target), seconds)


def _at_vertices(images: npt.NDArray[np.int64], target: Shape) -> VertexMap:
    vertices, faces = target
    face = np.full(len(images), -1, np.int32)
    weights = np.full((len(images), 3), np.nan)
    if faces is not None:
        corners = faces.ravel()
        entry = np.full(len(vertices), -1, np.int64)
        entry[corners[::-1]] = np.arange(len(corners))[::-1]
        at = entry[images]
        used = at >= 0
        face[used] = at[used] // 3
        weights[used] = np.eye(3)[at[used] % 3]
    return VertexMap(face, weights, vertices[images])


def on_mesh(correspondence: SurfacePoints, mesh: Shape) -> VertexMap:
    """Images given as points, put onto a mesh."""
    vertices, faces = mesh
    assert faces is not None
    points = np.asarray(correspondence.points)
    matched = np.isfinite(points).all(axis=1)
    face = np.full(len(points), -1, np.int32)
    weights = np.full((len(points), 3), np.nan)
    images = np.full((len(points), 3), np.nan)
    face[matched], weights[matched], _ = closest_points(points[matched], vertices, faces)
    images[matched] = np.einsum("ij,ijk->ik", weights[matched], vertices[faces[face[matched]]])
    return VertexMap(face, weights, images)


def cost_unit(case: Case, report: isograft.Report, windows: int = 20, seed: int = 0) -> float:
    """Seconds of one full geodesic window from every sample of both surfaces, on one thread.

    Measured on `windows` vertices, half of them on either surface.
    """
    random = np.random.default_rng(seed)
    total = 0.0
    for shape, samples in ((case.source, report.source_samples), (case.target, report.target_samples)):
        surface = isograft.Surface(*shape)
        done, seconds = 0, 0.0
        for face in random.permutation(len(surface.faces)):
            started = time.perf_counter()
            try:
                isograft.geodesic_distances(surface, int(face), [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0])
            except isograft.InvalidInput:  # a triangle that the gate left out
                continue
            seconds += time.perf_counter() - started
            done += 1
            if done == max(windows // 2, 1):
                break
        total += samples * seconds / max(done, 1)
    return total
