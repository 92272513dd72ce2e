# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape keys grafted by object.isograft_transfer."""

from typing import Any

import bpy
import numpy as np
import pytest
import rigs
import shapes
from scenes import QUICK, MatchedPair, Pair, add_mesh, select, values
from test_refusals import refused

HAS_LOCKS = "lock_shape" in bpy.types.ShapeKey.bl_rna.properties


@pytest.fixture
def keyed(matched: MatchedPair) -> MatchedPair:
    """A matched pair whose donor has keys."""
    directions, _ = shapes.triangle_sphere()
    rigs.add_keys(matched.donor, directions)
    return matched


def graft(pair: Any, **settings: Any) -> None:
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(what={"KEYS"}, **settings) == {"FINISHED"}


def points(obj: Any, name: str) -> np.ndarray:
    """(n, 3) of a key."""
    data = obj.data.shape_keys.key_blocks[name].data
    flat = np.empty(3 * len(data), dtype=np.float32)
    data.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(float)


def is_matched(pair: Any) -> np.ndarray:
    found: np.ndarray = values(pair.receiver, "isograft_face", "value") >= 0
    return found


def true_keys(directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) displacements of Smile and Frown on the receiver: the pose of the donor's keys, less that of its basis."""
    rest = shapes.surface_points(directions)
    smiling = rest + rigs.smile(rest, directions)
    frowning = smiling + rigs.frown(rest, directions)
    posed = [shapes.pose(shape) for shape in (rest, smiling, frowning)]
    return posed[1] - posed[0], posed[2] - posed[1]


def error(found: np.ndarray, truth: np.ndarray, ok: np.ndarray) -> float:
    """Root mean square over the matched vertices, relative to that of the truth."""
    return float(np.sqrt(((found - truth)[ok] ** 2).sum() / (truth[ok] ** 2).sum()))


def test_displacements_arrive_turned_into_the_receivers_pose(keyed: MatchedPair) -> None:
    graft(keyed)
    ok = is_matched(keyed)
    smile, frown = true_keys(keyed.directions)
    basis = points(keyed.receiver, "Basis")
    found = points(keyed.receiver, "Smile") - basis
    assert error(found, smile, ok) < 0.2
    assert error(points(keyed.receiver, "Frown") - points(keyed.receiver, "Smile"), frown, ok) < 0.2
    # Carried over as they stand, they would be wrong by more than their own length.
    rest = shapes.surface_points(keyed.directions)
    assert error(rigs.smile(rest, keyed.directions), smile, ok) > 0.6
    assert not found[~ok].any()


def test_settings_come_along(keyed: MatchedPair) -> None:
    given = keyed.donor.data.shape_keys.key_blocks
    given["Smile"].value = 1.25
    given["Frown"].vertex_group = "Half"
    given["Frown"].interpolation = "KEY_BSPLINE"
    keyed.donor.vertex_groups.new(name="Half").add([0, 1], 1.0, "REPLACE")
    keyed.receiver.vertex_groups.new(name="Half")
    graft(keyed)
    blocks = keyed.receiver.data.shape_keys.key_blocks
    assert list(blocks.keys()) == ["Basis", "Smile", "Frown"]
    smile, frown = blocks["Smile"], blocks["Frown"]
    assert (smile.value, smile.slider_min, smile.slider_max, smile.mute) == (1.25, -0.5, 1.5, False)
    assert (frown.value, frown.mute, frown.vertex_group, frown.interpolation) == (0.0, True, "Half", "KEY_BSPLINE")
    assert (frown.relative_key, smile.relative_key) == (smile, blocks["Basis"])
    # A value moves the receiver; it has not become another mesh by that.
    assert np.abs(rigs.evaluated(keyed.receiver) - points(keyed.receiver, "Basis")).max() > 0.1
    graft(keyed, overwrite=True)


