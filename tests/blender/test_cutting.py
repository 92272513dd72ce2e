# SPDX-License-Identifier: GPL-3.0-or-later
"""Receiver faces cut along the donor's seams, with all that they carry."""

from typing import Any

import bpy
import numpy as np
import pytest
import rigs
import shapes
from conftest import add_on
from isograft import transfer
from scenes import MatchedPair, add_color, add_uv, select, snapshot, uvs, values
from test_refusals import refused

GRADIENT = np.array([[0.11, -0.07, 0.05], [0.04, 0.06, -0.09]])


def graft(pair: Any, **settings: Any) -> None:
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(**settings) == {"FINISHED"}


def points(obj: Any) -> np.ndarray:
    return np.array([tuple(vertex.co) for vertex in obj.data.vertices])


def loop_vertices(obj: Any) -> np.ndarray:
    return np.array([loop.vertex_index for loop in obj.data.loops])


def corner_directions(matched: MatchedPair) -> np.ndarray:
    directions, faces = shapes.triangle_sphere()
    assert len(faces) == len(matched.donor.data.polygons)
    return np.asarray(directions[faces].reshape(-1, 3))


def area(obj: Any) -> float:
    return float(sum(polygon.area for polygon in obj.data.polygons))


def linear(places: np.ndarray, width: int) -> np.ndarray:
    """Values that are linear in space: what lies on a straight edge is known exactly."""
    return np.resize(0.5 + places @ GRADIENT.T, (len(places), 2))[:, np.arange(width) % 2]


def furnish(obj: Any) -> None:
    """UVs, colours, groups, keys, materials and attributes of its own."""
    where = points(obj)
    add_uv(obj, "Own", linear(where, 2)[loop_vertices(obj)])
    add_color(obj, "Own Paint", "FLOAT_COLOR", "POINT", linear(where, 4))
    rigs.give_weights(obj, 0.5 * linear(where, 1), ("Own Group",))
    obj.vertex_groups["Own Group"].lock_weight = True
    for name in ("Basis", "Grown"):
        obj.shape_key_add(name=name, from_mix=False)
    grown = where + 0.1 * linear(where, 3)
    obj.data.shape_keys.key_blocks["Grown"].data.foreach_set("co", grown.astype(np.float32).ravel())
    obj.data.shape_keys.key_blocks["Grown"].mute = True
    for name in ("One", "Other"):
        obj.data.materials.append(bpy.data.materials.new(name))
    pieces = np.array([polygon.center.x > 4.0 for polygon in obj.data.polygons])
    obj.data.polygons.foreach_set("material_index", pieces.astype(np.int32))
    obj.data.attributes.new("piece", "INT", "FACE")
    obj.data.attributes["piece"].data.foreach_set("value", np.where(pieces, 7, 3).astype(np.int32))
    obj.data.update()


def test_cutting_puts_receiver_edges_onto_the_donors_seams(matched: MatchedPair) -> None:
    obj = matched.receiver
    before, faces, size = points(obj), len(obj.data.polygons), area(obj)
    graft(matched, cut_seams=True)
    assert len(obj.data.polygons) > faces + 50
    assert np.array_equal(points(obj)[: len(before)], before)
    assert np.isclose(area(obj), size, rtol=2e-3)
    assert not obj.data.validate()
    # New vertices know their point, which is on an edge of the donor along which its islands part.
    face = values(obj, "isograft_face", "value")[len(before) :]
    weights = values(obj, "isograft_weights", "vector", 3)[len(before) :]
    assert len(face) > 50
    assert np.all(face >= 0)
    assert np.all(weights.min(axis=1) < 1e-3)
    seams = sum(edge.use_seam and max(edge.vertices) >= len(before) for edge in obj.data.edges)
    assert seams > 50
    # The match has gone along: what comes next needs no new one.
    graft(matched, what={"COLOR"})


def test_all_that_the_receiver_carries_is_cut_along(matched: MatchedPair) -> None:
    obj = matched.receiver
    furnish(obj)
    count = len(obj.data.vertices)
    graft(matched, cut_seams=True, link_materials=False)
    where = points(obj)
    assert len(where) > count
    assert np.abs(uvs(obj, "Own") - linear(where, 2)[loop_vertices(obj)]).max() < 1e-4
    assert np.abs(values(obj, "Own Paint", "color", 4) - linear(where, 4)).max() < 1e-4
    weights = rigs.group_weights(obj, ("Own Group",))
    assert np.abs(weights - 0.5 * linear(where, 1)).max() < 1e-3
    assert obj.vertex_groups["Own Group"].lock_weight
    grown = obj.data.shape_keys.key_blocks["Grown"]
    places = np.array([tuple(point.co) for point in grown.data])
    assert np.abs(places - where - 0.1 * linear(where, 3)).max() < 1e-4
    assert np.array_equal(np.array([tuple(p.co) for p in obj.data.shape_keys.key_blocks["Basis"].data]), where)
    assert grown.mute
    assert [material.name for material in obj.data.materials] == ["One", "Other"]
    slots = np.array([polygon.material_index for polygon in obj.data.polygons])
    assert np.array_equal(np.where(slots == 1, 7, 3), values(obj, "piece", "value"))
    assert len(set(slots)) == 2


def unlike(obj: Any) -> float:
    """How far an object's custom normals are from those that turn evenly over space."""
    lean = np.array([0.3, -0.2, 1.0]) + 0.1 * points(obj)[loop_vertices(obj)]
    read = add_on("bridge").read_corner_normals(obj.data)
    return float(np.abs(read - lean / np.linalg.norm(lean, axis=1, keepdims=True)).max())


