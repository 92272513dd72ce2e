# SPDX-License-Identifier: GPL-3.0-or-later
"""A match of A to B serves a transfer from A to B as well."""

import bpy
import numpy as np
import rigs
import shapes
from scenes import MatchedPair, add_color, add_uv, select, uvs, values
from test_refusals import refused


def turned(matched: MatchedPair) -> np.ndarray:
    """Give the scan what it can give, select it as the donor, and return the directions of the new receiver."""
    add_color(matched.receiver, "Scanned", "FLOAT_COLOR", "POINT", shapes.point_color(matched.directions))
    rigs.give_weights(matched.receiver, rigs.true_weights(matched.directions))
    vertices = np.array([loop.vertex_index for loop in matched.receiver.data.loops])
    uv, _ = shapes.cube_uv(matched.directions[vertices].reshape(-1, 4, 3))
    add_uv(matched.receiver, "ScanMap", uv.reshape(-1, 2))
    select(matched.receiver, matched.donor)
    directions, _ = shapes.triangle_sphere()
    return directions


def test_the_receiver_of_a_match_gives_to_its_donor(matched: MatchedPair) -> None:
    directions = turned(matched)
    what = {"COLOR", "GROUPS", "UV"}
    assert bpy.ops.object.isograft_transfer(what=what) == {"FINISHED"}
    found = values(matched.donor, "Scanned", "color", 4)
    ok = found[:, 3] > 0
    # All but the part that the scan lacks.
    assert ok.mean() > 0.6
    assert not ok[directions[:, 2] < -0.8].any()
    assert np.median(np.abs(found - shapes.point_color(directions))[ok]) < 0.03
    weights = rigs.group_weights(matched.donor)
    assert np.median(np.abs(weights - rigs.true_weights(directions))[ok]) < 0.02
    vertices = np.array([loop.vertex_index for loop in matched.donor.data.loops])
    truth, _ = shapes.cube_uv(directions[vertices].reshape(-1, 3, 3))
    uv = uvs(matched.donor, "ScanMap")
    filled = np.any(uv != 0, axis=1)
    same = shapes.uv_cell(uv) == shapes.uv_cell(truth.reshape(-1, 2))
    assert np.median(np.linalg.norm(uv - truth.reshape(-1, 2), axis=1)[filled & same]) < 0.02


def test_modifiers_of_the_scan_do_no_harm_to_the_way_back(matched: MatchedPair) -> None:
    matched.receiver.modifiers.new("Triangulate", "TRIANGULATE")
    turned(matched)
    assert bpy.ops.object.isograft_transfer(what={"COLOR", "GROUPS", "UV"}) == {"FINISHED"}


def test_a_match_whose_objects_were_edited_does_not_lead_back(matched: MatchedPair) -> None:
    turned(matched)
    matched.receiver.data.vertices[3].co.z += 0.01
    matched.receiver.data.update()
    with refused("Scan was edited after it was matched to Donor; run Match again"):
        bpy.ops.object.isograft_transfer(what={"COLOR"})
    matched.receiver.data.vertices[3].co.z -= 0.01
    matched.donor.data.vertices[3].co.z += 0.01
    matched.donor.data.update()
    with refused("Donor was edited after Scan was matched to it; run Match again"):
        bpy.ops.object.isograft_transfer(what={"COLOR"})


def test_a_donor_whose_modifiers_add_vertices_is_no_receiver_of_its_match(matched: MatchedPair) -> None:
    matched.donor.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_match(preset="fast", scale="FIXED") == {"FINISHED"}
    turned(matched)
    with refused("Donor: its modifiers change the number of vertices, so the match of Scan does not lead back"):
        bpy.ops.object.isograft_transfer(what={"COLOR"})
