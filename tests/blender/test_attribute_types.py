# SPDX-License-Identifier: GPL-3.0-or-later
"""Attributes of every type that this Blender has, on every domain, against known truth."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import bpy
import numpy as np
import pytest
import shapes
from scenes import MatchedPair, filled_around, select
from test_attributes import ends_of, give, is_matched, with_twin
from test_seams import unmatch

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Sort:
    """A type of attributes: how its elements are called, and values (n, ...) that belong to directions (n, 3)."""

    data_type: str
    key: str
    truth: Callable[[Array], Array]
    is_label: bool = False


def _labels(one: Any, other: Any) -> Callable[[Array], Array]:
    return lambda d: np.where((d[:, :1] > 0) if np.ndim(one) else d[:, 0] > 0, one, other)


def _with_one(d: Array) -> Array:
    return np.concatenate([d, np.ones((len(d), 1))], axis=1)


SORTS = (
    Sort("FLOAT", "value", lambda d: d[:, 2]),
    Sort("FLOAT2", "vector", lambda d: d[:, :2]),
    Sort("FLOAT_VECTOR", "vector", lambda d: d),
    Sort("FLOAT_COLOR", "color", shapes.point_color),
    Sort("BYTE_COLOR", "color", shapes.point_color),
    Sort("QUATERNION", "value", _with_one),
    Sort("FLOAT4X4", "value", lambda d: _with_one(d)[:, :, None] * _with_one(d)[:, None]),
    Sort("INT", "value", _labels(70_000, -3), is_label=True),
    Sort("INT8", "value", _labels(5, -9), is_label=True),
    Sort("INT32_2D", "value", _labels([70_000, 1], [-3, 2]), is_label=True),
    Sort("INT16_2D", "value", _labels([700, 1], [-3, 2]), is_label=True),
    Sort("BOOLEAN", "value", _labels(True, False), is_label=True),
    Sort("STRING", "value", _labels("right", "left"), is_label=True),
)
AVAILABLE = {item.identifier for item in bpy.types.Attribute.bl_rna.properties["data_type"].enum_items}
HERE = [sort for sort in SORTS if sort.data_type in AVAILABLE]
HOLE = np.array([-0.7, 0.6, 0.39])
"""Where the receiver is made to be unmatched."""
DOMAINS = ("POINT", "EDGE", "FACE", "CORNER")


def directions_of(obj: Any, directions: Array, domain: str) -> Array:
    """(n, 3) the mean direction of every element of a domain."""
    if domain == "POINT":
        return directions
    if domain == "EDGE":
        return np.asarray(directions[ends_of(obj)].mean(axis=1))
    if domain == "CORNER":
        return directions[[loop.vertex_index for loop in obj.data.loops]]
    return np.array([directions[list(polygon.vertices)].mean(axis=0) for polygon in obj.data.polygons])


def read(obj: Any, name: str, key: str) -> Array:
    """(n, k) values, or (n,) words."""
    values = [getattr(element, key) for element in obj.data.attributes[name].data]
    if isinstance(values[0], (str, bytes)):
        return np.array([value.decode() if isinstance(value, bytes) else value for value in values])
    return np.array([np.ravel(value) for value in values], dtype=float)


def give_all(obj: Any, directions: Array, domain: str) -> None:
    """An attribute of every type, called as the type."""
    for sort in HERE:
        give(obj, sort.data_type, sort.data_type, domain, sort.key, sort.truth(directions))
    obj.data.update()


def graft(pair: Any, **settings: Any) -> None:
    """With colours and UV maps: which of these kinds such an attribute is, differs between Blenders."""
    select(pair.donor, pair.receiver)
    assert bpy.ops.object.isograft_transfer(what={"ATTRIBUTES", "COLOR", "UV"}, **settings) == {"FINISHED"}


def assert_true(obj: Any, where: Array, ok: Array, domain: str, tolerance: float, wrong: float) -> None:
    """Values are those of the directions: labels but for a share that is `wrong`, others by their median."""
    clear = ok & (np.abs(where[:, 0]) > 0.1)
    assert clear.mean() > 0.4
    for sort in HERE:
        attribute = obj.data.attributes[sort.data_type]
        assert (attribute.domain, attribute.data_type) == (domain, sort.data_type)
        found, truth = read(obj, sort.data_type, sort.key), sort.truth(where)
        if sort.is_label:
            flat = truth if found.ndim == 1 else truth.reshape(len(truth), -1)
            same = found == flat if found.ndim == 1 else (found == flat).all(axis=1)
            assert np.mean(same[clear]) > 1.0 - wrong, sort
        else:
            error = np.abs(found - truth.reshape(found.shape)).max(axis=1)
            assert np.median(error[ok]) < tolerance, sort


def shares_matched(pair: Any, domain: str) -> Array:
    """(n,) the matched share of the vertices of every element of the receiver; of the face's for its corners."""
    ok, mesh = is_matched(pair), pair.receiver.data
    if domain == "POINT":
        return ok.astype(float)
    faces = np.array([ok[list(polygon.vertices)].mean() for polygon in mesh.polygons])
    return faces if domain == "FACE" else np.repeat(faces, [polygon.loop_total for polygon in mesh.polygons])


