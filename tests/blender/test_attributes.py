# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of any type and domain, materials, face sets and custom normals."""

from typing import Any

import bpy
import numpy as np
import pytest
import shapes
from scenes import MatchedPair, add_mesh, select, values
from test_refusals import refused

SHOWS_FACE_SETS = bpy.app.version >= (3, 6, 0)


def give(obj: Any, name: str, data_type: str, domain: str, key: str, data: Any) -> None:
    """An attribute of an object's mesh."""
    obj.data.attributes.new(name, data_type, domain)
    elements = obj.data.attributes[name].data
    if data_type == "STRING":
        as_bytes = isinstance(elements[0].value, bytes)
        for element, value in zip(elements, data, strict=True):
            element.value = value.encode() if as_bytes else value
    else:
        elements.foreach_set(key, np.asarray(data).ravel())


def got(obj: Any, name: str, key: str = "value") -> np.ndarray:
    """An attribute's values, element by element."""
    return np.array([getattr(element, key) for element in obj.data.attributes[name].data])


def graft(pair: Any, *what: str, **settings: Any) -> None:
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(what=set(what), **settings) == {"FINISHED"}


def is_matched(pair: Any) -> np.ndarray:
    found: np.ndarray = values(pair.receiver, "isograft_face", "value") >= 0
    return found


def centres(obj: Any) -> np.ndarray:
    return np.array([tuple(polygon.center) for polygon in obj.data.polygons])


def matched_faces(pair: Any) -> np.ndarray:
    """(p,) True for receiver faces all of whose corners are matched."""
    ok = is_matched(pair)
    return np.array([ok[list(polygon.vertices)].all() for polygon in pair.receiver.data.polygons])


def side_of(directions: np.ndarray) -> np.ndarray:
    return directions[:, 0] > 0


def test_point_attributes_of_every_type_arrive(matched: MatchedPair) -> None:
    directions, _ = shapes.triangle_sphere()
    donor, receiver = matched.donor, matched.receiver
    side = side_of(directions)
    give(donor, "height", "FLOAT", "POINT", "value", directions[:, 2].astype(np.float32))
    give(donor, "direction", "FLOAT_VECTOR", "POINT", "vector", directions.astype(np.float32))
    give(donor, "side", "INT", "POINT", "value", np.where(side, 7, -3).astype(np.int32))
    give(donor, "flag", "BOOLEAN", "POINT", "value", side)
    give(donor, "name", "STRING", "POINT", "value", ["right" if s else "left" for s in side])
    graft(matched, "ATTRIBUTES")
    ok = is_matched(matched)
    assert np.median(np.abs(got(receiver, "height")[ok] - matched.directions[ok, 2])) < 0.02
    vectors = np.array([tuple(v) for v in got(receiver, "direction", "vector")])
    assert np.median(np.linalg.norm(vectors - matched.directions, axis=1)[ok]) < 0.05
    clear = ok & (np.abs(matched.directions[:, 0]) > 0.1)
    truth = side_of(matched.directions)[clear]
    numbers, flags = got(receiver, "side"), got(receiver, "flag")
    # Labels are picked, never mixed.
    assert set(numbers[ok]) == {7, -3}
    assert np.mean((numbers == 7)[clear] == truth) > 0.97
    assert np.mean(flags[clear] == truth) > 0.97
    names = [element.value for element in receiver.data.attributes["name"].data]
    words = np.array([n.decode() if isinstance(n, bytes) else n for n in names])
    assert np.mean((words == "right")[clear] == truth) > 0.97
    for name, empty in (("height", 0), ("side", 0), ("flag", False)):
        assert np.all(got(receiver, name)[~ok] == empty)
    assert not any(words[~ok])


def test_corner_attributes_arrive_on_corners(matched: MatchedPair) -> None:
    corners = np.repeat(np.where(centres(matched.donor)[:, 0] > 0, 5, 9), 3).astype(np.int32)
    give(matched.donor, "piece", "INT", "CORNER", "value", corners)
    graft(matched, "ATTRIBUTES")
    found = got(matched.receiver, "piece").reshape(-1, 4)
    filled = found.any(axis=1)
    assert filled.mean() > 0.6
    # A jump that runs along the donor's edges runs along the receiver's.
    assert np.all(found == found[:, :1])
    assert set(found[filled, 0]) == {5, 9}


