# SPDX-License-Identifier: GPL-3.0-or-later
"""object.isograft_transfer: seams, colours, materials, and what it leaves alone."""

from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import shapes
from conftest import add_on
from isograft import transfer
from scenes import MatchedPair, add_color, add_uv, select, snapshot, uvs, values


def loops_of(obj: Any) -> tuple[np.ndarray, np.ndarray]:
    """Vertex and polygon of every loop."""
    vertices = np.array([loop.vertex_index for loop in obj.data.loops])
    polygons = np.repeat(np.arange(len(obj.data.polygons)), [polygon.loop_total for polygon in obj.data.polygons])
    return vertices, polygons


def has_uv(obj: Any, name: str) -> np.ndarray:
    """(p,) True for polygons with a UV that is not zero."""
    filled = np.zeros(len(obj.data.polygons), dtype=bool)
    filled[loops_of(obj)[1][np.any(uvs(obj, name) != 0, axis=1)]] = True
    return filled


def graft(matched: MatchedPair, **settings: Any) -> None:
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_transfer(**settings) == {"FINISHED"}


def material(name: str) -> Any:
    return bpy.data.materials.new(name)


def test_uv_maps_arrive_under_their_names(matched: MatchedPair) -> None:
    add_uv(matched.donor, "Second", uvs(matched.donor, "Atlas") * 0.5)
    matched.donor.data.update()
    graft(matched)
    assert [layer.name for layer in matched.receiver.data.uv_layers] == ["Atlas", "Second"]


def test_no_face_spans_two_islands(matched: MatchedPair) -> None:
    graft(matched)
    vertices, polygons = loops_of(matched.receiver)
    filled = has_uv(matched.receiver, "Atlas")
    assert filled.mean() > 0.6
    cells = shapes.uv_cell(uvs(matched.receiver, "Atlas"))
    low, high = np.full(len(filled), 99), np.full(len(filled), -1)
    np.minimum.at(low, polygons, cells)
    np.maximum.at(high, polygons, cells)
    assert np.array_equal(low[filled], high[filled])
    # The receiver is cut above the donor's lowest island: no face of it belongs there.
    _, island = shapes.cube_uv(matched.directions[vertices].reshape(-1, 4, 3))
    assert set(island) == {0, 1, 2, 3, 5}
    assert set(low[filled]) == set(island)


def test_uvs_lie_where_the_truth_has_them(matched: MatchedPair) -> None:
    graft(matched)
    vertices, _ = loops_of(matched.receiver)
    filled = has_uv(matched.receiver, "Atlas")
    corners = matched.directions[vertices].reshape(-1, 4, 3)[filled]
    truth, island = shapes.cube_uv(corners)
    found = uvs(matched.receiver, "Atlas").reshape(-1, 4, 2)[filled]
    same = shapes.uv_cell(found[:, 0]) == island
    assert same.mean() > 0.9
    assert np.median(np.linalg.norm(found - truth, axis=2)[same]) < 0.015


def test_the_operator_writes_the_uvs_that_the_plain_api_returns(matched: MatchedPair) -> None:
    graft(matched)
    donor, receiver = matched.donor.data, matched.receiver.data
    for mesh in (donor, receiver):
        mesh.calc_loop_triangles()
    loops = np.array([tuple(t.loops) for t in donor.loop_triangles])
    own_loops = np.array([tuple(t.loops) for t in receiver.loop_triangles])
    obj = matched.receiver
    weights = values(obj, "isograft_weights", "vector", 3).astype(float)
    face = values(obj, "isograft_face", "value")
    moved = transfer.transfer_corner_uv(
        SimpleNamespace(
            face=face,
            barycentric=weights / np.where(face >= 0, weights.sum(axis=1), 1.0)[:, None],
            vertex=np.where(face >= 0, values(obj, "isograft_vertex", "value"), -1),
        ),
        np.array([tuple(v.co) for v in receiver.vertices]),
        np.array([tuple(t.vertices) for t in receiver.loop_triangles]),
        np.array([tuple(v.co) for v in donor.vertices]),
        np.array([tuple(t.vertices) for t in donor.loop_triangles]),
        uvs(matched.donor, "Atlas")[loops.ravel()],
        receiver_polygons=np.array([t.polygon_index for t in receiver.loop_triangles]),
    )
    written = uvs(obj, "Atlas")[own_loops.ravel()]
    corners = np.repeat(moved.mask, 3)
    # A quad with one triangle unmatched is unmatched as a whole.
    kept = np.any(written != 0, axis=1)
    assert not np.any(kept & ~corners)
    assert np.allclose(written[kept], moved.uv[kept], atol=1e-6)


