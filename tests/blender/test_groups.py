# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertex groups grafted by object.isograft_transfer, and the armature that uses them."""

from typing import Any

import bpy
import numpy as np
import pytest
import rigs
import shapes
from rigs import BONES, give_weights, group_weights, true_weights
from scenes import QUICK, MatchedPair, add_mesh, receiver_shape, select, values
from test_refusals import refused


@pytest.fixture
def weighted(matched: MatchedPair) -> MatchedPair:
    """A matched pair whose donor has weights."""
    directions, _ = shapes.triangle_sphere()
    give_weights(matched.donor, true_weights(directions))
    return matched


def graft(pair: Any, **settings: Any) -> None:
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(what={"GROUPS"}, **settings) == {"FINISHED"}


def is_matched(pair: Any) -> np.ndarray:
    found: np.ndarray = values(pair.receiver, "isograft_face", "value") >= 0
    return found


def test_weights_lie_where_the_truth_has_them(weighted: MatchedPair) -> None:
    graft(weighted)
    ok = is_matched(weighted)
    assert [group.name for group in weighted.receiver.vertex_groups] == list(BONES)
    found = group_weights(weighted.receiver)
    error = np.abs(found - true_weights(weighted.directions))[ok]
    assert np.median(error) < 0.01
    assert np.mean(error) < 0.03
    assert not found[~ok].any()
    # A mean of weights that sum to 1 sums to 1.
    assert np.allclose(found[ok].sum(axis=1), 1.0, atol=1e-5)


def test_vertices_outside_a_group_stay_outside_of_it(weighted: MatchedPair) -> None:
    graft(weighted)
    arm = weighted.receiver.vertex_groups["Arm"].index
    inside = np.array([any(g.group == arm for g in v.groups) for v in weighted.receiver.data.vertices])
    assert np.array_equal(inside, group_weights(weighted.receiver, ("Arm",))[:, 0] > 0)
    assert 0.05 < inside.mean() < 0.7


def test_groups_that_weigh_nothing_on_the_receiver_arrive_empty(weighted: MatchedPair) -> None:
    """Those that are empty, and those of parts that the scan lacks; own weights go where something else is matched."""
    donor, receiver = weighted.donor, weighted.receiver
    donor.vertex_groups.new(name="Empty")
    deep = int(np.argmin(shapes.triangle_sphere()[0][:, 2]))
    donor.vertex_groups.new(name="Deep").add([deep], 1.0, "ADD")
    own = receiver.vertex_groups.new(name="Empty")
    own.add(list(range(len(receiver.data.vertices))), 0.5, "ADD")
    graft(weighted, overwrite=True)
    assert {"Empty", "Deep", *BONES} == {group.name for group in receiver.vertex_groups}
    ok = is_matched(weighted)
    assert not group_weights(receiver, ("Deep",)).any()
    assert not group_weights(receiver, ("Empty",))[ok].any()
    assert np.allclose(group_weights(receiver, ("Empty",))[~ok], 0.5)


def test_only_the_chosen_groups_arrive(weighted: MatchedPair) -> None:
    graft(weighted, group_names="Arm, L*")
    assert [group.name for group in weighted.receiver.vertex_groups] == ["Arm", "Leg"]


def test_own_groups_keep_their_weights_and_the_donors_get_a_new_name(weighted: MatchedPair) -> None:
    own = np.full((len(weighted.directions), 1), 0.25)
    give_weights(weighted.receiver, own, ("Arm",))
    graft(weighted, group_names="Arm")
    assert [group.name for group in weighted.receiver.vertex_groups] == ["Arm", "Arm.001"]
    assert np.array_equal(group_weights(weighted.receiver, ("Arm",)), own)


@pytest.mark.parametrize(
    ("mode", "factor", "expected"),
    [
        ("REPLACE", 1.0, lambda own, new: new),
        ("REPLACE", 0.25, lambda own, new: 0.75 * own + 0.25 * new),
        ("MIX", 1.0, lambda own, new: 0.5 * (own + new)),
        ("MIX", 0.5, lambda own, new: 0.75 * own + 0.25 * new),
        ("ADD", 1.0, lambda own, new: np.clip(own + new, 0, 1)),
        ("SUBTRACT", 1.0, lambda own, new: np.clip(own - new, 0, 1)),
        ("MULTIPLY", 1.0, lambda own, new: own * new),
        ("ABOVE_THRESHOLD", 0.5, lambda own, new: np.where(own >= 0.5, new, own)),
        ("BELOW_THRESHOLD", 0.5, lambda own, new: np.where(own <= 0.5, new, own)),
    ],
)
def test_mix_modes_work_as_in_blenders_data_transfer(
    weighted: MatchedPair, mode: str, factor: float, expected: Any
) -> None:
    own = np.where(np.arange(len(weighted.directions)) % 2, 0.75, 0.25)[:, None]
    graft(weighted, group_names="Arm")
    new = group_weights(weighted.receiver, ("Arm",))
    weighted.receiver.vertex_groups.clear()
    give_weights(weighted.receiver, own, ("Arm",))
    graft(weighted, group_names="Arm", overwrite=True, mix_mode=mode, mix_factor=factor)
    found = group_weights(weighted.receiver, ("Arm",))
    ok = is_matched(weighted)
    assert np.allclose(found[ok], expected(own, new)[ok], atol=1e-5)
    assert np.array_equal(found[~ok], own[~ok])