def test_face_attributes_arrive_on_faces(matched: MatchedPair) -> None:
    side = np.where(centres(matched.donor)[:, 0] > 0, 5, 9).astype(np.int32)
    give(matched.donor, "piece", "INT", "FACE", "value", side)
    graft(matched, "ATTRIBUTES")
    attribute = matched.receiver.data.attributes["piece"]
    assert (attribute.domain, attribute.data_type) == ("FACE", "INT")
    found = got(matched.receiver, "piece")
    vertices = np.array([tuple(polygon.vertices) for polygon in matched.receiver.data.polygons])
    first = matched.truth[vertices].mean(axis=1)[:, 0]
    clear = (found > 0) & (np.abs(first) > 0.1)
    assert clear.mean() > 0.5
    assert np.mean((found == 5)[clear] == (first > 0)[clear]) > 0.97


def with_twin(matched: MatchedPair) -> np.ndarray:
    """A receiver that is the donor itself, in another pose: every edge has one image. Returns the directions."""
    directions, faces = shapes.triangle_sphere()
    matched.receiver = add_mesh("Twin", shapes.pose(shapes.surface_points(directions)), faces)
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_match(preset="fast", scale="FIXED") == {"FINISHED"}
    return np.asarray(directions)


def ends_of(obj: Any) -> np.ndarray:
    return np.array([tuple(edge.vertices) for edge in obj.data.edges])


def test_edge_attributes_go_on_into_holes_on_request(matched: MatchedPair) -> None:
    directions = with_twin(matched)
    side = np.where(directions[ends_of(matched.donor)].mean(axis=1)[:, 0] > 0, 5, 9).astype(np.int32)
    give(matched.donor, "side", "INT", "EDGE", "value", side)
    hole = directions @ np.array([-0.7, 0.6, 0.39]) > 0.9
    face = np.where(hole, -1, got(matched.receiver, "isograft_face")).astype(np.int32)
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", face)
    inside = hole[ends_of(matched.receiver)].any(axis=1)
    assert inside.sum() > 50
    graft(matched, "ATTRIBUTES")
    assert not got(matched.receiver, "side")[inside].any()
    assert "isograft_filled" not in matched.receiver.data.attributes
    graft(matched, "ATTRIBUTES", fill=True, overwrite=True)
    # What lies beside the hole has no value on a few edges, which goes on too.
    assert set(got(matched.receiver, "side")[inside]) <= {0, 9}
    assert np.mean(got(matched.receiver, "side")[inside] == 9) > 0.9
    assert np.array_equal(got(matched.receiver, "isograft_filled"), face < 0)


def edge_values(obj: Any, name: str) -> np.ndarray:
    """Values of edges that are properties in some versions of Blender and attributes in others."""
    key, dtype = {"crease_edge": ("crease", np.float32), "sharp_edge": ("use_edge_sharp", bool)}[name]
    if key not in bpy.types.MeshEdge.bl_rna.properties:
        return got(obj, name)
    result = np.empty(len(obj.data.edges), dtype=dtype)
    obj.data.edges.foreach_get(key, result)
    return result


def set_edge_values(obj: Any, name: str, data: np.ndarray) -> None:
    key = {"crease_edge": "crease", "sharp_edge": "use_edge_sharp"}[name]
    if key in bpy.types.MeshEdge.bl_rna.properties:
        obj.data.edges.foreach_set(key, data)
        obj.data.update()
    else:
        give(obj, name, "FLOAT", "EDGE", "value", data)


def test_creases_and_sharp_edges_arrive_and_own_ones_stay(matched: MatchedPair) -> None:
    directions = with_twin(matched)
    upper = directions[ends_of(matched.donor)].mean(axis=1)[:, 2] > 0
    set_edge_values(matched.donor, "crease_edge", np.where(upper, 0.75, 0.25).astype(np.float32))
    set_edge_values(matched.donor, "sharp_edge", upper)
    own = np.zeros(len(upper), dtype=bool)
    own[:5] = True
    set_edge_values(matched.receiver, "sharp_edge", own)
    graft(matched, "ATTRIBUTES")
    names = {tuple(pair): row for row, pair in enumerate(np.sort(ends_of(matched.donor), axis=1).tolist())}
    truth = upper[[names[tuple(pair)] for pair in np.sort(ends_of(matched.receiver), axis=1).tolist()]]
    found = edge_values(matched.receiver, "crease_edge")
    assert np.mean(np.isclose(found, np.where(truth, 0.75, 0.25), atol=0.01)) > 0.95
    assert np.array_equal(edge_values(matched.receiver, "sharp_edge"), own)
    assert np.mean(got(matched.receiver, "sharp_edge.001") == truth) > 0.95
    graft(matched, "ATTRIBUTES", overwrite=True, attribute_names="sharp_edge")
    assert np.mean(edge_values(matched.receiver, "sharp_edge") == truth) > 0.95


