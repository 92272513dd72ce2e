# SPDX-License-Identifier: GPL-3.0-or-later
"""A transfer as the job that a window runs it as: read, computed in a worker, written."""

from types import SimpleNamespace
from typing import Any

import bpy
import isograft
import numpy as np
import pytest
import rigs
import shapes
from conftest import add_on
from isograft import transfer
from scenes import MatchedPair, add_color, add_uv, select, snapshot, uvs, values


def task_of(matched: MatchedPair, **settings: Any) -> Any:
    grafting = add_on("grafting")
    chosen = {"what": {"UV", "COLOR"}, "min_confidence": 0.0} | settings
    return grafting.prepare(matched.donor, [matched.receiver], bpy.context, grafting.Settings(**chosen))


def in_a_worker(task: Any) -> tuple[Any, list[Any]]:
    """The task that writes, and what it found; what cuts first has several runs."""
    while True:
        job = add_on("job").Job(task.task())
        job.start()
        job.join(60)
        assert not job.is_running()
        following = add_on("operators")._following(task, job.result(), bpy.context)
        if following is None:
            return task, job.result()
        task = following


@pytest.mark.parametrize("cut_seams", [False, True])
def test_a_worker_gives_what_the_operator_gives(matched: MatchedPair, cut_seams: bool) -> None:
    before = snapshot(matched.receiver)
    mesh = matched.receiver.data.copy()
    content = matched.receiver["isograft"].to_dict()
    task = task_of(matched, cut_seams=cut_seams)
    assert snapshot(matched.receiver) == before  # read, and nothing changed
    assert isinstance(task, add_on("grafting").CutSearch) == cut_seams
    task, found = in_a_worker(task)
    assert snapshot(matched.receiver) == before  # computed, and nothing changed
    messages = task.write(found)
    assert any(level == "INFO" and "received" in text for level, text in messages)
    after = snapshot(matched.receiver)
    assert after != before

    name, old = mesh.name, matched.receiver.data
    matched.receiver.data = mesh
    bpy.data.meshes.remove(old)
    mesh.name = name
    matched.receiver["isograft"] = content
    bpy.context.view_layer.update()
    select(matched.donor, matched.receiver)
    assert bpy.ops.object.isograft_transfer(what={"UV", "COLOR"}, cut_seams=cut_seams) == {"FINISHED"}
    again = snapshot(matched.receiver)
    assert {key for key in after if after[key] != again[key]} == set()


def test_its_progress_rises_over_kinds_and_layers_and_names_them(matched: MatchedPair) -> None:
    add_color(matched.donor, "More", "FLOAT_COLOR", "CORNER", np.ones((len(matched.donor.data.loops), 4)))
    told: list[tuple[str, float]] = []

    def note(doing: str, fraction: float) -> bool:
        told.append((doing, fraction))
        return True

    task_of(matched).run(note)
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions)
    assert 0.0 <= fractions[0] < 0.1
    assert 0.7 < fractions[-1] <= 1.0
    assert {doing for doing, _ in told} == {"Scan: UV maps", "Scan: colour attributes"}


def test_the_search_for_cuts_is_part_of_the_job_with_its_own_share_of_the_progress(matched: MatchedPair) -> None:
    turned = 0.5 * uvs(matched.donor, "Atlas")[:, ::-1]
    add_uv(matched.donor, "Second", turned)
    select(matched.donor, matched.receiver)
    told: list[tuple[str, float]] = []

    def note(doing: str, fraction: float) -> bool:
        told.append((doing, fraction))
        return True

    task, runs = task_of(matched, cut_seams=True), 1
    while (following := add_on("operators")._following(task, task.run(note), bpy.context)) is not None:
        task, runs = following, runs + 1
    assert runs == 3  # two maps, then the transfer
    fractions = [fraction for _, fraction in told]
    assert fractions == sorted(fractions)
    searching = [fraction for doing, fraction in told if doing == "Scan: seams to cut along"]
    assert 0.3 < max(searching) <= 2 / 3 <= min(f for doing, f in told if doing == "Scan: UV maps")
    assert fractions[-1] > 0.8