def test_a_mask_that_does_not_come_along_is_worked_in(keyed: MatchedPair) -> None:
    directions, _ = shapes.triangle_sphere()
    rigs.give_weights(keyed.donor, (directions[:, :1] > 0).astype(float), ("Half",))
    keyed.donor.data.shape_keys.key_blocks["Smile"].vertex_group = "Half"
    graft(keyed, key_names="Smile")
    assert not keyed.receiver.data.shape_keys.key_blocks["Smile"].vertex_group
    found = np.linalg.norm(points(keyed.receiver, "Smile") - points(keyed.receiver, "Basis"), axis=1)
    assert found[keyed.directions[:, 0] < -0.15].max() < 1e-4
    assert found.max() > 0.2


def test_drivers_come_along_and_look_at_the_receivers_own_keys(keyed: MatchedPair) -> None:
    donor_keys = keyed.donor.data.shape_keys
    keyed.donor["mood"] = 0.5
    for name, target, path in (
        ("Smile", keyed.donor, '["mood"]'),
        ("Frown", donor_keys, 'key_blocks["Smile"].value'),
    ):
        driver = donor_keys.key_blocks[name].driver_add("value").driver
        variable = driver.variables.new()
        variable.name = "v"
        variable.targets[0].id_type = "KEY" if target == donor_keys else "OBJECT"
        variable.targets[0].id, variable.targets[0].data_path = target, path
        driver.expression = "2 * v"
    keyed.receiver.shape_key_add(name="Basis")
    keyed.receiver.shape_key_add(name="Smile")
    graft(keyed)
    keys = keyed.receiver.data.shape_keys
    curves = {curve.data_path: curve.driver for curve in keys.animation_data.drivers}
    assert set(curves) == {'key_blocks["Smile.001"].value', 'key_blocks["Frown"].value'}
    assert all(driver.expression == "2 * v" for driver in curves.values())
    smile, frown = (curves[f'key_blocks["{name}"].value'].variables[0].targets[0] for name in ("Smile.001", "Frown"))
    assert (smile.id, smile.data_path) == (keyed.donor, '["mood"]')
    assert (frown.id, frown.data_path) == (keys, 'key_blocks["Smile.001"].value')
    keyed.donor["mood"] = 0.3
    keyed.donor.update_tag()
    bpy.context.view_layer.update()
    assert keys.key_blocks["Smile.001"].value == pytest.approx(0.6)
    graft(keyed, overwrite=True, copy_drivers=False)
    assert len(keys.animation_data.drivers) == 2


def test_own_keys_are_respected_unless_overwriting_is_asked_for(keyed: MatchedPair) -> None:
    keyed.receiver.shape_key_add(name="Basis", from_mix=False)
    own = keyed.receiver.shape_key_add(name="Smile", from_mix=False)
    own.data[0].co.x += 5
    mine = points(keyed.receiver, "Smile")
    graft(keyed, key_names="Smile")
    assert list(keyed.receiver.data.shape_keys.key_blocks.keys()) == ["Basis", "Smile", "Smile.001"]
    assert np.array_equal(points(keyed.receiver, "Smile"), mine)
    ok = is_matched(keyed)
    graft(keyed, key_names="Smile", overwrite=True)
    assert len(keyed.receiver.data.shape_keys.key_blocks) == 3
    assert np.allclose(points(keyed.receiver, "Smile")[ok], points(keyed.receiver, "Smile.001")[ok], atol=1e-6)
    assert np.array_equal(points(keyed.receiver, "Smile")[~ok], mine[~ok])


