# SPDX-License-Identifier: GPL-3.0-or-later
"""Whatever goes wrong between a match and the end of a transfer, a bake or a wrap: nothing is written."""

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest
import rigs
import shapes
from conftest import add_on
from scenes import MatchedPair, add_uv, select
from test_refusals import whole_file
from textures import atlas, material, new_image, texture

Call = Callable[[], set[str]]

OPERATORS: dict[str, Call] = {
    "transfer": lambda: bpy.ops.object.isograft_transfer(
        what={"UV", "COLOR", "GROUPS", "KEYS", "ATTRIBUTES", "MATERIALS"}, fill=True, hook_armature=True
    ),
    "transfer with cuts": lambda: bpy.ops.object.isograft_transfer(what={"UV", "GROUPS", "KEYS"}, cut_seams=True),
    "bake": lambda: bpy.ops.object.isograft_bake(size=128, uv_source="UNWRAP", fill=True),
    "wrap": bpy.ops.object.isograft_wrap,
}


@pytest.fixture(params=OPERATORS)
def operator(request: pytest.FixtureRequest) -> Call:
    return OPERATORS[request.param]


@pytest.fixture
def furnished(matched: MatchedPair) -> MatchedPair:
    """A donor that has everything, and a receiver with layers of its own."""
    directions, _ = shapes.triangle_sphere()
    donor, receiver = matched.donor, matched.receiver
    rigs.give_weights(donor, rigs.true_weights(directions))
    rigs.add_armature(donor)
    rigs.add_keys(donor, directions)
    made, shader = material("Skin")
    texture(made, new_image("Paint", atlas(64)), shader.inputs["Base Color"])
    donor.data.materials.append(made)
    fold = donor.data.attributes.new("fold", "FLOAT", "EDGE")
    fold.data.foreach_set("value", np.linspace(0, 1, len(donor.data.edges), dtype=np.float32))
    add_uv(receiver, "Own", np.zeros((len(receiver.data.loops), 2)))
    face = np.array([element.value for element in receiver.data.attributes["isograft_face"].data], dtype=np.int32)
    face[matched.directions[:, 2] > 0.9] = -1
    receiver.data.attributes["isograft_face"].data.foreach_set("value", face)
    select(donor, receiver)
    return matched


def edit(obj: Any) -> None:
    obj.data.vertices[7].co.x += 0.25
    obj.data.update()
    bpy.context.view_layer.update()


def during(monkeypatch: pytest.MonkeyPatch, disturb: Callable[[], None]) -> dict[str, Any]:
    """Once the work of an operator has ended for the first time, before anything is written, something happens."""
    operators = add_on("operators")
    state: dict[str, Any] = {}

    class Disturbed(operators.Job):  # type: ignore[misc, name-defined]
        def run(self) -> list[Any]:
            results: list[Any] = super().run()
            if not state:
                disturb()
                state.update(whole_file())
            return results

    monkeypatch.setattr(operators, "Job", Disturbed)
    return state


def test_all_of_them_work_if_nothing_goes_wrong(furnished: MatchedPair, operator: Call) -> None:
    before = whole_file()
    assert operator() == {"FINISHED"}
    assert whole_file() != before


@pytest.mark.parametrize("name", ["Donor", "Scan"])
def test_an_object_edited_since_the_match(furnished: MatchedPair, operator: Call, name: str) -> None:
    edit(bpy.data.objects[name])
    before = whole_file()
    with pytest.raises(RuntimeError, match=f"{name} was edited after .*run Match again"):
        operator()
    assert whole_file() == before


@pytest.mark.parametrize("calls", [1, 2, 4, 8])
def test_a_cancel_in_the_middle(
    furnished: MatchedPair, operator: Call, calls: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    operators = add_on("operators")
    left = [calls]

    class Impatient(operators.Job):  # type: ignore[misc, name-defined]
        def _report(self, doing: str, fraction: float) -> bool:
            left[0] -= 1
            if left[0] == 0:
                self.cancel()
            return bool(super()._report(doing, fraction))

    monkeypatch.setattr(operators, "Job", Impatient)
    before = whole_file()
    assert operator() == {"CANCELLED"}
    assert left[0] <= 0
    assert whole_file() == before


def test_the_receiver_edited_while_it_runs(
    furnished: MatchedPair, operator: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = during(monkeypatch, lambda: edit(furnished.receiver))
    with pytest.raises(RuntimeError, match="Scan was edited meanwhile; nothing was written"):
        operator()
    assert whole_file() == state


def test_the_receiver_removed_while_it_runs(
    furnished: MatchedPair, operator: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    state = during(monkeypatch, lambda: bpy.data.objects.remove(bpy.data.objects["Scan"]))
    with pytest.raises(RuntimeError, match="Scan was removed or renamed meanwhile; nothing was written"):
        operator()
    assert whole_file() == state


def test_a_second_receiver_edited_while_it_runs_keeps_the_first_from_receiving(
    furnished: MatchedPair, operator: Call, monkeypatch: pytest.MonkeyPatch
) -> None:
    second = furnished.receiver.copy()
    second.name, second.data = "Second", furnished.receiver.data.copy()
    bpy.context.collection.objects.link(second)
    select(furnished.donor, furnished.receiver, second)
    state = during(monkeypatch, lambda: edit(bpy.data.objects["Second"]))
    with pytest.raises(RuntimeError, match="Second was edited meanwhile; nothing was written"):
        operator()
    assert whole_file() == state


def test_an_image_that_is_gone(furnished: MatchedPair) -> None:
    lost = bpy.data.images.new("Lost", 4, 4)
    lost.source, lost.filepath = "FILE", "//nowhere/lost.png"
    nodes = furnished.donor.data.materials[0].node_tree.nodes
    next(node for node in nodes if node.type == "TEX_IMAGE").image = lost
    before = whole_file()
    with pytest.raises(RuntimeError, match="Donor, Base Color of the material Skin: the image Lost cannot be read"):
        OPERATORS["bake"]()
    assert whole_file() == before


@pytest.mark.parametrize("kind", ["UV", "COLOR", "GROUPS", "KEYS", "ATTRIBUTES", "MATERIALS", "NORMALS"])
def test_a_donor_without_what_is_asked_for_beside_something_that_it_has(matched: MatchedPair, kind: str) -> None:
    """The other one of the two kinds is there and comes first or second: it may not arrive alone."""
    mesh, other = matched.donor.data, "COLOR" if kind == "UV" else "UV"
    if kind == "COLOR":
        for name in ("Paint", "Corners"):
            mesh.color_attributes.remove(mesh.color_attributes[name])
    if kind == "UV":
        mesh.uv_layers.remove(mesh.uv_layers["Atlas"])
    mesh.update()
    select(matched.donor, matched.receiver)
    before = whole_file()
    with pytest.raises(RuntimeError, match="Donor has no .*(leave|first)"):
        bpy.ops.object.isograft_transfer(what={kind, other})
    assert whole_file() == before
