# SPDX-License-Identifier: GPL-3.0-or-later
"""Seams marked with the UV maps of object.isograft_transfer; unmatched areas filled."""

from typing import Any

import bpy
import numpy as np
import rigs
import shapes
from conftest import add_on
from scenes import MatchedPair, filled_around, select, snapshot, uvs, values


def graft(pair: Any, **settings: Any) -> None:
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(**settings) == {"FINISHED"}


def marked(obj: Any) -> set[tuple[int, ...]]:
    """Vertices of the edges that are marked as seams."""
    return {tuple(sorted(edge.vertices)) for edge in obj.data.edges if edge.use_seam}


def parted(obj: Any, name: str) -> set[tuple[int, ...]]:
    """Vertices of the edges whose two faces, both with UVs, do not agree at both ends."""
    uv = uvs(obj, name)
    seen: dict[tuple[int, ...], dict[int, Any]] = {}
    result = set()
    for polygon in obj.data.polygons:
        loops = list(polygon.loop_indices)
        if not uv[loops].any():
            continue
        for here, ahead in zip(loops, loops[1:] + loops[:1], strict=True):
            ends = {obj.data.loops[i].vertex_index: uv[i] for i in (here, ahead)}
            key = tuple(sorted(ends))
            before = seen.setdefault(key, ends)
            if any(np.abs(before[v] - ends[v]).max() > 1e-5 for v in ends):
                result.add(key)
    return result


def distances(points: np.ndarray) -> np.ndarray:
    """How far directions are from the nearest seam of the atlas: where the two largest coordinates are alike."""
    sorted_ = np.sort(np.abs(points), axis=-1)
    return np.asarray(sorted_[..., 2] - sorted_[..., 1])


def test_edges_along_which_the_islands_part_are_marked(matched: MatchedPair) -> None:
    own = matched.receiver.data.edges[0]
    own.use_seam = True
    before = tuple(sorted(own.vertices))
    graft(matched)
    assert marked(matched.receiver) - {before} == parted(matched.receiver, "Atlas") - {before}
    assert before in marked(matched.receiver)
    ends = np.array(sorted(marked(matched.receiver) - {before}))
    assert len(ends) > 100
    assert np.median(distances(matched.directions[ends]).mean(axis=1)) < 0.12


def test_seams_are_not_marked_when_not_wanted(matched: MatchedPair) -> None:
    graft(matched, mark_seams=False)
    assert not marked(matched.receiver)


def unmatch(matched: MatchedPair, rows: np.ndarray) -> np.ndarray:
    """Take the match away from some vertices; returns who has none now."""
    face = np.where(rows, -1, values(matched.receiver, "isograft_face", "value")).astype(np.int32)
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", face)
    return np.asarray(face < 0)


def test_unmatched_areas_are_filled_only_on_request_and_marked(matched: MatchedPair) -> None:
    directions, _ = shapes.triangle_sphere()
    rigs.give_weights(matched.donor, rigs.true_weights(directions))
    rigs.add_keys(matched.donor, directions)
    middle = np.array([-0.7, 0.6, 0.39])
    gap = unmatch(matched, matched.directions @ middle > 0.93)
    assert gap.sum() > 10
    what = {"UV", "COLOR", "GROUPS", "KEYS"}
    graft(matched, what=what)
    assert "isograft_filled" not in matched.receiver.data.attributes
    assert not rigs.group_weights(matched.receiver)[gap].any()
    graft(matched, what=what, fill=True, overwrite=True)
    filled = values(matched.receiver, "isograft_filled", "value").astype(bool)
    assert np.array_equal(filled, filled_around(matched.receiver, gap))
    color = values(matched.receiver, "Paint", "color", 4)
    hole = matched.directions @ middle > 0.93
    truth = shapes.point_color(matched.directions)
    assert np.abs(color - truth)[hole].max() < 0.2
    weights = rigs.group_weights(matched.receiver)
    assert np.abs(weights - rigs.true_weights(matched.directions))[hole].max() < 0.2
    assert np.all(np.any(uvs(matched.receiver, "Atlas") != 0, axis=1))


