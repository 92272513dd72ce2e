# SPDX-License-Identifier: GPL-3.0-or-later
"""The gate as Python sees it: what is accepted, what is refused with which words, what is kept."""

from __future__ import annotations

import pickle
from typing import Any

import isograft
import numpy as np
import pytest
import surfaces

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
SIDES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (TETRAHEDRON.tolist(), SIDES.tolist()),
        (TETRAHEDRON.astype(np.float32), SIDES.astype(np.uint8)),
        (np.asfortranarray(TETRAHEDRON), np.asfortranarray(SIDES)),
        (TETRAHEDRON.astype(">f8"), SIDES.astype(">i4")),
        (np.repeat(TETRAHEDRON, 2, axis=0)[::2], np.repeat(SIDES, 2, axis=1)[:, ::2]),
        (TETRAHEDRON.astype(np.int64), SIDES.astype(np.uint64)),
    ],
)
def test_any_layout_and_real_dtype_gives_the_same_surface(vertices: Any, faces: Any) -> None:
    surface = isograft.Surface(vertices, faces)
    assert surface.vertices.dtype == np.float64
    assert surface.faces.dtype == np.int32
    assert (surface.vertices == TETRAHEDRON).all()
    assert (surface.faces == SIDES).all()
    assert surface.warnings == []
    assert not surface.orientation_is_ambiguous


def test_a_read_only_array_is_accepted_and_left_alone() -> None:
    vertices = TETRAHEDRON.copy()
    vertices.flags.writeable = False
    assert (isograft.Surface(vertices, SIDES).vertices == TETRAHEDRON).all()


def test_the_arrays_of_a_surface_cannot_be_written() -> None:
    surface = isograft.Surface(TETRAHEDRON, SIDES)
    with pytest.raises(ValueError, match="read-only"):
        surface.vertices[0, 0] = 5.0
    with pytest.raises(ValueError, match="read-only"):
        surface.faces[0, 0] = 1


def nan_at(row: int, value: float) -> Any:
    vertices = TETRAHEDRON.copy()
    vertices[row, 1] = value
    return vertices


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        (TETRAHEDRON[:, :2], SIDES, r"vertices must have shape \(n, 3\), not \(4, 2\)"),
        (TETRAHEDRON.ravel(), SIDES, r"vertices must have shape \(n, 3\), not \(12,\)"),
        (TETRAHEDRON.astype(complex), SIDES, "vertices must hold real numbers, not complex128"),
        (TETRAHEDRON.astype(str), SIDES, "vertices must hold real numbers"),
        (TETRAHEDRON.astype(bool), SIDES, "vertices must hold real numbers, not bool"),
        ([[0, 0, 0], [1, 1]], SIDES, "vertices is not an array"),
        (None, SIDES, "vertices must hold real numbers"),
        (TETRAHEDRON, SIDES.astype(float), "faces must hold integers, not float64"),
        (TETRAHEDRON, [[0, 1, 2, 3]], "triangulate quads first"),
        (TETRAHEDRON, [[0, 1]], r"faces must have shape \(k, 3\), not \(1, 2\)"),
        (TETRAHEDRON, [[0, 1, 2], [0, 1, 2**31]], "faces row 1 .*32-bit"),
        (TETRAHEDRON, [[0, 1, 2], [0, 1, 4]], "4"),
        (TETRAHEDRON, [[0, 1, 2], [0, -1, 2]], "-1"),
        (TETRAHEDRON, np.empty((0, 3), int), "triangle"),
        (np.empty((0, 3)), np.empty((0, 3), int), "vert"),
        (nan_at(2, np.nan), SIDES, "2"),
        (nan_at(3, np.inf), SIDES, "3"),
        (TETRAHEDRON, [[0, 0, 1], [1, 1, 1]], "area"),
    ],
)
def test_what_cannot_be_a_surface_is_refused_with_what_and_where(vertices: Any, faces: Any, words: str) -> None:
    with pytest.raises(isograft.InvalidInput, match=words):
        isograft.Surface(vertices, faces)