@pytest.mark.skipif(not HAS_LOCKS, reason="this Blender cannot lock shape keys")
def test_locked_keys_are_never_overwritten(keyed: MatchedPair) -> None:
    keyed.receiver.shape_key_add(name="Basis", from_mix=False)
    for name in ("Smile", "Frown"):
        keyed.receiver.shape_key_add(name=name, from_mix=False).data[0].co.x += 5
    blocks = keyed.receiver.data.shape_keys.key_blocks
    blocks["Smile"].lock_shape = True
    mine = {name: points(keyed.receiver, name) for name in ("Smile", "Frown")}
    graft(keyed, overwrite=True)
    assert list(blocks.keys()) == ["Basis", "Smile", "Frown", "Smile.001"]
    assert np.array_equal(points(keyed.receiver, "Smile"), mine["Smile"])
    assert not np.array_equal(points(keyed.receiver, "Frown"), mine["Frown"])
    assert blocks["Smile"].lock_shape


def test_a_receiver_of_another_size_gets_displacements_of_its_size(pair: Pair) -> None:
    rigs.add_keys(pair.donor, pair.donor_directions)
    pair.receiver.data.vertices.foreach_set("co", (0.4 * shapes.pose(pair.truth)).astype(np.float32).ravel())
    pair.receiver.data.update()
    pair.receiver.scale = (5, 5, 5)
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_match(preset="fast") == {"FINISHED"}
    graft(pair, key_names="Smile")
    found = points(pair.receiver, "Smile") - points(pair.receiver, "Basis")
    assert error(found, 0.4 * true_keys(pair.directions)[0], is_matched(pair)) < 0.25


def test_smoothing_calms_the_keys_of_another_character(pair: Pair) -> None:
    """Bumps that only the receiver has turn its skin, and with it what is carried in a frame as small as they are."""
    rigs.add_keys(pair.donor, pair.donor_directions)
    bumps = np.sin(14 * pair.directions).prod(axis=1, keepdims=True)
    body = pair.truth * (1 + 0.08 * bumps)
    pair.receiver.data.vertices.foreach_set("co", body.astype(np.float32).ravel())
    pair.receiver.data.update()
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    truth, errors = rigs.smile(pair.truth, pair.directions), []
    for smoothing in (0, 2, 8):
        graft(pair, key_names="Smile", key_smoothing=smoothing, overwrite=True)
        found = points(pair.receiver, "Smile") - points(pair.receiver, "Basis")
        errors.append(error(found, truth, is_matched(pair)))
    assert errors[2] < 0.9 * errors[1] < 0.9 * errors[0]


def test_keys_travel_through_the_donors_subdivision(matched: MatchedPair) -> None:
    directions, faces = shapes.triangle_sphere(8)
    donor = add_mesh("Coarse", shapes.surface_points(directions), faces)
    rigs.add_keys(donor, directions)
    donor.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    select(donor, matched.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    matched.donor = donor
    graft(matched)
    found = points(matched.receiver, "Smile") - points(matched.receiver, "Basis")
    assert error(found, true_keys(matched.directions)[0], is_matched(matched)) < 0.25
    assert not donor.show_only_shape_key
    assert [block.mute for block in donor.data.shape_keys.key_blocks] == [False, False, True]


def test_donors_without_keys_and_absolute_keys_are_refused(matched: MatchedPair) -> None:
    select(matched.donor, matched.receiver)
    with refused("Donor has no shape key beside a reference"):
        bpy.ops.object.isograft_transfer(what={"KEYS"})
    directions, _ = shapes.triangle_sphere()
    rigs.add_keys(matched.donor, directions)
    with refused("Donor has no shape key called Wink; it has: Smile, Frown"):
        bpy.ops.object.isograft_transfer(what={"KEYS"}, key_names="Wink")
    matched.donor.data.shape_keys.use_relative = False
    with refused("Donor has absolute shape keys; switch Relative on"):
        bpy.ops.object.isograft_transfer(what={"KEYS"})
    matched.donor.data.shape_keys.use_relative = True
    matched.receiver.shape_key_add(name="Basis")
    matched.receiver.data.shape_keys.use_relative = False
    with refused("Scan has absolute shape keys"):
        bpy.ops.object.isograft_transfer(what={"KEYS"})
