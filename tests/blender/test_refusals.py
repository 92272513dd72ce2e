# SPDX-License-Identifier: GPL-3.0-or-later
"""What cannot be done is refused with words that say what to do, and changes nothing."""

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import isograft
import numpy as np
import pytest
from conftest import add_on
from scenes import QUICK, MatchedPair, Pair, add_color, add_mesh, add_uv, select, snapshot

TRIANGLE = np.eye(3)


@contextmanager
def refused(words: str) -> Iterator[None]:
    """The block raises an operator's error with these words, and no object changes."""
    before = whole_file()
    with pytest.raises(RuntimeError, match=words):
        yield
    assert whole_file() == before


def whole_file() -> dict[str, Any]:
    """Every mesh object, and the names of everything that could be left behind."""
    kinds = ("objects", "meshes", "materials", "images", "shape_keys")
    names = {kind: sorted(getattr(bpy.data, kind).keys()) for kind in kinds}
    selected = [obj.name for obj in bpy.context.selected_objects], bpy.context.view_layer.objects.active
    return names | {
        "selected": selected,
        "snapshots": {obj.name: snapshot(obj) for obj in bpy.data.objects if obj.type == "MESH"},
    }


@pytest.fixture(params=["isograft_match", "isograft_transfer"])
def operator(request: pytest.FixtureRequest) -> Callable[[], set[str]]:
    return getattr(bpy.ops.object, request.param)  # type: ignore[no-any-return]


def test_without_an_active_object_it_says_who_gives(operator: Callable[[], set[str]]) -> None:
    select(None, add_mesh("Scan", TRIANGLE, [(0, 1, 2)]))
    with refused("Make a mesh the active object"):
        operator()


def test_with_nothing_selected_it_says_what_to_select(operator: Callable[[], set[str]]) -> None:
    select(add_mesh("Donor", TRIANGLE, [(0, 1, 2)]))
    with refused("Select the meshes that receive"):
        operator()


def test_an_active_object_that_is_no_mesh_cannot_give(operator: Callable[[], set[str]]) -> None:
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "POINT"))
    bpy.context.collection.objects.link(light)
    select(light, add_mesh("Scan", TRIANGLE, [(0, 1, 2)]))
    with refused("Make a mesh the active object"):
        operator()


def test_edit_mode_is_refused(operator: Callable[[], set[str]]) -> None:
    donor = add_mesh("Donor", TRIANGLE, [(0, 1, 2)])
    select(donor, add_mesh("Scan", TRIANGLE, [(0, 1, 2)]))
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        with pytest.raises(RuntimeError, match="Object Mode"):
            operator()
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")


@pytest.mark.parametrize("empty_one", ["Donor", "Scan"])
def test_a_mesh_without_faces_is_refused_by_name(empty_one: str) -> None:
    donor = add_mesh("Donor", TRIANGLE, [] if empty_one == "Donor" else [(0, 1, 2)])
    select(donor, add_mesh("Scan", TRIANGLE, [] if empty_one == "Scan" else [(0, 1, 2)]))
    with refused(f"{empty_one} has no faces"):
        bpy.ops.object.isograft_match()


@pytest.mark.parametrize("bad_one", ["Donor", "Scan"])
def test_a_coordinate_that_is_not_finite_is_refused_by_name(pair: Pair, bad_one: str) -> None:
    bpy.data.objects[bad_one].data.vertices[5].co.y = float("nan")
    with refused(f"{bad_one}: .*finite"):
        bpy.ops.object.isograft_match()


def test_one_receiver_that_fails_leaves_the_others_untouched(pair: Pair) -> None:
    bad = add_mesh("Bad", TRIANGLE * np.nan, [(0, 1, 2)])
    select(pair.donor, pair.receiver, bad)
    with refused("Bad: "):
        bpy.ops.object.isograft_match(**QUICK)


