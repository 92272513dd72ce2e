# SPDX-License-Identifier: GPL-3.0-or-later
"""The parts of the demo that need no Blender: shapes, their meshes, range maps, truth and texture."""

from __future__ import annotations

import numpy as np
import pytest

from demo import creature_mesh, fusion, implicit, isosurface, paint, raster

TRIANGLE = np.array([[(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)]])


def ball_grid(radius: float, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    ticks = np.arange(-1.5, 1.5 + spacing, spacing)
    points = np.stack(np.meshgrid(ticks, ticks, ticks, indexing="ij"), axis=-1)
    return np.linalg.norm(points, axis=-1) - radius, np.full(3, -1.5)


def area_and_volume(vertices: np.ndarray, triangles: np.ndarray) -> tuple[float, float]:
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    cross = np.cross(b - a, c - a)
    return float(0.5 * np.linalg.norm(cross, axis=1).sum()), float((a * cross).sum() / 6.0)


def split(quads: np.ndarray) -> np.ndarray:
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def test_the_surface_of_a_ball_is_closed_and_faces_outwards_with_its_area_and_volume() -> None:
    values, origin = ball_grid(1.0, 0.05)
    vertices, quads = isosurface.surface_nets(values, origin, 0.05)
    edges, uses = np.unique(
        np.sort(np.concatenate([quads[:, [i, (i + 1) % 4]] for i in range(4)]), axis=1), axis=0, return_counts=True
    )
    assert (uses == 2).all()
    assert len(vertices) - len(edges) + len(quads) == 2
    area, volume = area_and_volume(vertices, split(quads))
    assert area == pytest.approx(4.0 * np.pi, rel=0.01)
    assert volume == pytest.approx(4.0 / 3.0 * np.pi, rel=0.01)


def test_a_surface_stays_open_where_the_grid_is_not_known() -> None:
    values, origin = ball_grid(1.0, 0.1)
    known = np.zeros(values.shape, bool)
    known[:, :, 16:] = True
    vertices, quads = isosurface.surface_nets(values, origin, 0.1, known)
    assert vertices[:, 2].min() > 0.0
    area, _ = area_and_volume(vertices, split(quads))
    assert 0.7 * 2.0 * np.pi < area < 2.0 * np.pi


def test_points_are_projected_onto_a_smooth_union() -> None:
    shape = implicit.Shape()
    shape.add(
        implicit.ellipsoid((0, 0, 0), (0.5, 0.4, 0.3)), implicit.tapered_capsule((0, 0, 0), (0.9, 0, 0), 0.2, 0.05)
    )
    rng = np.random.default_rng(0)
    points = rng.normal(size=(500, 3))
    points *= 0.45 / np.linalg.norm(points, axis=1, keepdims=True)
    landed = shape.project(points, steps=15)
    assert np.abs(shape.value(landed)).max() < 1e-4


def test_a_smooth_union_is_the_plain_one_away_from_the_joint() -> None:
    a, b = np.array([0.1, 0.5, -0.2]), np.array([0.9, 0.1, 0.3])
    assert np.array_equal(implicit.smooth_min(a, b, 0.3), np.minimum(a, b))
    assert implicit.smooth_min(np.zeros(1), np.zeros(1), 0.2)[0] == pytest.approx(-0.05)


def test_a_vertex_where_two_fans_meet_is_pinched_and_no_other_is() -> None:
    triangles = np.array([(0, 1, 2), (0, 2, 3), (0, 4, 5), (0, 5, 6)])
    assert creature_mesh.pinched_vertices(7, triangles).tolist() == [0]


def test_an_edge_of_three_faces_is_crowded() -> None:
    triangles = np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)])
    assert creature_mesh.crowded_edges(triangles).tolist() == [[0, 1]]


def test_barycentric_weights_give_back_points_of_the_triangle() -> None:
    rng = np.random.default_rng(1)
    corners = rng.normal(size=(200, 3, 3))
    weights = rng.dirichlet((1.0, 1.0, 1.0), 200)
    points = np.einsum("nc,ncd->nd", weights, corners)
    assert fusion.barycentric(points, corners) == pytest.approx(weights, abs=1e-7)


