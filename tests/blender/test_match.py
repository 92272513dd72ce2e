# SPDX-License-Identifier: GPL-3.0-or-later
"""object.isograft_match against the plain API, and what it writes."""

from typing import Any

import bpy
import isograft
import numpy as np
import pytest
import shapes
from conftest import add_on
from scenes import QUICK, MatchedPair, Pair, add_mesh, select, snapshot, values

TYPES = {
    "isograft_face": ("INT", "value", 1),
    "isograft_weights": ("FLOAT_VECTOR", "vector", 3),
    "isograft_position": ("FLOAT_VECTOR", "vector", 3),
    "isograft_vertex": ("INT", "value", 1),
    "isograft_confidence": ("FLOAT", "value", 1),
    "isograft_stretch": ("FLOAT", "value", 1),
    "isograft_region": ("INT", "value", 1),
}


def written(obj: Any) -> dict[str, np.ndarray]:
    return {name: values(obj, name, key, width) for name, (_, key, width) in TYPES.items()}


def plain(obj: Any) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and loop triangles, read without the add-on's bridge."""
    obj.data.calc_loop_triangles()
    vertices = np.array([tuple(vertex.co) for vertex in obj.data.vertices])
    return vertices, np.array([tuple(triangle.vertices) for triangle in obj.data.loop_triangles])


def errors(pair: Any, obj: Any | None = None) -> np.ndarray:
    """Distance of the written positions from the truth, over the square root of the donor's area, times 100."""
    found = written(obj or pair.receiver)
    vertices, triangles = plain(pair.donor)
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    matched = found["isograft_face"] >= 0
    return 100 * np.linalg.norm(found["isograft_position"] - pair.truth, axis=1)[matched] / np.sqrt(area)


def test_the_operator_writes_what_the_plain_api_returns(matched: MatchedPair) -> None:
    best = isograft.match(plain(matched.receiver), plain(matched.donor)).best
    found = written(matched.receiver)
    ok = best.face >= 0
    assert ok.mean() > 0.5
    assert np.array_equal(found["isograft_face"], best.face)
    assert np.array_equal(found["isograft_vertex"][ok], best.vertex[ok])
    assert np.array_equal(found["isograft_region"][ok], best.region[ok])
    assert np.allclose(found["isograft_weights"][ok], best.barycentric[ok], atol=1e-6)
    assert np.allclose(found["isograft_position"][ok], best.points[ok], atol=1e-5)
    assert np.allclose(found["isograft_confidence"], best.confidence, atol=1e-6)
    assert np.allclose(found["isograft_stretch"][ok], np.nan_to_num(best.stretch[ok]), atol=1e-6)


def test_positions_lie_near_the_truth(matched: MatchedPair) -> None:
    found = errors(matched)
    assert len(found) > 0.75 * len(matched.truth)
    assert np.median(found) < 3.0


def test_attributes_have_the_names_and_types_of_the_contract(matched: MatchedPair) -> None:
    ours = {a.name: (a.data_type, a.domain) for a in matched.receiver.data.attributes if a.name.startswith("isograft")}
    assert ours == {name: (data_type, "POINT") for name, (data_type, *_) in TYPES.items()}
    assert not [a.name for a in matched.donor.data.attributes if a.name.startswith("isograft")]


def test_unmatched_vertices_hold_zeros_and_face_minus_one() -> None:
    matching, bridge = add_on("matching"), add_on("bridge")
    donor = add_mesh("Triangle", np.eye(3), [(0, 1, 2)])
    arrays = bridge.read_donor(donor, bpy.context.evaluated_depsgraph_get())
    nan = np.nan
    correspondence = isograft.Correspondence(
        face=np.array([0, -1], np.int32),
        barycentric=np.array([[0.2, 0.3, 0.5], [nan] * 3]),
        points=np.array([[0.2, 0.3, 0.5], [nan] * 3]),
        vertex=np.array([2, -1], np.int32),
        confidence=np.array([0.7, 0.0]),
        stretch=np.array([0.1, nan]),
        region=np.array([0, -1], np.int32),
        corners=np.array([[0, 1, 2], [-1] * 3], np.int32),
        target_size=3,
    )
    found = matching.attributes(arrays, correspondence)
    assert set(found) == set(TYPES)
    assert found["isograft_face"].tolist() == [0, -1]
    assert np.allclose(found["isograft_position"][0], [0.2, 0.3, 0.5])
    for name in set(TYPES) - {"isograft_face"}:
        assert not np.any(found[name][1]), name