def test_seam_marks_arrive_if_they_are_named(matched: MatchedPair) -> None:
    directions = with_twin(matched)
    upper = directions[ends_of(matched.donor)].mean(axis=1)[:, 2] > 0
    matched.donor.data.edges.foreach_set("use_seam", upper)
    matched.donor.data.update()
    select(matched.donor, matched.receiver)
    with refused("Donor has no attribute of yours"):
        bpy.ops.object.isograft_transfer(what={"ATTRIBUTES"})
    graft(matched, "ATTRIBUTES", attribute_names="uv_seam")
    names = {tuple(pair): row for row, pair in enumerate(np.sort(ends_of(matched.donor), axis=1).tolist())}
    truth = upper[[names[tuple(pair)] for pair in np.sort(ends_of(matched.receiver), axis=1).tolist()]]
    found = np.array([edge.use_seam for edge in matched.receiver.data.edges])
    assert np.mean(found == truth) > 0.95
    # Marks of its own are respected as any attribute is.
    graft(matched, "ATTRIBUTES", attribute_names="uv_seam")
    assert np.array_equal([edge.use_seam for edge in matched.receiver.data.edges], found)
    assert np.array_equal(got(matched.receiver, "uv_seam.001"), found)


def test_edge_attributes_follow_the_edges(matched: MatchedPair) -> None:
    directions = with_twin(matched)
    ends = ends_of(matched.donor)
    ring = np.all(np.abs(directions[ends][:, :, 2]) < 0.12, axis=1)
    give(matched.donor, "ring", "BOOLEAN", "EDGE", "value", ring)
    graft(matched, "ATTRIBUTES")
    found = got(matched.receiver, "ring")
    key = {tuple(sorted(pair)): value for pair, value in zip(ends_of(matched.receiver).tolist(), found, strict=True)}
    truth = {tuple(sorted(pair)): value for pair, value in zip(ends.tolist(), ring, strict=True)}
    assert np.mean([key[pair] == truth[pair] for pair in truth]) > 0.95
    hit = [key[pair] for pair in truth if truth[pair]]
    assert np.mean(hit) > 0.6


def test_names_that_are_taken_and_names_that_are_chosen(matched: MatchedPair) -> None:
    count = len(matched.donor.data.vertices)
    for name in ("one", "two"):
        give(matched.donor, name, "FLOAT", "POINT", "value", np.ones(count, dtype=np.float32))
    own = np.full(len(matched.directions), 4, dtype=np.int32)
    give(matched.receiver, "one", "INT", "POINT", "value", own)
    graft(matched, "ATTRIBUTES", attribute_names="o*")
    assert np.array_equal(got(matched.receiver, "one"), own)
    assert "one.001" in matched.receiver.data.attributes
    assert "two" not in matched.receiver.data.attributes
    graft(matched, "ATTRIBUTES", overwrite=True)
    assert matched.receiver.data.attributes["one"].data_type == "FLOAT"
    assert not [a.name for a in matched.receiver.data.attributes if a.name.startswith("isograft_filled")]


def test_materials_arrive_face_by_face_without_uv_maps(matched: MatchedPair) -> None:
    red, blue = bpy.data.materials.new("Red"), bpy.data.materials.new("Blue")
    for one in (red, blue):
        matched.donor.data.materials.append(one)
    side = (centres(matched.donor)[:, 0] > 0).astype(np.int32)
    matched.donor.data.polygons.foreach_set("material_index", side)
    own = bpy.data.materials.new("Own")
    matched.receiver.data.materials.append(own)
    graft(matched, "MATERIALS")
    assert list(matched.receiver.data.materials) == [own, red, blue]
    assert not matched.receiver.data.uv_layers
    index = np.array([polygon.material_index for polygon in matched.receiver.data.polygons])
    whole = matched_faces(matched)
    assert np.all(index[~whole] == 0)
    vertices = np.array([tuple(polygon.vertices) for polygon in matched.receiver.data.polygons])
    first = matched.truth[vertices].mean(axis=1)[:, 0]
    clear = whole & (np.abs(first) > 0.1)
    assert np.mean((index == 2)[clear] == (first > 0)[clear]) > 0.97


