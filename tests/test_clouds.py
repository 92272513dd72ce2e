# SPDX-License-Identifier: GPL-3.0-or-later
"""Point clouds through the package: the gate, a match on either side, files, the command line."""

from __future__ import annotations

import functools
import json
import pickle
import re
from pathlib import Path
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces
from isograft.cli import main
from isograft.evaluation import evaluate
from isograft.files import read_mesh

COUNT = 3000


def points_on(mesh: Any, count: int, seed: int) -> tuple[Any, Any, Any]:
    """(count, 3) points evenly distributed over a mesh, their triangles and weights."""
    vertices, faces = mesh
    random = np.random.default_rng(seed)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    face = random.choice(len(faces), count, p=area / area.sum())
    root, other = np.sqrt(random.uniform(size=count)), random.uniform(size=count)
    weights = np.stack([1.0 - root, root * (1.0 - other), root * other], axis=1)
    return np.einsum("ij,ijk->ik", weights, corners[face]), face, weights


@functools.cache
def cloud_to_mesh() -> tuple[Any, Any, isograft.Match]:
    """Points of a blob matched to the blob itself, and the truth."""
    mesh = surfaces.blob(4)
    points, face, weights = points_on(mesh, COUNT, 1)
    turned = points @ surfaces.rotation().T + [1.0, 2.0, 3.0]
    return mesh, (face, weights), isograft.match((turned, None), mesh, preset="fast", scale="fixed")


@functools.cache
def mesh_to_cloud() -> tuple[Any, Any, isograft.Match]:
    mesh = surfaces.blob(4)
    points, _, _ = points_on(mesh, COUNT, 2)
    return mesh, points, isograft.match(mesh, (points,), preset="fast", scale="fixed")


def test_a_cloud_has_a_row_for_every_point_and_finds_its_place_on_a_mesh() -> None:
    mesh, truth, result = cloud_to_mesh()
    assert len(result.best) == COUNT
    measured = evaluate(result.best, truth, mesh)
    assert measured.coverage > 0.9
    # The spacing of the points is 2 in these units.
    assert measured.error < 2.0, measured.to_dict()


def test_on_a_cloud_points_and_the_nearest_point_are_the_answer() -> None:
    (vertices, _), points, result = mesh_to_cloud()
    best = result.best
    matched = best.matched
    assert matched.mean() > 0.9
    assert (best.face == -1).all()
    nearest = np.linalg.norm(points[None, best.vertex[matched][:200]] - best.points[matched][None, :200], axis=2)[0]
    every = np.linalg.norm(points[None] - best.points[matched][:200, None], axis=2)
    assert (nearest <= every.min(axis=1) * 1.0001).mean() > 0.95  # elsewhere the nearest is on another sheet
    size = np.sqrt(np.prod(np.sort(np.ptp(points, axis=0))[1:]))
    error = np.linalg.norm(best.points[matched] - vertices[matched], axis=1) / size * 100
    assert error.mean() < 2.0
    unmatched = ~matched
    assert np.isnan(best.points[unmatched]).all()
    assert (best.vertex[unmatched] == -1).all()


def test_values_at_the_points_of_a_cloud_are_carried_over() -> None:
    _, points, result = mesh_to_cloud()
    best = result.best
    moved = best.interpolate(points)[best.matched]
    spacing = np.sqrt(4 * np.pi * 1.5 / COUNT)
    assert np.linalg.norm(moved - best.points[best.matched], axis=1).mean() < spacing
    assert np.isfinite(moved).all()
    with pytest.raises(isograft.InvalidInput, match="one row per target vertex"):
        best.interpolate(points[:-1])


def test_maps_to_clouds_are_saved_read_and_measured(tmp_path: Path) -> None:
    (vertices, _), points, result = mesh_to_cloud()
    result.save(tmp_path / "map.npz")
    read = isograft.Match.load(tmp_path / "map.npz").best
    for name, array in result.best.arrays().items():
        np.testing.assert_array_equal(getattr(read, name), array)
    nearest = np.array([int(np.argmin(((points - v) ** 2).sum(axis=1))) for v in vertices])
    for target in ((points, None), isograft.Surface(points)):
        assert evaluate(read, nearest, target).error < 3.0
    with pytest.raises(isograft.InvalidInput, match="point cloud"):
        isograft.files.write_map(tmp_path / "map.corr", result, None)  # type: ignore[arg-type]
    assert not (tmp_path / "map.corr").exists()


def write_points(path: Path, points: Any, normals: Any = None) -> Path:
    names = ["x", "y", "z"] + ([] if normals is None else ["nx", "ny", "nz"])
    table = points if normals is None else np.hstack([points, normals])
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    header += [*(f"property double {name}" for name in names), "end_header", ""]
    path.write_bytes("\n".join(header).encode() + np.ascontiguousarray(table, "<f8").tobytes())
    return path