def test_faces_with_an_unmatched_corner_get_zero_uvs_and_the_report_counts_them(matched: MatchedPair) -> None:
    unmatch(matched, matched.directions[:, 0] > 0.5)
    vertices, polygons = loops_of(matched.receiver)
    prepared = (
        add_on("grafting")
        .prepare(
            matched.donor,
            [matched.receiver],
            bpy.context,
            add_on("grafting").Settings({"UV"}, 0.0, False, False),
        )
        .run(lambda doing, fraction: True)
    )
    graft(matched)
    touched = np.unique(polygons[values(matched.receiver, "isograft_face", "value")[vertices] < 0])
    filled = has_uv(matched.receiver, "Atlas")
    assert len(touched) > 20
    assert not np.any(filled[touched])
    texts = [text for level, text in prepared[0].messages if level == "WARNING"]
    assert texts == [f"Scan: {np.count_nonzero(~filled):,} of {len(filled):,} faces are unmatched; their UVs are 0"]


def unmatch(matched: MatchedPair, rows: np.ndarray) -> None:
    """Take the match away from some vertices."""
    face = np.where(rows, -1, values(matched.receiver, "isograft_face", "value")).astype(np.int32)
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", face)


def test_point_colours_arrive_smoothly_and_zero_where_unmatched(matched: MatchedPair) -> None:
    unmatch(matched, matched.directions[:, 2] > 0.8)
    graft(matched, what={"COLOR"})
    attribute = matched.receiver.data.attributes["Paint"]
    assert (attribute.domain, attribute.data_type) == ("POINT", "FLOAT_COLOR")
    found = values(matched.receiver, "Paint", "color", 4)
    ok = values(matched.receiver, "isograft_face", "value") >= 0
    assert np.median(np.abs(found - shapes.point_color(matched.directions))[ok]) < 0.03
    assert not np.any(found[~ok])


def test_corner_colours_arrive_on_corners(matched: MatchedPair) -> None:
    graft(matched, what={"COLOR"})
    attribute = matched.receiver.data.attributes["Corners"]
    assert (attribute.domain, attribute.data_type) == ("CORNER", "BYTE_COLOR")
    vertices, _ = loops_of(matched.receiver)
    found = values(matched.receiver, "Corners", "color", 4)
    filled = found[:, 3] > 0
    assert filled.mean() > 0.6
    assert np.median(np.abs(found - shapes.point_color(matched.directions[vertices]))[filled]) < 0.03


def test_a_colour_jump_along_faces_is_kept_and_never_mixed(matched: MatchedPair) -> None:
    corners = np.array([tuple(polygon.center) for polygon in matched.donor.data.polygons])
    sides = np.where(corners[:, :1] > 0, [[1.0, 0, 0, 1]], [[0, 0, 1.0, 1]])
    add_color(matched.donor, "Halves", "FLOAT_COLOR", "CORNER", np.repeat(sides, 3, axis=0))
    graft(matched, what={"COLOR"})
    found = values(matched.receiver, "Halves", "color", 4)
    filled = found[:, 3] > 0
    pure = np.isclose(found[filled][:, :3], [1, 0, 0], atol=1e-5).all(axis=1)
    blue = np.isclose(found[filled][:, :3], [0, 0, 1], atol=1e-5).all(axis=1)
    assert np.all(pure | blue)
    assert 0.2 < pure.mean() < 0.8


def test_existing_layers_are_respected_unless_overwriting_is_asked_for(matched: MatchedPair) -> None:
    own = np.full((len(matched.receiver.data.loops), 2), 0.125)
    add_uv(matched.receiver, "Atlas", own)
    add_color(matched.receiver, "Paint", "BYTE_COLOR", "CORNER", np.ones((len(own), 4)))
    graft(matched, what={"UV", "COLOR"})
    assert [layer.name for layer in matched.receiver.data.uv_layers] == ["Atlas", "Atlas.001"]
    assert np.array_equal(uvs(matched.receiver, "Atlas"), own.astype(np.float32))
    assert matched.receiver.data.attributes["Paint"].data_type == "BYTE_COLOR"
    assert matched.receiver.data.attributes["Paint.001"].data_type == "FLOAT_COLOR"
    graft(matched, what={"UV", "COLOR"}, overwrite=True)
    assert len(matched.receiver.data.uv_layers) == 2
    assert not np.allclose(uvs(matched.receiver, "Atlas"), 0.125)
    assert matched.receiver.data.attributes["Paint"].data_type == "FLOAT_COLOR"


