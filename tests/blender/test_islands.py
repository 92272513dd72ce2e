# SPDX-License-Identifier: GPL-3.0-or-later
"""UV islands that are mirrored and lie one upon the other, polygons of six corners, and another triangulation."""

from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
import shapes
from scenes import add_mesh, add_uv, select, uvs, values

NEAR = 0.03
"""Of UVs whose islands are 0.5 wide: a quarter of an edge, by which a bent surface differs from its faces and from
what is unfolded beyond a border; other islands' UVs are farther off but at the corners of the cube."""


def matched_pair(donor_shape: Any, receiver_shape: Any) -> SimpleNamespace:
    """The creature in two triangulations and two poses, six islands on the donor, matched."""
    directions, faces = donor_shape
    own_directions, own_faces = receiver_shape
    donor = add_mesh("Donor", shapes.surface_points(directions), faces)
    corners = directions[faces]
    add_uv(donor, "Stack", shapes.stacked_uv(corners, shapes.sides_of(corners)).reshape(-1, 2))
    receiver = add_mesh("Scan", shapes.pose(shapes.surface_points(own_directions)), own_faces)
    select(donor, receiver)
    assert bpy.ops.object.isograft_match(scale="FIXED") == {"FINISHED"}
    images = matched_directions(donor, receiver, directions)
    return SimpleNamespace(donor=donor, receiver=receiver, corners=images[own_faces], faces=own_faces)


def matched_directions(donor: Any, receiver: Any, directions: np.ndarray) -> np.ndarray:
    """(n, 3) of the points that the receiver's vertices are matched to: how far the match errs is another question."""
    donor.data.calc_loop_triangles()
    triangles = np.array([tuple(triangle.vertices) for triangle in donor.data.loop_triangles])
    weights = values(receiver, "isograft_weights", "vector", 3)
    points = (weights[:, :, None] * directions[triangles[values(receiver, "isograft_face", "value")]]).sum(axis=1)
    return np.asarray(points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-9))


@pytest.fixture(params=["hexagons to triangles", "triangles to hexagons"])
def pair(request: pytest.FixtureRequest) -> SimpleNamespace:
    given, own = shapes.hexagon_sphere(), shapes.triangle_sphere()
    return matched_pair(given, own) if request.param.startswith("hex") else matched_pair(own, given)


def distance_to_islands(found: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(f, 6) how far the farthest corner of each face is from the UVs that each island, continued, has there."""
    every = [shapes.stacked_uv(corners, np.full(len(corners), island)) for island in range(6)]
    return np.stack([np.linalg.norm(found - truth, axis=2).max(axis=1) for truth in every], axis=1)


def test_every_face_lies_in_one_island_and_seams_run_between_them(pair: SimpleNamespace) -> None:
    assert bpy.ops.object.isograft_transfer(what={"UV"}) == {"FINISHED"}
    found = uvs(pair.receiver, "Stack").reshape(*pair.faces.shape, 2)
    filled = np.any(found != 0, axis=(1, 2))
    assert filled.mean() > 0.9
    # There are faces to get wrong: those with corners on two sides of the cube.
    sides = np.abs(pair.corners).argmax(axis=2)
    across = filled & (sides != sides[:, :1]).any(axis=1)
    assert across.sum() > 50
    distance = distance_to_islands(found, pair.corners)
    assert np.all(distance.min(axis=1)[filled] < NEAR)
    # Where only one fits, it is the one that the face lies on, and mirrored as that one is.
    clear = filled & (np.sort(distance, axis=1)[:, 1] > 2 * NEAR) & ~across
    assert clear.mean() > 0.3
    assert np.array_equal(distance.argmin(axis=1)[clear], shapes.sides_of(pair.corners)[clear])
    assert_seams(pair, found, filled)


def assert_seams(pair: SimpleNamespace, found: np.ndarray, filled: np.ndarray) -> None:
    """Marked are those edges at which the UVs of two faces jump."""
    ends: dict[tuple[int, int], list[np.ndarray]] = {}
    for face, uv in zip(pair.faces[filled].tolist(), found[filled], strict=True):
        for corner, vertex in enumerate(face):
            after = (corner + 1) % len(face)
            pair_of = {vertex: uv[corner], face[after]: uv[after]}
            low, high = sorted(pair_of)
            ends.setdefault((low, high), []).append(np.stack([pair_of[low], pair_of[high]]))
    jump = {key for key, both in ends.items() if len(both) == 2 and np.abs(both[0] - both[1]).max() > 1e-4}
    marked = {tuple(sorted(edge.vertices)) for edge in pair.receiver.data.edges if edge.use_seam}
    assert len(jump) > 50
    assert marked == jump