def test_locked_groups_stay_as_they_are(weighted: MatchedPair) -> None:
    own = np.full((len(weighted.directions), 1), 0.5)
    give_weights(weighted.receiver, own, ("Arm",))
    weighted.receiver.vertex_groups["Arm"].lock_weight = True
    graft(weighted, overwrite=True, normalise=True)
    found = group_weights(weighted.receiver)
    ok = is_matched(weighted)
    assert np.array_equal(found[:, 1:2], own)
    rest = found[ok][:, [0, 2]].sum(axis=1)
    assert np.allclose(rest[rest > 0], 0.5, atol=1e-5)


def test_limit_and_normalise_leave_few_groups_that_sum_to_one(weighted: MatchedPair) -> None:
    weights = np.random.default_rng(4).random((len(weighted.donor.data.vertices), 3))
    give_weights(weighted.donor, weights)
    graft(weighted, limit_total=2, normalise=True)
    found = group_weights(weighted.receiver)[is_matched(weighted)]
    assert np.all(np.count_nonzero(found, axis=1) == 2)
    assert np.allclose(found.sum(axis=1), 1.0, atol=1e-5)


def test_groups_travel_through_the_donors_subdivision(matched: MatchedPair) -> None:
    directions, faces = shapes.triangle_sphere(6)
    donor = add_mesh("Coarse", shapes.surface_points(directions), faces)
    give_weights(donor, true_weights(directions))
    donor.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    select(donor, matched.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    matched.donor = donor
    graft(matched)
    error = np.abs(group_weights(matched.receiver) - true_weights(matched.directions))[is_matched(matched)]
    assert np.median(error) < 0.03


def test_the_receiver_moves_with_the_rig_as_the_truth_does() -> None:
    directions, faces = shapes.triangle_sphere()
    donor = add_mesh("Donor", shapes.surface_points(directions), faces)
    own_directions, quads = receiver_shape()
    points = shapes.surface_points(own_directions)
    receiver, truth = add_mesh("Scan", points, quads), add_mesh("Truth", points, quads)
    for obj, where in ((donor, directions), (truth, own_directions)):
        give_weights(obj, true_weights(where))
    rig = rigs.add_armature(donor)
    truth.modifiers.new("Armature", "ARMATURE").object = rig
    truth.modifiers[0].use_deform_preserve_volume = True
    select(donor, receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    select(donor, receiver)
    assert bpy.ops.object.isograft_transfer(what={"GROUPS"}, hook_armature=True, normalise=True) == {"FINISHED"}
    assert [item.type for item in receiver.modifiers] == ["ARMATURE"]
    assert receiver.modifiers[0].use_deform_preserve_volume
    ok = values(receiver, "isograft_face", "value") >= 0
    rigs.pose(rig)
    moved = rigs.evaluated(truth)
    assert np.linalg.norm(moved - points, axis=1).max() > 0.5
    error = np.linalg.norm(rigs.evaluated(receiver) - moved, axis=1)[ok]
    assert np.median(error) < 0.01
    assert np.quantile(error, 0.95) < 0.06
    # Posed, the match still fits; and the armature is not hooked up twice.
    select(donor, receiver)
    bpy.ops.object.isograft_transfer(what={"GROUPS"}, hook_armature=True, overwrite=True)
    assert len(receiver.modifiers) == 1


def test_the_armature_is_hooked_up_on_request_only(weighted: MatchedPair) -> None:
    rig = rigs.add_armature(weighted.donor)
    graft(weighted)
    assert not weighted.receiver.modifiers
    graft(weighted, hook_armature=True, overwrite=True)
    assert [(item.type, item.object) for item in weighted.receiver.modifiers] == [("ARMATURE", rig)]


def test_a_donor_without_groups_or_armature_is_refused(matched: MatchedPair) -> None:
    select(matched.donor, matched.receiver)
    with refused("Donor has no vertex group"):
        bpy.ops.object.isograft_transfer(what={"GROUPS"})
    give_weights(matched.donor, np.ones((len(matched.donor.data.vertices), 1)), ("Arm",))
    with refused("Donor has no armature modifier"):
        bpy.ops.object.isograft_transfer(what={"GROUPS"}, hook_armature=True)
    with refused("Donor has no vertex group called Tail; it has: Arm"):
        bpy.ops.object.isograft_transfer(what={"GROUPS"}, group_names="Tail")


def test_bones_whose_groups_are_taken_are_refused_before_anything_is_written(weighted: MatchedPair) -> None:
    rigs.add_armature(weighted.donor)
    give_weights(weighted.receiver, np.ones((len(weighted.directions), 1)), ("Leg",))
    select(weighted.donor, weighted.receiver)
    with refused(r"Scan has vertex groups of its bones already \(Leg\); choose Overwrite"):
        bpy.ops.object.isograft_transfer(what={"GROUPS", "UV"}, hook_armature=True)