def test_low_confidence_counts_as_unmatched_when_asked(matched: MatchedPair) -> None:
    confidence = values(matched.receiver, "isograft_confidence", "value")
    half = np.where(matched.directions[:, 1] > 0, 0.2, np.maximum(confidence, 0.6)).astype(np.float32)
    matched.receiver.data.attributes["isograft_confidence"].data.foreach_set("value", half)
    graft(matched, what={"COLOR"}, min_confidence=0.5)
    found = values(matched.receiver, "Paint", "color", 4)[:, 3] > 0
    assert not found[matched.directions[:, 1] > 0].any()
    assert found[matched.directions[:, 1] <= 0].mean() > 0.6


def test_materials_come_with_uv_maps_face_by_face(matched: MatchedPair) -> None:
    red, blue = material("Red"), material("Blue")
    for one in (red, blue):
        matched.donor.data.materials.append(one)
    centres = np.array([tuple(polygon.center) for polygon in matched.donor.data.polygons])
    matched.donor.data.polygons.foreach_set("material_index", (centres[:, 0] > 0).astype(np.int32))
    matched.donor.data.update()
    unmatch(matched, matched.directions[:, 2] > 0.8)
    graft(matched)
    slots = list(matched.receiver.data.materials)
    assert slots == [None, red, blue]
    index = np.array([polygon.material_index for polygon in matched.receiver.data.polygons])
    filled = has_uv(matched.receiver, "Atlas")
    assert np.all(index[~filled] == 0)
    assert set(index[filled]) == {1, 2}
    vertices, _ = loops_of(matched.receiver)
    first = matched.truth[vertices[::4], 0]
    clear = filled & (np.abs(first) > 0.2)
    assert ((index == 2) == (first > 0))[clear].mean() > 0.95


def test_a_receivers_own_materials_stay_on_unmatched_faces(matched: MatchedPair) -> None:
    own, given = material("Own"), material("Given")
    matched.receiver.data.materials.append(own)
    matched.donor.data.materials.append(given)
    unmatch(matched, matched.directions[:, 2] > 0.8)
    graft(matched)
    assert list(matched.receiver.data.materials) == [own, given]
    index = np.array([polygon.material_index for polygon in matched.receiver.data.polygons])
    assert np.array_equal(index, has_uv(matched.receiver, "Atlas").astype(int))


def test_materials_stay_away_when_not_wanted(matched: MatchedPair) -> None:
    matched.donor.data.materials.append(material("Given"))
    graft(matched, link_materials=False)
    assert len(matched.receiver.data.materials) == 0


def test_the_donor_and_the_match_are_left_as_they_were(matched: MatchedPair) -> None:
    matched.donor.data.materials.append(material("Given"))
    donor = snapshot(matched.donor)
    face = values(matched.receiver, "isograft_face", "value")
    graft(matched, what={"UV", "COLOR"})
    assert snapshot(matched.donor) == donor
    assert np.array_equal(values(matched.receiver, "isograft_face", "value"), face)
    graft(matched, what={"UV"}, overwrite=True)


def test_the_donors_rendered_uv_map_becomes_the_receivers(matched: MatchedPair) -> None:
    add_uv(matched.donor, "Second", uvs(matched.donor, "Atlas") * 0.5)
    matched.donor.data.uv_layers["Second"].active_render = True
    matched.donor.data.materials.append(material("Given"))
    add_uv(matched.receiver, "Own", np.zeros((len(matched.receiver.data.loops), 2)))
    graft(matched)
    assert [layer.name for layer in matched.receiver.data.uv_layers if layer.active_render] == ["Second"]


def test_the_donors_rendered_colour_is_shown_on_a_receiver_without_colours(matched: MatchedPair) -> None:
    colors = matched.donor.data.color_attributes
    colors.render_color_index = colors.find("Corners")
    graft(matched, what={"COLOR"})
    received = matched.receiver.data.color_attributes
    assert received.active_color.name == "Corners"
    assert received[received.render_color_index].name == "Corners"


def test_a_uv_map_finds_a_free_name_beside_an_attribute_of_the_same_name(matched: MatchedPair) -> None:
    matched.receiver.data.attributes.new("Atlas", "FLOAT", "POINT")
    graft(matched)
    assert [layer.name for layer in matched.receiver.data.uv_layers] == ["Atlas.001"]
    assert uvs(matched.receiver, "Atlas.001").any()
    assert matched.receiver.data.attributes["Atlas"].data_type == "FLOAT"