def test_a_mesh_that_is_shared_is_refused_before_anything_runs(pair: Pair) -> None:
    twin = bpy.data.objects.new("Twin", pair.receiver.data)
    bpy.context.collection.objects.link(twin)
    with refused("Scan shares its mesh with another object; make it single user first"):
        bpy.ops.object.isograft_match()


def test_a_donor_that_is_shared_may_give(matched: MatchedPair) -> None:
    bpy.context.collection.objects.link(bpy.data.objects.new("Twin", matched.donor.data))
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_transfer() == {"FINISHED"}


def test_a_receiver_from_another_file_is_refused(match_library: Path) -> None:
    with bpy.data.libraries.load(str(match_library), link=True) as (_, wanted):
        wanted.objects = ["Donor", "Scan"]
    for obj in wanted.objects:
        bpy.context.collection.objects.link(obj)
    select(*wanted.objects)
    with refused("Scan is linked from another file; make it local first"):
        bpy.ops.object.isograft_match()


def test_a_cancelled_match_changes_nothing(pair: Pair, monkeypatch: pytest.MonkeyPatch) -> None:
    operators = add_on("operators")

    class Impatient(operators.Job):  # type: ignore[misc, name-defined]
        def __init__(self, task: Any) -> None:
            super().__init__(task)
            threading.Timer(0.1, self.cancel).start()

    monkeypatch.setattr(operators, "Job", Impatient)
    donor, receiver = snapshot(pair.donor), snapshot(pair.receiver)
    assert bpy.ops.object.isograft_match() == {"CANCELLED"}
    assert (snapshot(pair.donor), snapshot(pair.receiver)) == (donor, receiver)