def test_marks_of_several_transfers_add_up(matched: MatchedPair) -> None:
    first = unmatch(matched, matched.directions @ np.array([-0.7, 0.6, 0.39]) > 0.93)
    face = values(matched.receiver, "isograft_face", "value")
    graft(matched, what={"COLOR"}, color_names="Paint", fill=True)
    filled = values(matched.receiver, "isograft_filled", "value").astype(bool)
    assert np.array_equal(filled, first)
    # Where the first one had to fill, the second one need not, and the other way round.
    given = np.where(first, 0, face).astype(np.int32)
    given[matched.directions @ np.array([0.0, 0.9, 0.44]) > 0.93] = -1
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", given)
    weights = np.where(first[:, None], 1 / 3, values(matched.receiver, "isograft_weights", "vector", 3))
    matched.receiver.data.attributes["isograft_weights"].data.foreach_set("vector", weights.astype(np.float32).ravel())
    graft(matched, what={"COLOR"}, color_names="Paint", fill=True, overwrite=True)
    both = values(matched.receiver, "isograft_filled", "value").astype(bool)
    assert np.array_equal(both, first | (given < 0))
    assert both.sum() > filled.sum()


def test_faces_are_filled_with_what_lies_nearest(matched: MatchedPair) -> None:
    first = np.array([polygon.center.x for polygon in matched.donor.data.polygons])
    matched.donor.data.attributes.new("piece", "INT", "FACE")
    matched.donor.data.attributes["piece"].data.foreach_set("value", np.where(first > 0, 5, 9).astype(np.int32))
    left, right = bpy.data.materials.new("Left"), bpy.data.materials.new("Right")
    for one in (left, right):
        matched.donor.data.materials.append(one)
    matched.donor.data.polygons.foreach_set("material_index", (first > 0).astype(np.int32))
    matched.donor.data.update()
    hole = matched.directions @ np.array([-0.7, 0.6, 0.39]) > 0.93
    gap = unmatch(matched, hole)
    graft(matched, what={"ATTRIBUTES", "MATERIALS"}, fill=True)
    receiver = matched.receiver.data
    inside = np.array([hole[list(polygon.vertices)].all() for polygon in receiver.polygons])
    assert inside.sum() > 5
    assert set(values(matched.receiver, "piece", "value")) == {5, 9}
    assert set(values(matched.receiver, "piece", "value")[inside]) == {9}
    slots = np.array([polygon.material_index for polygon in receiver.polygons])
    assert {receiver.materials[slot].name for slot in slots[inside]} == {"Left"}
    assert {receiver.materials[slot].name for slot in slots} == {"Left", "Right"}
    filled = values(matched.receiver, "isograft_filled", "value").astype(bool)
    assert filled.any()
    assert not filled[~filled_around(matched.receiver, gap)].any()


def test_custom_normals_are_filled_on_request_and_marked(matched: MatchedPair) -> None:
    for obj in (matched.donor, matched.receiver):
        obj.data.polygons.foreach_set("use_smooth", np.ones(len(obj.data.polygons), dtype=bool))
    if hasattr(matched.donor.data, "use_auto_smooth"):
        matched.donor.data.use_auto_smooth = True
    normals = np.array([tuple(vertex.normal) for vertex in matched.donor.data.vertices])
    matched.donor.data.normals_split_custom_set_from_vertices(normals.tolist())
    matched.donor.data.update()
    gap = unmatch(matched, matched.directions @ np.array([-0.7, 0.6, 0.39]) > 0.93)
    graft(matched, what={"NORMALS"}, fill=True)
    filled = values(matched.receiver, "isograft_filled", "value").astype(bool)
    assert filled.any()
    assert not filled[~filled_around(matched.receiver, gap)].any()
    # The donor's custom normals are its smooth ones: so are the receiver's, in the gap too.
    found = add_on("bridge").read_corner_normals(matched.receiver.data)
    own = np.array([tuple(vertex.normal) for vertex in matched.receiver.data.vertices])
    vertices = np.array([loop.vertex_index for loop in matched.receiver.data.loops])
    inside = gap[vertices]
    assert inside.sum() > 20
    assert np.quantile((found * own[vertices]).sum(axis=1)[inside], 0.1) > 0.9


def test_filling_where_all_is_matched_marks_nothing(matched: MatchedPair) -> None:
    before = snapshot(matched.donor)
    if not unmatch(matched, np.zeros(len(matched.directions), dtype=bool)).any():
        graft(matched, what={"COLOR"}, fill=True)
        assert "isograft_filled" not in matched.receiver.data.attributes
    assert snapshot(matched.donor) == before
