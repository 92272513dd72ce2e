# SPDX-License-Identifier: GPL-3.0-or-later
"""A match of A to B serves a transfer from A to B as well."""

import bpy
import numpy as np
import rigs
import shapes
from scenes import MatchedPair, add_color, add_uv, select, uvs, values
from test_attributes import add_custom_normals, give
from test_refusals import refused
from textures import atlas, image_at, material, new_image, pixels_of, texture


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


def test_keys_attributes_materials_and_normals_lead_back_too(matched: MatchedPair) -> None:
    scan, (directions, _) = matched.receiver, shapes.triangle_sphere()
    rest, rest_of_scan = shapes.surface_points(directions), matched.truth
    scan.shape_key_add(name="Basis", from_mix=False)
    smiling = shapes.pose(rest_of_scan + rigs.smile(rest_of_scan, matched.directions))
    key = scan.shape_key_add(name="Smile", from_mix=False)
    key.data.foreach_set("co", smiling.astype(np.float32).ravel())
    give(scan, "height", "FLOAT", "POINT", "value", matched.directions[:, 2])
    first = matched.truth[[tuple(polygon.vertices) for polygon in scan.data.polygons]].mean(axis=1)[:, 0]
    give(scan, "half", "STRING", "FACE", "value", ["right" if x > 0 else "left" for x in first])
    for name in ("Left", "Right"):
        scan.data.materials.append(bpy.data.materials.new(name))
    scan.data.polygons.foreach_set("material_index", (first > 0).astype(np.int32))
    add_custom_normals(scan, (0.0, 0.0, 0.7))
    select(scan, matched.donor)
    what = {"KEYS", "ATTRIBUTES", "MATERIALS", "NORMALS"}
    assert bpy.ops.object.isograft_transfer(what=what) == {"FINISHED"}
    found = np.empty(3 * len(directions), dtype=np.float32)
    matched.donor.data.shape_keys.key_blocks["Smile"].data.foreach_get("co", found)
    moved, truth = found.reshape(-1, 3) - rest, rigs.smile(rest, directions)
    ok = (values(matched.donor, "height", "value") != 0) & (np.linalg.norm(truth, axis=1) > 0.02)
    assert ok.sum() > 100
    assert np.sqrt(((moved - truth)[ok] ** 2).sum() / (truth[ok] ** 2).sum()) < 0.25
    height = values(matched.donor, "height", "value")
    assert np.median(np.abs(height - directions[:, 2])[height != 0]) < 0.02
    middle = np.array([tuple(polygon.center) for polygon in matched.donor.data.polygons])[:, 0]
    words = [element.value for element in matched.donor.data.attributes["half"].data]
    words = np.array([word.decode() if isinstance(word, bytes) else word for word in words])
    clear = (words != "") & (np.abs(middle) > 0.1)
    assert clear.mean() > 0.5
    assert np.mean((words == "right")[clear] == (middle > 0)[clear]) > 0.97
    index = np.array([polygon.material_index for polygon in matched.donor.data.polygons])
    names = np.array([made.name if made else "" for made in matched.donor.data.materials])[index]
    assert np.mean((names == "Right")[clear] == (middle > 0)[clear]) > 0.97
    assert matched.donor.data.has_custom_normals


def test_an_image_leads_back_too(matched: MatchedPair) -> None:
    turned(matched)
    made, shader = material("Skin")
    texture(made, new_image("Scanned", atlas(64)), shader.inputs["Base Color"])
    matched.receiver.data.materials.append(made)
    select(matched.receiver, matched.donor)
    assert bpy.ops.object.isograft_bake(size=64, margin=0, uv_map="Atlas") == {"FINISHED"}
    image = pixels_of(image_at(matched.donor.data.materials[-1], "Base Color"))
    painted = image[..., :3].any(axis=2)
    assert painted.mean() > 0.1
    error = np.abs(image - atlas(64))[painted][:, :3]
    assert np.median(error) < 0.03


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