@pytest.mark.parametrize("name", ["Donor", "Scan"])
def test_an_object_edited_while_the_match_runs_gets_nothing(
    pair: Pair, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    operators = add_on("operators")

    class Disturbed(operators.Job):  # type: ignore[misc, name-defined]
        def run(self) -> list[Any]:
            results: list[Any] = super().run()
            bpy.data.objects[name].data.vertices[0].co.x += 0.25
            bpy.data.objects[name].data.update()
            return results

    monkeypatch.setattr(operators, "Job", Disturbed)
    with pytest.raises(RuntimeError, match=f"{name} was edited while the match ran"):
        bpy.ops.object.isograft_match(**QUICK)
    assert "isograft" not in pair.receiver
    assert not [a for a in pair.receiver.data.attributes if a.name.startswith("isograft")]


def test_a_transfer_without_a_match_says_to_match_first(pair: Pair) -> None:
    with refused("Scan has no match; run Match"):
        bpy.ops.object.isograft_transfer()


def test_a_donor_without_what_is_asked_for_is_named(matched: MatchedPair) -> None:
    mesh = matched.donor.data
    for name in ("Paint", "Corners"):
        mesh.color_attributes.remove(mesh.color_attributes[name])
    mesh.uv_layers.remove(mesh.uv_layers["Atlas"])
    select(matched.donor, matched.receiver)
    with refused("Donor has no UV map; unwrap it first"):
        bpy.ops.object.isograft_transfer()
    with refused("Donor has no colour attribute"):
        bpy.ops.object.isograft_transfer(what={"COLOR"})
    with refused("Nothing to transfer"):
        bpy.ops.object.isograft_transfer(what=set())


@pytest.mark.parametrize("name", ["Donor", "Scan"])
def test_a_transfer_after_an_edit_is_refused(matched: MatchedPair, name: str) -> None:
    obj = bpy.data.objects[name]
    obj.data.vertices[3].co.z += 0.01
    obj.data.update()
    select(matched.donor, matched.receiver)
    with refused(f"{name} was edited after .* matched"):
        bpy.ops.object.isograft_transfer()


def test_a_transfer_from_another_donor_is_refused(matched: MatchedPair) -> None:
    other = add_mesh("Other", TRIANGLE, [(0, 1, 2)])
    add_uv(other, "Map", np.zeros((3, 2)))
    select(other, matched.receiver)
    with refused("Scan was matched to Donor, not to Other"):
        bpy.ops.object.isograft_transfer()


def test_a_renamed_donor_still_gives(matched: MatchedPair) -> None:
    matched.donor.name = "Renamed"
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_transfer() == {"FINISHED"}


@pytest.mark.parametrize("name", ["isograft_face", "isograft_weights"])
def test_a_match_whose_attributes_are_gone_or_edited_is_refused(matched: MatchedPair, name: str) -> None:
    attributes = matched.receiver.data.attributes
    select(matched.donor, matched.receiver)
    if name == "isograft_face":
        attributes[name].data.foreach_set("value", np.full(len(matched.directions), 10**6, np.int32))
    else:
        attributes[name].data.foreach_set("vector", np.full(3 * len(matched.directions), 0.5, np.float32))
    with refused("were edited; run Match again"):
        bpy.ops.object.isograft_transfer()
    attributes.remove(attributes[name])
    with refused("are missing"):
        bpy.ops.object.isograft_transfer()


def test_a_ninth_uv_map_is_refused(matched: MatchedPair) -> None:
    for number in range(8):
        add_uv(matched.receiver, f"Map {number}", np.zeros((len(matched.receiver.data.loops), 2)))
    select(matched.donor, matched.receiver)
    with refused("more than 8 UV maps"):
        bpy.ops.object.isograft_transfer()


def test_one_receiver_without_a_match_keeps_the_others_from_receiving(matched: MatchedPair) -> None:
    stranger = add_mesh("Stranger", TRIANGLE, [(0, 1, 2)])
    add_color(stranger, "Paint", "FLOAT_COLOR", "POINT", np.ones((3, 4)))
    select(matched.donor, matched.receiver, stranger)
    with refused("Stranger has no match"):
        bpy.ops.object.isograft_transfer(what={"UV", "COLOR"})


def test_the_job_tells_its_progress_from_the_first_check_on(pair: Pair) -> None:
    matching = add_on("matching")
    task = matching.plan(pair.donor, [pair.receiver], bpy.context, {"preset": "fast"}).task()
    told: list[tuple[str, float]] = []

    def stop_at_the_match(doing: str, fraction: float) -> bool:
        told.append((doing, fraction))
        return not doing.startswith("Scan: ")

    with pytest.raises(isograft.Cancelled):
        task.run(stop_at_the_match)
    # It is asked for now and then, so the first answer may come when some of the first check is done.
    assert told[0][0] == "surface"
    assert told[0][1] < 0.05
    assert told[-1][0].startswith("Scan: ")
    assert [fraction for _, fraction in told] == sorted(fraction for _, fraction in told)


def test_the_job_ends_with_cancelled_and_keeps_no_result(pair: Pair) -> None:
    job_module, matching = add_on("job"), add_on("matching")
    plan = matching.plan(pair.donor, [pair.receiver], bpy.context, {"threads": 1})
    job = job_module.Job(plan.task())
    job.start()
    assert job.is_running()
    job.cancel()
    job.join(10)
    assert not job.is_running()
    with pytest.raises(isograft.Cancelled):
        job.result()


def test_the_jobs_progress_rises_over_all_receivers_and_ends_at_one(pair: Pair) -> None:
    job_module, matching = add_on("job"), add_on("matching")
    second = add_mesh("Second", *shape_of(pair.donor))
    plan = matching.plan(pair.donor, [pair.receiver, second], bpy.context, {"preset": "fast", "scale": "fixed"})
    job = job_module.Job(plan.task())
    seen = []
    job.start()
    while job.is_running():
        seen.append(job.progress)
        job.join(0.01)
    assert len(job.result()) == 2
    fractions = [fraction for _, fraction in seen]
    assert fractions == sorted(fractions)
    assert any(text.startswith("Scan: ") for text, _ in seen)
    assert all(fraction >= 0.5 for text, fraction in seen if text.startswith("Second: "))
    assert job.progress == ("done", 1.0)


def shape_of(obj: Any) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    return np.array([tuple(v.co) for v in obj.data.vertices]), [tuple(p.vertices) for p in obj.data.polygons]
