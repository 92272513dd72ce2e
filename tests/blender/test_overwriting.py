# SPDX-License-Identifier: GPL-3.0-or-later
"""Overwrite takes the place of the receiver's own layers where something comes; where nothing is matched they stay."""

from typing import Any

import bpy
import numpy as np
import pytest
from scenes import MatchedPair, add_color, add_uv, select, uvs, values
from test_attributes import (
    SHOWS_FACE_SETS,
    add_custom_normals,
    corner_normals,
    give,
    got,
    graft,
    is_matched,
    matched_faces,
)
from textures import atlas, material, new_image, texture

KEYS = {"POINT": "vertices", "EDGE": "edges", "FACE": "polygons", "CORNER": "loops"}


@pytest.fixture
def holed(matched: MatchedPair) -> MatchedPair:
    """A part of the receiver is unmatched, so that every domain has both."""
    rows = is_matched(matched) & (matched.directions[:, 0] < 0.5)
    face = np.where(rows, values(matched.receiver, "isograft_face", "value"), -1).astype(np.int32)
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", face)
    assert 100 < rows.sum() < len(rows) - 100
    return matched


@pytest.fixture
def textured_hole(holed: MatchedPair) -> MatchedPair:
    made, shader = material("Skin")
    texture(made, new_image("Paint", atlas(32)), shader.inputs["Base Color"])
    holed.donor.data.materials.append(made)
    return holed


def test_long_names_that_are_taken_are_cut_for_their_number(matched: MatchedPair) -> None:
    """Blender's names have 63 bytes, and what is written is looked up by the name that was chosen for it."""
    donor, receiver = matched.donor, matched.receiver
    long = "Ü" * 31 + "x"
    donor.data.uv_layers[0].name = long
    add_uv(receiver, long, np.zeros((len(receiver.data.loops), 2)))
    for obj, value in ((donor, 1.0), (receiver, 0.25)):
        count = len(obj.data.vertices)
        obj.vertex_groups.new(name=long).add(list(range(count)), value, "ADD")
        obj.shape_key_add(name="Basis")
        key = obj.shape_key_add(name=long)
        key.data[0].co.x += value
        add_color(obj, "C" * 63, "FLOAT_COLOR", "POINT", np.full((count, 4), value))
    select(donor, receiver)
    assert bpy.ops.object.isograft_transfer(what={"UV", "COLOR", "GROUPS", "KEYS"}) == {"FINISHED"}
    got_name = "Ü" * 29 + ".001"
    assert [layer.name for layer in receiver.data.uv_layers] == [long, got_name]
    assert [group.name for group in receiver.vertex_groups] == [long, got_name]
    assert [key.name for key in receiver.data.shape_keys.key_blocks] == ["Basis", long, got_name]
    assert {"C" * 63, "C" * 59 + ".001"} <= {layer.name for layer in receiver.data.color_attributes}
    assert not uvs(receiver, long).any()
    assert values(receiver, "C" * 63, "color", 4).max() == pytest.approx(0.25)


def known(pair: Any, domain: str) -> np.ndarray:
    """Elements that are wholly matched."""
    mesh, ok = pair.receiver.data, is_matched(pair)
    if domain == "POINT":
        return ok
    if domain == "EDGE":
        return np.array([ok[list(edge.vertices)].all() for edge in mesh.edges])
    faces = matched_faces(pair)
    return faces if domain == "FACE" else np.repeat(faces, [polygon.loop_total for polygon in mesh.polygons])


def test_uv_maps(holed: MatchedPair) -> None:
    graft(holed, "UV")
    come, ok = uvs(holed.receiver, "Atlas"), known(holed, "CORNER")
    holed.receiver.data.uv_layers["Atlas"].data.foreach_set("uv", np.full(come.size, 0.125, np.float32))
    graft(holed, "UV", overwrite=True)
    assert len(holed.receiver.data.uv_layers) == 1
    assert np.array_equal(uvs(holed.receiver, "Atlas"), np.where(ok[:, None], come, np.float32(0.125)))
    graft(holed, "UV")
    assert np.array_equal(uvs(holed.receiver, "Atlas.001"), come)


def test_a_map_of_the_donors_that_is_baked_into(textured_hole: MatchedPair) -> None:
    pair, ok = textured_hole, known(textured_hole, "CORNER")
    select(pair.donor, pair.receiver)
    add_uv(pair.receiver, "Atlas", np.full((len(ok), 2), 0.125))
    assert bpy.ops.object.isograft_bake(size=32, uv_source="TRANSFERRED", overwrite=True) == {"FINISHED"}
    found = uvs(pair.receiver, "Atlas")
    assert np.array_equal(found[~ok], np.full_like(found[~ok], 0.125)) and not (found[ok] == 0.125).all(axis=1).any()