def test_custom_normals_are_cut_along(matched: MatchedPair) -> None:
    obj = matched.receiver
    if hasattr(obj.data, "use_auto_smooth"):
        obj.data.use_auto_smooth = True
    lean = np.array([0.3, -0.2, 1.0]) + 0.1 * points(obj)[loop_vertices(obj)]
    obj.data.normals_split_custom_set((lean / np.linalg.norm(lean, axis=1, keepdims=True)).tolist())
    # Blender keeps custom normals in few bits.
    kept = unlike(obj)
    graft(matched, cut_seams=True)
    assert obj.data.has_custom_normals
    assert unlike(obj) < kept + 1e-3


def straight_seams(directions: np.ndarray) -> np.ndarray:
    """UVs (l, 2) whose islands are the 20 faces of the divided icosahedron: each a triangle in a cell of its own."""
    result = []
    for number, corners in enumerate(directions.reshape(20, -1, 3)):
        found, count = np.unique(corners.round(6), axis=0, return_counts=True)
        # The face's own corners lie in one triangle, all others in two or more.
        weights = np.linalg.solve(found[count == 1].T, corners.T).T
        weights /= weights.sum(axis=1, keepdims=True)
        cell = np.array([number % 5, number // 5])
        result.append((cell + 0.1 + 0.8 * weights[:, :2]) / [5.0, 4.0])
    return np.concatenate(result)


def elsewhere(pair: MatchedPair) -> float:
    """Share of the receiver's area where its UVs are not those of the point that it was matched to."""
    made = add_on("pairing").make(pair.donor, [pair.receiver], bpy.context, 0.0)[0]
    own, triangles, given, donor_triangles = made.geometry()
    inside = np.random.default_rng(0).dirichlet([1, 1, 1], len(triangles))
    rows = np.arange(len(triangles), dtype=np.int32)
    found = transfer.locate(made.correspondence, own, triangles, given, donor_triangles, rows, inside)
    theirs = uvs(pair.donor, "Atlas")[made.given.loops[found.face]]
    true = np.einsum("ij,ijk->ik", found.barycentric, theirs)
    mine = np.einsum("ij,ijk->ik", inside, uvs(pair.receiver, "Atlas")[made.own.loops])
    corners = own[triangles]
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    size[(found.face < 0) | ~mine.any(axis=1)] = 0.0
    return float(size[np.abs(mine - true).max(axis=1) > 0.02].sum() / size.sum())


def test_after_the_cut_uvs_are_those_of_the_matched_points(matched: MatchedPair) -> None:
    uv = straight_seams(corner_directions(matched))
    matched.donor.data.uv_layers["Atlas"].data.foreach_set("uv", uv.astype(np.float32).ravel())
    matched.donor.data.update()
    graft(matched)
    before = elsewhere(matched)
    matched.receiver.data.uv_layers.remove(matched.receiver.data.uv_layers["Atlas"])
    graft(matched, cut_seams=True)
    assert before > 0.01
    assert elsewhere(matched) < 0.2 * before


def test_the_seams_of_all_chosen_maps_are_cut(matched: MatchedPair) -> None:
    turned = corner_directions(matched)[:, [1, 2, 0]] @ np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]])
    uv, _ = shapes.cube_uv(turned.reshape(-1, 3, 3))
    add_uv(matched.donor, "Second", uv.reshape(-1, 2))
    graft(matched, cut_seams=True, uv_names="Atlas")
    one = len(matched.receiver.data.vertices)
    graft(matched, cut_seams=True, overwrite=True)
    assert len(matched.receiver.data.vertices) > one + 50
    assert not matched.receiver.data.validate()


def test_a_failure_after_the_cut_changes_nothing(matched: MatchedPair, monkeypatch: pytest.MonkeyPatch) -> None:
    furnish(matched.receiver)
    grafting = add_on("grafting")

    def failing(*_: Any) -> Any:
        raise add_on("bridge").RefusedError("Scan: something stands against it")

    monkeypatch.setattr(grafting, "prepare", failing)
    select(matched.donor, matched.receiver)
    with refused("something stands against it"):
        bpy.ops.object.isograft_transfer(cut_seams=True)
    monkeypatch.undo()
    graft(matched)


def test_where_no_seam_runs_nothing_is_cut(matched: MatchedPair) -> None:
    uv = matched.donor.data.uv_layers["Atlas"]
    flat = corner_directions(matched)[:, :2]
    uv.data.foreach_set("uv", flat.astype(np.float32).ravel())
    matched.donor.data.update()
    before = snapshot(matched.receiver)
    graft(matched, cut_seams=True)
    after = snapshot(matched.receiver)
    assert {key: after[key] for key in ("co", "faces", "properties")} == {
        key: before[key] for key in ("co", "faces", "properties")
    }


def test_a_receiver_that_must_not_be_cut_is_refused(matched: MatchedPair) -> None:
    matched.receiver.modifiers.new("Levels", "MULTIRES")
    select(matched.donor, matched.receiver)
    with refused("Scan: cutting would spoil its modifier Levels"):
        bpy.ops.object.isograft_transfer(cut_seams=True)
    matched.receiver.modifiers.clear()
    other = matched.receiver.copy()
    bpy.context.collection.objects.link(other)
    select(matched.donor, matched.receiver)
    with refused("Scan shares its mesh with another object"):
        bpy.ops.object.isograft_transfer(cut_seams=True)
    bpy.data.objects.remove(other)
    add_uv(matched.receiver, "Own", np.zeros((len(matched.receiver.data.loops), 2)))
    select(matched.receiver, matched.donor)
    with refused("Donor cannot be cut, it is what Scan was matched to"):
        bpy.ops.object.isograft_transfer(cut_seams=True)
