# SPDX-License-Identifier: GPL-3.0-or-later
"""object.isograft_wrap: the donor's mesh with the receiver's shape."""

from typing import Any

import bpy
import numpy as np
import pytest
import rigs
import shapes
from scenes import MatchedPair, Pair, select, snapshot, uvs, values
from test_refusals import refused


def wrap(pair: Any, **settings: Any) -> Any:
    """Wrap; returns the new object."""
    select(pair.donor, pair.receiver)
    before = set(bpy.data.objects)
    assert bpy.ops.object.isograft_wrap(**settings) == {"FINISHED"}
    (made,) = set(bpy.data.objects) - before
    return made


def points(obj: Any) -> np.ndarray:
    return np.array([tuple(vertex.co) for vertex in obj.data.vertices])


def check(matched: MatchedPair, made: Any) -> None:
    """The donor's vertices lie where the pose takes them; what the scan lacks is marked."""
    directions, _ = shapes.triangle_sphere()
    truth = shapes.pose(shapes.surface_points(directions))
    filled = values(made, "isograft_filled", "value").astype(bool)
    error = np.linalg.norm(points(made) - truth, axis=1)
    assert 0.05 < filled.mean() < 0.5
    assert filled[directions[:, 2] < -0.8].all()
    assert np.median(error[~filled]) < 0.05
    assert np.quantile(error[~filled], 0.95) < 0.2


@pytest.mark.parametrize("method", ["RIGID", "SMOOTH"])
def test_the_donors_mesh_takes_the_receivers_shape(matched: MatchedPair, method: str) -> None:
    before = snapshot(matched.donor), snapshot(matched.receiver)
    made = wrap(matched, method=method)
    assert made.name == "Donor on Scan"
    assert [tuple(p.vertices) for p in made.data.polygons] == [tuple(p.vertices) for p in matched.donor.data.polygons]
    check(matched, made)
    assert (snapshot(matched.donor), snapshot(matched.receiver)) == before
    assert made.matrix_world == matched.receiver.matrix_world


def test_the_new_object_has_what_the_donors_mesh_has(matched: MatchedPair) -> None:
    directions, _ = shapes.triangle_sphere()
    rigs.give_weights(matched.donor, rigs.true_weights(directions))
    matched.donor.data.materials.append(bpy.data.materials.new("Skin"))
    made = wrap(matched)
    assert np.array_equal(uvs(made, "Atlas"), uvs(matched.donor, "Atlas"))
    assert np.allclose(rigs.group_weights(made), rigs.true_weights(directions), atol=1e-6)
    assert [m.name for m in made.data.materials] == ["Skin"]


@pytest.mark.parametrize("back", [False, True])
def test_materials_that_belong_to_the_object_and_shape_keys_do_no_harm(matched: MatchedPair, back: bool) -> None:
    given, got = (matched.receiver, matched.donor) if back else (matched.donor, matched.receiver)
    given.data.materials.append(bpy.data.materials.new("Of the mesh"))
    given.material_slots[0].link = "OBJECT"
    given.material_slots[0].material = bpy.data.materials.new("Of the object")
    given.shape_key_add(name="Basis")
    given.shape_key_add(name="Swell").data[0].co.x += 3.0
    select(given, got)
    assert bpy.ops.object.isograft_wrap() == {"FINISHED"}
    made = bpy.data.objects[f"{given.name} on {got.name}"]
    assert [slot.material.name for slot in made.material_slots] == ["Of the object"]
    assert made.data.shape_keys is None
    truth = matched.truth if back else shapes.pose(shapes.surface_points(shapes.triangle_sphere()[0]))
    ok = ~values(made, "isograft_filled", "value").astype(bool)
    assert np.median(np.linalg.norm(points(made) - truth, axis=1)[ok]) < 0.05


def test_the_completed_part_goes_on_from_the_matched_one(matched: MatchedPair) -> None:
    made = wrap(matched)
    edges = np.array([tuple(edge.vertices) for edge in made.data.edges])
    long = [np.linalg.norm(np.diff(points(obj)[edges], axis=1)[:, 0], axis=1) for obj in (made, matched.donor)]
    filled = values(made, "isograft_filled", "value").astype(bool)[edges].any(axis=1)
    ratio = (long[0] / long[1])[filled]
    assert 0.7 < np.median(ratio) < 1.4
    assert np.quantile(ratio, 0.98) < 3.0


def test_the_way_back_of_a_match_wraps_too(matched: MatchedPair) -> None:
    select(matched.receiver, matched.donor)
    assert bpy.ops.object.isograft_wrap() == {"FINISHED"}
    made = bpy.data.objects["Scan on Donor"]
    ok = ~values(made, "isograft_filled", "value").astype(bool)
    assert ok.mean() > 0.6
    assert np.median(np.linalg.norm(points(made) - matched.truth, axis=1)[ok]) < 0.05


def test_a_mirrored_receiver_is_wrapped_as_it_is_seen(pair: Pair) -> None:
    mirrored = np.array([-1.0, 1.0, 1.0])
    pair.receiver.data.vertices.foreach_set("co", (shapes.pose(pair.truth) * mirrored).astype(np.float32).ravel())
    pair.receiver.data.flip_normals()
    pair.receiver.data.update()
    pair.receiver.scale = mirrored
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_match(preset="fast", scale="FIXED") == {"FINISHED"}
    made = wrap(pair)
    bpy.context.view_layer.update()
    world = points(made) @ np.array(made.matrix_world)[:3, :3].T
    truth = shapes.pose(shapes.surface_points(pair.donor_directions))
    ok = ~values(made, "isograft_filled", "value").astype(bool)
    assert np.median(np.linalg.norm(world - truth, axis=1)[ok]) < 0.05
    # As Blender has it, faces look outward in the object's own space, mirrored or not.
    assert volume(made) > 0
    assert volume(pair.donor) > 0


def volume(obj: Any) -> float:
    obj.data.calc_loop_triangles()
    a, b, c = (points(obj)[[t.vertices[i] for t in obj.data.loop_triangles]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum())


def test_wrapping_without_a_match_or_with_none_of_it_left_is_refused(matched: MatchedPair) -> None:
    count = len(matched.directions)
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", np.full(count, -1, np.int32))
    select(matched.donor, matched.receiver)
    with refused("Scan: no vertex of it is matched"):
        bpy.ops.object.isograft_wrap()
    del matched.receiver["isograft"]
    with refused("Scan has no match"):
        bpy.ops.object.isograft_wrap()