def test_the_id_property_tells_donor_hashes_version_options_and_scale(matched: MatchedPair) -> None:
    content = matched.receiver["isograft"].to_dict()
    read = add_on("bridge")
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert content["donor"] == "Donor"
    assert content["donor_hash"] == read.read_donor(matched.donor, depsgraph).content_hash
    assert content["receiver_hash"] == read.read_receiver(matched.receiver, depsgraph).content_hash
    assert content["version"] == isograft.__version__
    assert content["options"] == {"preset": "default", "scale": "auto", "seed": 0}
    assert content["scale"] == pytest.approx(1.0, rel=0.1)


def test_matching_leaves_everything_else_as_it_was(pair: Pair) -> None:
    donor, receiver = snapshot(pair.donor), snapshot(pair.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    after = snapshot(pair.receiver)
    after["attributes"] = [a for a in after["attributes"] if not a[0].startswith("isograft_")]
    after["properties"].remove("isograft")
    assert after == receiver
    assert snapshot(pair.donor) == donor


def test_set_options_reach_the_engine_and_the_id_property(pair: Pair) -> None:
    bpy.ops.object.isograft_match(
        preset="fast", scale="VALUE", scale_value=1.25, seed=3, threads=1, growth_stretch_limit=0.4
    )
    options = pair.receiver["isograft"]["options"].to_dict()
    assert options.pop("growth_stretch_limit") == pytest.approx(0.4)
    assert options == {"preset": "fast", "scale": 1.25, "seed": 3, "threads": 1}
    assert pair.receiver["isograft"]["scale"] == pytest.approx(1.25)


def test_several_receivers_are_matched_each_on_its_own(pair: Pair) -> None:
    directions, triangles = shapes.triangle_sphere(13)
    turned = shapes.surface_points(directions)[:, [1, 2, 0]] + 3
    second = add_mesh("Second", turned, triangles)
    select(pair.donor, pair.receiver, second)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    for obj in (pair.receiver, second):
        assert obj["isograft"]["donor"] == "Donor"
        assert len(written(obj)["isograft_face"]) == len(obj.data.vertices)
    pair.truth = shapes.surface_points(directions)
    assert np.median(errors(pair, second)) < 3.0


def test_a_mirrored_object_is_matched_as_it_is_seen(pair: Pair) -> None:
    mirrored = np.array([-1.0, 1.0, 1.0])
    pair.receiver.data.vertices.foreach_set("co", (shapes.pose(pair.truth) * mirrored).ravel())
    pair.receiver.data.flip_normals()
    pair.receiver.data.update()
    pair.receiver.scale = mirrored
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    found = errors(pair)
    assert len(found) > 0.6 * len(pair.truth)
    assert np.median(found) < 3.0


def test_a_mirrored_donor_gives_weights_of_its_own_loop_triangles(pair: Pair) -> None:
    pair.donor.data.vertices.foreach_set("co", (shapes.surface_points(pair.donor_directions) * [1, -1, 1]).ravel())
    pair.donor.data.flip_normals()
    pair.donor.data.update()
    pair.donor.scale = (1, -1, 1)
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    found = written(pair.receiver)
    vertices, triangles = plain(pair.donor)
    ok = found["isograft_face"] >= 0
    points = np.einsum("nc,ncd->nd", found["isograft_weights"][ok], vertices[triangles[found["isograft_face"][ok]]])
    assert np.allclose(points, found["isograft_position"][ok], atol=1e-5)
    pair.truth = pair.truth * [1, -1, 1]
    assert np.median(errors(pair)) < 3.0


def test_matching_again_replaces_the_attributes_instead_of_adding_more(matched: MatchedPair) -> None:
    names = sorted(attribute.name for attribute in matched.receiver.data.attributes)
    matched.receiver.data.attributes.remove(matched.receiver.data.attributes["isograft_face"])
    matched.receiver.data.attributes.new("isograft_face", "FLOAT", "FACE")
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    assert sorted(attribute.name for attribute in matched.receiver.data.attributes) == names
    assert matched.receiver.data.attributes["isograft_face"].data_type == "INT"


def test_unequal_surfaces_do_not_end_in_an_error(pair: Pair) -> None:
    directions, triangles = shapes.triangle_sphere(8)
    flat = np.stack([directions[:, 0] * 5, directions[:, 1], 0.2 * directions[:, 2]], axis=1)
    other = add_mesh("Pebble", flat, triangles)
    select(pair.donor, other)
    assert bpy.ops.object.isograft_match(**QUICK) == {"FINISHED"}
    assert len(written(other)["isograft_face"]) == len(directions)