def test_what_was_edited_between_two_searches_is_refused(matched: MatchedPair) -> None:
    task = task_of(matched, cut_seams=True)
    found = task.run(lambda *_: True)
    matched.receiver.data.vertices[3].co.x += 0.25
    matched.receiver.data.update()
    bpy.context.view_layer.update()
    before = snapshot(matched.receiver)
    with pytest.raises(add_on("bridge").RefusedError, match="Scan was edited meanwhile; nothing was written"):
        task.then(found, bpy.context)
    assert snapshot(matched.receiver) == before


def test_esc_after_the_end_and_before_the_writing_counts(matched: MatchedPair) -> None:
    job = add_on("job").Job(task_of(matched).task())
    job.run()
    job.cancel()
    with pytest.raises(isograft.Cancelled):
        job.result()


@pytest.mark.parametrize("calls", [1, 2, 5])
def test_it_can_be_cancelled_at_any_call_and_changes_nothing(matched: MatchedPair, calls: int) -> None:
    before = snapshot(matched.receiver)
    left = [calls]

    def stop(doing: str, fraction: float) -> bool:
        left[0] -= 1
        return left[0] > 0

    task = task_of(matched)
    with pytest.raises(isograft.Cancelled):
        task.run(stop)
    assert left[0] <= 0
    assert snapshot(matched.receiver) == before


@pytest.mark.parametrize("kind", ["UV", "COLOR", "GROUPS", "KEYS", "ATTRIBUTES"])
def test_esc_is_heard_while_holes_are_filled(matched: MatchedPair, kind: str) -> None:
    directions, _ = shapes.triangle_sphere()
    rigs.give_weights(matched.donor, rigs.true_weights(directions))
    rigs.add_keys(matched.donor, directions)
    heavy = matched.donor.data.attributes.new("heavy", "FLOAT", "EDGE")
    heavy.data.foreach_set("value", np.ones(len(matched.donor.data.edges), np.float32))
    matched.donor.data.update()
    face = np.where(matched.directions[:, 2] > 0.8, -1, values(matched.receiver, "isograft_face", "value"))
    matched.receiver.data.attributes["isograft_face"].data.foreach_set("value", face.astype(np.int32))
    select(matched.donor, matched.receiver)
    before, filling = snapshot(matched.receiver), add_on("kinds.filling")
    calls: list[str] = []

    def recorded(name: str) -> Any:
        real = getattr(transfer, name)

        def fill(*args: Any, **kwargs: Any) -> Any:
            calls.append(name)
            return real(*args, **kwargs)

        return fill

    stub = SimpleNamespace(**{name: recorded(name) for name in ("fill_point", "fill_corner", "fill_edge")})
    real_module, filling.transfer = filling.transfer, stub
    try:
        with pytest.raises(isograft.Cancelled):
            task_of(matched, what={kind}, fill=True).run(lambda *_: not calls)
    finally:
        filling.transfer = real_module
    assert len(calls) == 1
    assert snapshot(matched.receiver) == before


def test_what_was_edited_or_removed_while_it_ran_is_refused_and_nothing_written(matched: MatchedPair) -> None:
    task, found = in_a_worker(task_of(matched))
    matched.receiver.data.vertices[3].co.x += 0.25
    matched.receiver.data.update()
    bpy.context.view_layer.update()
    before = snapshot(matched.receiver)
    with pytest.raises(add_on("bridge").RefusedError, match="Scan was edited meanwhile; nothing was written"):
        task.write(found)
    assert snapshot(matched.receiver) == before
    bpy.data.objects.remove(matched.donor)
    with pytest.raises(add_on("bridge").RefusedError, match="Donor was removed or renamed meanwhile"):
        task.write(found)
    assert "Atlas" not in matched.receiver.data.uv_layers
    assert values(matched.receiver, "isograft_face", "value").size