def test_the_command_takes_files_without_faces_on_both_sides(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mesh = surfaces.blob(3)
    source = write_points(tmp_path / "source.ply", points_on(mesh, 1500, 3)[0])
    target = write_points(tmp_path / "target.ply", points_on(mesh, 1500, 4)[0])
    out = tmp_path / "map.npz"
    arguments = ["match", str(source), str(target), "-o", str(out), "--preset", "fast", "--scale", "fixed", "--json"]
    assert main(arguments) == 0
    assert json.loads(capsys.readouterr().out)["vertices"] == 1500
    assert isograft.Match.load(out).best.matched.mean() > 0.8
    assert main([*arguments[:4], str(tmp_path / "map.corr")]) == 2
    assert "point cloud" in capsys.readouterr().err


def test_normals_of_a_file_are_read_and_used(tmp_path: Path) -> None:
    random = np.random.default_rng(5)
    sphere = random.normal(size=(800, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    flipped = sphere * np.where(np.arange(800) % 10 == 0, -1.0, 1.0)[:, None]
    mesh = read_mesh(write_points(tmp_path / "a.ply", sphere, flipped))
    np.testing.assert_allclose(mesh.normals, flipped)
    surface = mesh.surface()
    assert any("80 points (10.0 %)" in warning for warning in surface.warnings), surface.warnings
    assert surface.normals is not None
    assert (np.einsum("ij,ij->i", surface.normals, sphere) > 0.95).all()


def test_a_cloud_is_a_surface_of_its_own_kind() -> None:
    random = np.random.default_rng(6)
    points = random.normal(size=(600, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    surface = isograft.Surface(points)
    assert surface.is_cloud
    assert surface.faces.shape == (0, 3)
    assert not surface.orientation_is_ambiguous
    vertices, faces = surface.working_mesh
    distances = isograft.geodesic_distances((vertices, faces), 0, [1.0, 0.0, 0.0])
    assert abs(distances.max() / np.pi - 1.0) < 0.03
    with pytest.raises(isograft.InvalidInput, match="working_mesh"):
        isograft.geodesic_distances(surface, 0, [1.0, 0.0, 0.0])
    again = pickle.loads(pickle.dumps(surface))
    np.testing.assert_array_equal(again.working_mesh[0], vertices)
    assert repr(surface) == "Surface(600 points)"


def test_a_cloud_that_has_no_two_sides_is_told_with_the_share_that_is_doubtful() -> None:
    # A strip with half a twist: carried around it, a side comes back as the other one.
    random = np.random.default_rng(9)
    around, across = random.uniform(0.0, 2.0 * np.pi, 3000), random.uniform(-0.3, 0.3, 3000)
    radius = 1.0 + across * np.cos(around / 2.0)
    strip = np.column_stack([radius * np.cos(around), radius * np.sin(around), across * np.sin(around / 2.0)])
    told = [w for w in isograft.Surface(strip).warnings if "doubtful" in w]
    assert len(told) == 1
    found = re.search(r"the side of the normals is doubtful at (\d+) points \(([\d.]+) %\)", told[0])
    assert found is not None, told
    # The seam is one line across the strip.
    assert 1 <= int(found[1]) < 150
    assert abs(float(found[2]) - int(found[1]) / 30.0) < 0.1
    # Where the twist is cut there are two sides, and nothing to doubt.
    cut = strip[(around > 0.4) & (around < 5.9)]
    assert not [w for w in isograft.Surface(cut).warnings if "doubtful" in w]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda p: (p[:49],), r"49 rows is too small: at least 50"),
        (
            lambda p: (np.where(np.arange(200)[:, None] == 7, np.nan, p),),
            r"NaN or infinity in 1 row, the first is row 7",
        ),
        (
            lambda p: (p[np.arange(200) % 40],),
            r"160 rows of 200 equal an earlier one, the first is row 40, equal to row 0",
        ),
        (lambda p: (p, None, p[:3]), r"`normals` has 3 rows, `vertices` has 200"),
        (lambda p: (p, None, p * (np.arange(200) != 5)[:, None]), r"no length in 1 row, the first is row 5"),
        (lambda p: (p, None, p[:, :2]), r"normals must have shape \(n, 3\)"),
    ],
)
def test_clouds_that_cannot_be_used_are_refused_with_what_and_where(change: Any, words: str) -> None:
    points = np.random.default_rng(7).normal(size=(200, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    with pytest.raises(isograft.InvalidInput, match=words):
        isograft.Surface(*change(points))


def test_the_preset_noisy_matches_a_noisy_mesh() -> None:
    vertices, faces = surfaces.blob(4)
    edge = np.linalg.norm(vertices[faces[:, 0]] - vertices[faces[:, 1]], axis=1).mean()
    noisy = vertices + np.random.default_rng(8).normal(size=vertices.shape) * 0.15 * edge
    result = isograft.match((noisy, faces), (vertices, faces), preset="noisy", hierarchy_samples=500, scale="fixed")
    measured = evaluate(result.best, np.arange(len(vertices)), (vertices, faces))
    assert measured.coverage > 0.9
    assert measured.error < 2.0, measured.to_dict()