def test_barycentric_weights_of_points_outside_stay_in_the_triangle() -> None:
    weights = fusion.barycentric(np.array([(3.0, -1.0, 0.0)]), TRIANGLE)
    assert (weights >= 0.0).all()
    assert weights.sum() == pytest.approx(1.0)


def test_a_rigid_motion_and_its_inverse_cancel() -> None:
    points = np.random.default_rng(2).normal(size=(50, 3))
    axis, shift = np.array((1.0, 2.0, 3.0)), np.array((2.0, 1.0, 0.5))
    moved = fusion.rigid_motion(points, axis, 140.0, shift)
    assert np.linalg.norm(moved[0] - moved[1]) == pytest.approx(np.linalg.norm(points[0] - points[1]))
    assert fusion.rigid_motion(moved - shift, -axis, 140.0, np.zeros(3)) == pytest.approx(points)


def test_the_rays_of_a_camera_come_back_to_their_pixels() -> None:
    camera = fusion.Camera.looking(np.array((3.0, 1.0, 2.0)), np.zeros(3), np.radians(40.0), 30, 20)
    rows, columns = np.mgrid[0:20, 0:30]
    pixels, distance = camera.pixels(camera.place + 2.5 * camera.rays())
    assert pixels == pytest.approx(np.stack([rows.ravel(), columns.ravel()], axis=1), abs=1e-9)
    assert distance == pytest.approx(np.full(600, 2.5))


def ball_ranges(camera: fusion.Camera) -> np.ndarray:
    rays = camera.rays()
    along = -(rays @ camera.place)
    root = along**2 - (camera.place @ camera.place - 1.0)
    return np.where(root > 0, along - np.sqrt(np.maximum(root, 0.0)), np.nan).reshape(camera.height, camera.width)


def test_range_maps_of_a_ball_fuse_to_the_seen_part_of_the_ball() -> None:
    cameras = [
        fusion.Camera.looking(np.array(p), np.zeros(3), np.radians(30.0), 160, 160)
        for p in ((5.0, 0.0, 1.0), (0.0, 5.0, 1.0))
    ]
    vertices, triangles = fusion.fuse(cameras, [ball_ranges(c) for c in cameras], 0.05, 0.12)
    assert np.abs(np.linalg.norm(vertices, axis=1) - 1.0).max() < 0.02
    seen = (vertices @ np.stack([c.place / np.linalg.norm(c.place) for c in cameras]).T).max(axis=1)
    assert seen.min() > 0.1
    _, uses = np.unique(
        np.sort(np.concatenate([triangles[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1), axis=0, return_counts=True
    )
    assert uses.max() == 2
    assert (uses == 1).any()
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    assert (np.einsum("nd,nd->n", np.cross(b - a, c - a), a) > 0).mean() > 0.99


def test_texels_carry_the_weights_of_their_place() -> None:
    uv = np.array([[(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)], [(0.9, 0.1), (0.9, 0.9), (0.1, 0.9)]])
    texel, triangle, weights = raster.rasterize(uv, 64)
    place = np.einsum("nc,ncd->nd", weights, uv[triangle])
    centre = np.stack([texel % 64, texel // 64], axis=1) / 64 + 0.5 / 64
    assert place == pytest.approx(centre, abs=1e-9)
    assert len(np.unique(texel)) == len(texel)
    assert len(texel) == 52 * 52  # texel centres 6.5 ... 57.5 along each side of the square


def test_bleeding_changes_no_painted_texel_and_fills_those_around() -> None:
    image = np.zeros((32, 32, 1))
    painted = np.zeros((32, 32), bool)
    painted[12:20, 12:20] = True
    image[painted] = np.arange(64)[:, None] + 1.0
    spread = raster.bleed(image, painted, 3)
    assert np.array_equal(spread[painted], image[painted])
    assert (spread[9:23, 12:20] > 0).all()
    assert spread[0, 0] == 0


def test_cells_have_one_number_each_and_a_border_between_them() -> None:
    line = np.column_stack([np.linspace(0.0, 3.0, 4000), np.full(4000, 0.3), np.full(4000, 0.7)])
    border, number = paint.cells(line, 0.25)
    changes = np.flatnonzero(np.diff(number) != 0)
    assert len(changes) > 4
    assert border[changes].max() < 0.02
    assert (border >= 0).all()
    assert (number >= 0).all()
    assert (number < 1).all()