def test_images(textured_hole: MatchedPair) -> None:
    """What another match has given to faces that this one does not reach."""
    pair = textured_hole
    polygons = len(pair.receiver.data.polygons)
    columns = int(np.ceil(np.sqrt(polygons)))
    row, column = np.divmod(np.arange(polygons), columns)
    square = np.array([[0.1, 0.1], [0.9, 0.1], [0.9, 0.9], [0.1, 0.9]])
    add_uv(pair.receiver, "Own", ((square + np.stack([column, row], 1)[:, None]) / columns).reshape(-1, 2))
    select(pair.donor, pair.receiver)
    settings = {"size": columns, "margin": 0, "overwrite": True}
    assert bpy.ops.object.isograft_bake(**settings) == {"FINISHED"}
    image = bpy.data.images["Scan Base Color"]
    before = np.tile([0.2, 0.4, 0.6, 1.0], (columns**2, 1))
    image.pixels.foreach_set(before.astype(np.float32).ravel())
    assert bpy.ops.object.isograft_bake(**settings) == {"FINISHED"}
    found = np.array(bpy.data.images["Scan Base Color"].pixels[:]).reshape(-1, 4)
    kept = np.isclose(found, before, atol=1e-6).all(axis=1)[row * columns + column]
    assert np.array_equal(kept, ~known(pair, "FACE"))
    # Of another size there is nothing to keep.
    assert bpy.ops.object.isograft_bake(size=64, margin=0, overwrite=True) == {"FINISHED"}
    assert (
        not np.isclose(np.array(bpy.data.images["Scan Base Color"].pixels[:]).reshape(-1, 4), before[0])
        .all(axis=1)
        .any()
    )


@pytest.mark.parametrize(
    ("name", "data_type", "domain"), [("Paint", "FLOAT_COLOR", "POINT"), ("Corners", "BYTE_COLOR", "CORNER")]
)
def test_colours(holed: MatchedPair, name: str, data_type: str, domain: str) -> None:
    ok = known(holed, domain)
    own = np.tile([0.25, 0.5, 0.75, 1.0], (len(ok), 1))
    add_color(holed.receiver, name, data_type, domain, own)
    before = values(holed.receiver, name, "color", 4)
    graft(holed, "COLOR", color_names=name)
    graft(holed, "COLOR", color_names=name, overwrite=True)
    found, come = (values(holed.receiver, key, "color", 4) for key in (name, f"{name}.001"))
    assert np.array_equal(found, np.where(ok[:, None], come, before))
    assert not np.array_equal(found, come)


@pytest.mark.parametrize("domain", KEYS)
@pytest.mark.parametrize("data_type", ["FLOAT", "INT", "BOOLEAN", "STRING"])
def test_attributes(holed: MatchedPair, domain: str, data_type: str) -> None:
    make = {"FLOAT": float, "INT": int, "BOOLEAN": lambda i: i == 10**6, "STRING": str}[data_type]
    count = len(getattr(holed.donor.data, KEYS[domain]))
    give(holed.donor, "mine", data_type, domain, "value", [make(i) for i in range(count)])
    ok = known(holed, domain)
    give(holed.receiver, "mine", data_type, domain, "value", [make(10**6) for _ in ok])
    before = got(holed.receiver, "mine")
    graft(holed, "ATTRIBUTES", attribute_names="mine")
    graft(holed, "ATTRIBUTES", attribute_names="mine", overwrite=True)
    found, come = got(holed.receiver, "mine"), got(holed.receiver, "mine.001")
    if domain == "FACE":
        # Of a face on the border the middle decides.
        assert np.array_equal(found[ok], come[ok])
        ok = found != before
    assert np.array_equal(found, np.where(ok, come, before))
    assert not np.array_equal(found, come) and not np.array_equal(found, before)


def test_attributes_of_another_type_have_nothing_to_keep(holed: MatchedPair) -> None:
    give(holed.donor, "mine", "INT", "POINT", "value", np.ones(len(holed.donor.data.vertices), np.int32))
    give(holed.receiver, "mine", "FLOAT", "FACE", "value", np.ones(len(holed.receiver.data.polygons), np.float32))
    graft(holed, "ATTRIBUTES", attribute_names="mine", overwrite=True)
    assert holed.receiver.data.attributes["mine"].data_type == "INT"
    assert np.array_equal(got(holed.receiver, "mine"), is_matched(holed).astype(int))


def test_custom_normals(holed: MatchedPair) -> None:
    add_custom_normals(holed.donor, (0.0, 0.0, 0.7))
    add_custom_normals(holed.receiver, (0.9, 0.0, 0.0))
    own, ok = corner_normals(holed.receiver), known(holed, "CORNER")
    graft(holed, "NORMALS", overwrite=True)
    found = corner_normals(holed.receiver)
    assert np.abs(found - own)[~ok].max() < 2e-3
    assert np.median(np.linalg.norm(found - own, axis=1)[ok]) > 0.1


@pytest.mark.skipif(not SHOWS_FACE_SETS, reason="this Blender does not show face sets to add-ons")
def test_face_sets(holed: MatchedPair) -> None:
    give(holed.donor, ".sculpt_face_set", "INT", "FACE", "value", np.full(len(holed.donor.data.polygons), 3, np.int32))
    ok = known(holed, "FACE")
    give(holed.receiver, ".sculpt_face_set", "INT", "FACE", "value", np.full(len(ok), 7, np.int32))
    graft(holed, "FACE_SETS", overwrite=True)
    found = got(holed.receiver, ".sculpt_face_set")
    assert (found[ok] == 3).all() and (found[~ok] == 7).any()