def add_custom_normals(obj: Any, direction: tuple[float, float, float]) -> None:
    """The object's own smooth normals, all leaning to `direction`."""
    obj.data.polygons.foreach_set("use_smooth", np.ones(len(obj.data.polygons), dtype=bool))
    if hasattr(obj.data, "use_auto_smooth"):
        obj.data.use_auto_smooth = True
    lean = np.array([tuple(v.normal) for v in obj.data.vertices]) + np.array(direction)
    lean /= np.linalg.norm(lean, axis=1, keepdims=True)
    obj.data.normals_split_custom_set_from_vertices(lean.tolist())
    obj.data.update()


def corner_normals(obj: Any) -> np.ndarray:
    if hasattr(obj.data, "corner_normals"):
        return np.array([tuple(n.vector) for n in obj.data.corner_normals])
    obj.data.calc_normals_split()
    return np.array([tuple(loop.normal) for loop in obj.data.loops])


def test_custom_normals_are_turned_with_the_surface(matched: MatchedPair) -> None:
    lean = np.array([0.0, 0.0, 0.7])
    add_custom_normals(matched.donor, tuple(lean))
    matched.receiver.data.polygons.foreach_set("use_smooth", np.ones(len(matched.receiver.data.polygons), dtype=bool))
    matched.receiver.data.update()
    own = np.array([tuple(v.normal) for v in matched.receiver.data.vertices])
    graft(matched, "NORMALS")
    assert matched.receiver.data.has_custom_normals
    vertices = np.array([loop.vertex_index for loop in matched.receiver.data.loops])
    # The truth: the lean of the rest pose, turned by the pose's turning of the surface.
    step = 1e-4
    ahead = (shapes.pose(matched.truth + step * lean / 0.7) - shapes.pose(matched.truth)) / step
    truth = own[vertices] + 0.7 * (ahead / np.linalg.norm(ahead, axis=1, keepdims=True))[vertices]
    truth /= np.linalg.norm(truth, axis=1, keepdims=True)
    whole = np.repeat(matched_faces(matched), 4)
    found = corner_normals(matched.receiver)
    cosine = (found * truth).sum(axis=1)[whole]
    assert np.median(cosine) > 0.98
    assert np.median((own[vertices] * truth).sum(axis=1)[whole]) < 0.95
    select(matched.donor, matched.receiver)
    with refused("Scan has custom normals already; choose Overwrite"):
        bpy.ops.object.isograft_transfer(what={"NORMALS"})


@pytest.mark.skipif(not SHOWS_FACE_SETS, reason="this Blender does not show face sets to add-ons")
def test_face_sets_arrive(matched: MatchedPair) -> None:
    side = np.where(centres(matched.donor)[:, 0] > 0, 5, 9).astype(np.int32)
    give(matched.donor, ".sculpt_face_set", "INT", "FACE", "value", side)
    graft(matched, "FACE_SETS")
    found = got(matched.receiver, ".sculpt_face_set")
    assert set(found) <= {1, 5, 9}
    assert np.mean(found != 1) > 0.6
    vertices = np.array([tuple(polygon.vertices) for polygon in matched.receiver.data.polygons])
    first = matched.truth[vertices].mean(axis=1)[:, 0]
    clear = (found != 1) & (np.abs(first) > 0.1)
    assert np.mean((found == 5)[clear] == (first > 0)[clear]) > 0.97
    with refused("Scan has face sets already; choose Overwrite"):
        bpy.ops.object.isograft_transfer(what={"FACE_SETS"})


def test_a_donor_without_what_is_asked_for_is_refused_by_name(matched: MatchedPair) -> None:
    select(matched.donor, matched.receiver)
    sets = "Donor has no face sets" if SHOWS_FACE_SETS else "does not show the face sets of Donor"
    for what, words in (
        ("ATTRIBUTES", "Donor has no attribute of yours"),
        ("MATERIALS", "Donor has no material"),
        ("NORMALS", "Donor has no custom normals"),
        ("FACE_SETS", sets),
    ):
        # Together with something that is there: still nothing is written.
        with refused(words):
            bpy.ops.object.isograft_transfer(what={what, "UV"})
    give(matched.donor, "here", "FLOAT", "POINT", "value", np.zeros(len(matched.donor.data.vertices), np.float32))
    with refused("Donor has no attribute called there; it has: here"):
        bpy.ops.object.isograft_transfer(what={"ATTRIBUTES"}, attribute_names="there")
