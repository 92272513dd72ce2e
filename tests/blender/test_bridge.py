# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes as arrays, with the way back."""

import math

import bpy
import numpy as np
import pytest
import shapes
from conftest import add_on
from scenes import add_mesh, snapshot

BOX = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def depsgraph():  # type: ignore[no-untyped-def]
    bpy.context.view_layer.update()
    return bpy.context.evaluated_depsgraph_get()


def volume(vertices: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def test_quads_and_n_gons_become_loop_triangles_with_the_way_back() -> None:
    ring = [(math.cos(t), math.sin(t), 0.0) for t in np.linspace(0, 2 * math.pi, 7, endpoint=False)]
    obj = add_mesh("Fan", [*ring, (3, 0, 0), (4, 0, 0), (4, 1, 0), (3, 1, 0)], [range(7), (7, 8, 9, 10)])
    arrays = add_on("bridge").read_donor(obj, depsgraph())
    assert arrays.triangles.shape == (5 + 2, 3)
    assert arrays.triangle_polygons.tolist() == [0] * 5 + [1] * 2
    assert arrays.loop_polygons.tolist() == [0] * 7 + [1] * 4
    loop_vertices = np.array([loop.vertex_index for loop in obj.data.loops])
    assert np.array_equal(loop_vertices[arrays.triangle_loops], arrays.triangles)


def test_a_surface_is_the_mesh_itself_however_the_object_is_moved_and_turned() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.location, obj.rotation_euler = (5, -3, 2), (0.3, 1.1, -2.0)
    vertices, triangles = add_on("bridge").read_donor(obj, depsgraph()).surface()
    assert np.array_equal(vertices, BOX)
    assert volume(vertices, triangles) == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [(-1, 1, 1), (-2, -1, -1), (1, -3, 1)])
def test_a_negative_scale_flips_the_winding_and_keeps_the_surface_as_seen(scale: tuple[float, ...]) -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.scale, obj.rotation_euler = scale, (0.4, -0.7, 1.9)
    arrays = add_on("bridge").read_donor(obj, depsgraph())
    assert arrays.is_mirrored
    vertices, triangles = arrays.surface()
    world = np.array(obj.matrix_world)
    seen = BOX @ world[:3, :3].T
    assert volume(vertices, triangles) == pytest.approx(abs(np.prod(scale)), rel=1e-5)
    # Up to a rotation it is what is seen in the scene, and not its mirror image.
    turn, *_ = np.linalg.lstsq(vertices, seen, rcond=None)
    assert np.allclose(vertices @ turn, seen, atol=1e-5)
    assert np.linalg.det(turn) == pytest.approx(1.0, abs=1e-5)


def test_weights_of_a_mirrored_surface_lead_back_to_the_loop_triangles_corners() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.scale = (1, 1, -1)
    arrays = add_on("bridge").read_donor(obj, depsgraph())
    weights = np.random.default_rng(1).dirichlet((1, 1, 1), len(arrays.triangles))
    _, triangles = arrays.surface()
    expected = np.einsum("nc,ncd->nd", weights, arrays.vertices[triangles])
    found = np.einsum("nc,ncd->nd", arrays.in_loop_order(weights), arrays.vertices[arrays.triangles])
    assert np.allclose(found, expected)


def test_a_non_uniform_scale_shapes_the_surface_as_it_is_seen() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.scale, obj.rotation_euler = (2, 1, 0.5), (0.2, 0.5, 0.1)
    vertices, _ = add_on("bridge").read_donor(obj, depsgraph()).surface()
    world = BOX @ np.array(obj.matrix_world)[:3, :3].T
    lengths = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    assert np.allclose(lengths, np.linalg.norm(world[:, None] - world[None], axis=2), atol=1e-5)


def test_a_scale_of_zero_is_refused_by_name() -> None:
    obj = add_mesh("Flat", BOX, SIDES)
    obj.scale = (1, 0, 1)
    bridge = add_on("bridge")
    with pytest.raises(bridge.RefusedError, match="Flat is scaled to nothing"):
        bridge.read_donor(obj, depsgraph())


def test_the_donor_is_read_with_modifiers_and_shape_keys() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Tall")
    for point in key.data:
        point.co.z *= 3
    key.value = 0.5
    obj.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    arrays = add_on("bridge").read_donor(obj, depsgraph())
    assert len(arrays.vertices) == 26
    assert arrays.vertices[:, 2].max() == pytest.approx(2.0)


def test_a_receiver_is_read_evaluated_while_its_vertex_count_holds() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    cast = obj.modifiers.new("Cast", "CAST")
    cast.factor = 1.0
    arrays = add_on("bridge").read_receiver(obj, depsgraph())
    assert not arrays.warnings
    assert not np.allclose(arrays.vertices, BOX)


def test_a_receiver_whose_modifiers_add_vertices_is_read_without_them_and_says_so() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.modifiers.new("Subdivision", "SUBSURF")
    arrays = add_on("bridge").read_receiver(obj, depsgraph())
    assert np.array_equal(arrays.vertices, BOX)
    assert "Box: its modifiers change the number of vertices" in arrays.warnings[0]


def test_a_receivers_faces_are_its_own_even_if_modifiers_cut_them() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.modifiers.new("Triangulate", "TRIANGULATE")
    arrays = add_on("bridge").read_receiver(obj, depsgraph())
    assert len(arrays.loop_polygons) == 24
    assert arrays.triangle_loops.max() < len(obj.data.loops)


def test_the_hash_follows_positions_and_faces_but_not_transform_or_attributes() -> None:
    directions, triangles = shapes.triangle_sphere(2)
    obj = add_mesh("Ball", directions, triangles)
    read = add_on("bridge").read_donor
    before = read(obj, depsgraph()).content_hash
    obj.location, obj.scale = (1, 2, 3), (2, 2, 2)
    obj.data.attributes.new("mine", "FLOAT", "POINT")
    assert read(obj, depsgraph()).content_hash == before
    obj.data.vertices[7].co.x += 1e-5
    obj.data.update()
    moved = read(obj, depsgraph()).content_hash
    assert moved != before
    obj.data.vertices[7].co = directions[7]
    obj.data.update()
    assert read(obj, depsgraph()).content_hash == before
    assert read(add_mesh("Ball", directions, triangles[::-1]), depsgraph()).content_hash != before


def test_reading_changes_nothing() -> None:
    obj = add_mesh("Box", BOX, SIDES)
    obj.modifiers.new("Subdivision", "SUBSURF")
    before, meshes = snapshot(obj), len(bpy.data.meshes)
    for read in (add_on("bridge").read_donor, add_on("bridge").read_receiver):
        read(obj, depsgraph())
    assert snapshot(obj) == before
    assert len(bpy.data.meshes) == meshes