def test_every_type_is_tried() -> None:
    """A type that a new Blender brings has to be added here."""
    assert {sort.data_type for sort in HERE} == AVAILABLE


@pytest.mark.parametrize("domain", ["POINT", "FACE", "CORNER"])
def test_every_type_arrives_on_its_domain(matched: MatchedPair, domain: str) -> None:
    given, _ = shapes.triangle_sphere()
    give_all(matched.donor, directions_of(matched.donor, given, domain), domain)
    unmatch(matched, matched.directions @ HOLE > 0.93)
    graft(matched)
    where, share = directions_of(matched.receiver, matched.directions, domain), shares_matched(matched, domain)
    # Faces take the value of the middle of a donor's face, up to half a face away.
    assert_true(matched.receiver, where, share == 1, domain, 0.08 if domain == "FACE" else 0.05, 0.03)
    assert (share == 0).sum() > 5
    for sort in HERE:
        values = read(matched.receiver, sort.data_type, sort.key)[share == 0]
        assert np.all(values == ("" if sort.data_type == "STRING" else 0)), sort


def test_every_type_arrives_on_edges_that_are_the_donors(matched: MatchedPair) -> None:
    given = with_twin(matched)
    give_all(matched.donor, directions_of(matched.donor, given, "EDGE"), "EDGE")
    graft(matched)
    ok = is_matched(matched)[ends_of(matched.receiver)].all(axis=1)
    assert_true(matched.receiver, directions_of(matched.receiver, given, "EDGE"), ok, "EDGE", 0.02, 0.05)


@pytest.mark.parametrize("domain", DOMAINS)
def test_every_type_is_filled_on_request(matched: MatchedPair, domain: str) -> None:
    given, _ = shapes.triangle_sphere()
    give_all(matched.donor, directions_of(matched.donor, given, domain), domain)
    unmatch(matched, matched.directions @ HOLE > 0.93)
    graft(matched, fill=True)
    marks = read(matched.receiver, "isograft_filled", "value")[:, 0].astype(bool)
    assert np.array_equal(marks, filled_around(matched.receiver, ~is_matched(matched)))
    for sort in HERE:
        values = read(matched.receiver, sort.data_type, sort.key)
        assert len(values) > 500
        if sort.is_label:
            # Picked, never mixed: no third label.
            some = {tuple(np.ravel(row)) for row in values.tolist()}
            truth = {tuple(np.ravel(row)) for row in sort.truth(np.array([[1.0, 0, 0], [-1.0, 0, 0]])).tolist()}
            empty = {tuple(np.ravel(np.zeros_like(values[0])))}
            # Edges that run along none of the donor's have no value, matched or not.
            assert some <= (truth | empty if domain == "EDGE" else truth), sort
        else:
            assert np.isfinite(values).all(), sort