def test_normals_of_a_mesh_are_checked_and_their_neglect_is_told() -> None:
    with pytest.raises(isograft.InvalidInput, match=r"normals must have shape \(4, 3\)"):
        isograft.Surface(TETRAHEDRON, SIDES, TETRAHEDRON[:3])
    assert "normals were not used" in isograft.Surface(TETRAHEDRON, SIDES, TETRAHEDRON).warnings[0]


def test_repairs_are_told_with_their_number() -> None:
    faces = np.vstack([SIDES, SIDES[:1], [[2, 2, 1]]])
    warnings = isograft.Surface(TETRAHEDRON, faces).warnings
    assert len(warnings) == 2
    assert all("1 " in text for text in warnings)


def test_an_open_surface_that_bulges_to_no_side_is_ambiguous() -> None:
    square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]
    assert isograft.Surface(square, [[0, 1, 2], [0, 2, 3]]).orientation_is_ambiguous


def test_an_open_surface_that_bulges_outward_is_not_ambiguous() -> None:
    assert not isograft.Surface(TETRAHEDRON, SIDES[:3]).orientation_is_ambiguous
    inward = [side[::-1] for side in SIDES[:3]]
    assert isograft.Surface(TETRAHEDRON, inward).orientation_is_ambiguous


def test_a_surface_survives_pickling() -> None:
    surface = isograft.Surface(TETRAHEDRON, SIDES)
    again = pickle.loads(pickle.dumps(surface))
    assert (again.vertices == surface.vertices).all()
    assert (again.faces == surface.faces).all()


def test_geodesic_distances_on_a_sphere_are_great_circles() -> None:
    vertices, faces = surfaces.sphere(4)
    found = isograft.geodesic_distances((vertices, faces), 0, [1.0, 0.0, 0.0])
    great_circles = np.arccos(np.clip(vertices @ vertices[faces[0, 0]], -1.0, 1.0))
    assert found.shape == (len(vertices),)
    assert found[faces[0, 0]] == pytest.approx(0.0, abs=1e-6)
    error = np.abs(found - great_circles)
    assert error.mean() < 0.005 * great_circles.mean()
    assert error.max() < 0.015 * np.pi


def test_geodesic_distances_are_infinite_on_another_component() -> None:
    faces = np.vstack([SIDES, SIDES + 4])
    found = isograft.geodesic_distances((np.vstack([TETRAHEDRON, TETRAHEDRON + 5]), faces), 0, [0.2, 0.3, 0.5])
    assert np.isfinite(found[:4]).all()
    assert np.isinf(found[4:]).all()


def test_geodesic_distances_within_a_radius_are_those_of_the_whole() -> None:
    mesh = surfaces.blob(3)
    whole = isograft.geodesic_distances(mesh, 7, [0.2, 0.3, 0.5])
    part = isograft.geodesic_distances(mesh, 7, [0.2, 0.3, 0.5], radius=0.5)
    assert np.isinf(part[whole > 0.5]).all()
    near = whole <= 0.45
    assert near.sum() > 10
    assert part[near] == pytest.approx(whole[near], rel=0.01)
    for radius in (0.0, -1.0, np.nan, "wide"):
        with pytest.raises(isograft.InvalidInput, match="radius must be a positive number"):
            isograft.geodesic_distances(mesh, 7, [0.2, 0.3, 0.5], radius=radius)


@pytest.mark.parametrize(
    ("face", "barycentric", "words"),
    [
        (4, [1, 0, 0], "face must be from 0 to 3"),
        (-1, [1, 0, 0], "face must be from 0 to 3"),
        (0.5, [1, 0, 0], "face must be an integer"),
        (0, [1, 0], "shape"),
        (0, [2, -1, 0], "weights must be >= 0 with sum 1"),
        (0, [0.5, 0.2, 0.2], "weights must be >= 0 with sum 1"),
        (0, [np.nan, 0, 1], "barycentric must be finite"),
    ],
)
def test_geodesic_distances_refuse_a_point_that_is_none(face: Any, barycentric: Any, words: str) -> None:
    with pytest.raises(isograft.InvalidInput, match=words):
        isograft.geodesic_distances((TETRAHEDRON, SIDES), face, barycentric)
