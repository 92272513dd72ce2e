# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in a Blender with a window: uses the add-on as a user would, and writes what it saw to a JSON file.

    blender --enable-event-simulate --addons isograft_addon -P window_session.py -- FOLDER
Every step waits for events to be handled, so the session is a generator driven by a timer.
"""

import json
import os
import sys
import threading
import time
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

sys.path.insert(0, str(Path(__file__).parent))

from scenes import Pair, snapshot
from textures import atlas, material, new_image, texture

FOLDER = Path(sys.argv[sys.argv.index("--") + 1])
PATIENCE = 60.0

seen: dict[str, Any] = {}
ended: list[str] = []


def window() -> Any:
    return bpy.context.window_manager.windows[0]


def view() -> dict[str, Any]:
    area = next(area for area in window().screen.areas if area.type == "VIEW_3D")
    region = next(region for region in area.regions if region.type == "WINDOW")
    return {"window": window(), "area": area, "region": region}


def state() -> list[dict[str, Any]]:
    return [snapshot(bpy.data.objects[name]) for name in ("Donor", "Scan")]


def is_matched() -> bool:
    return "isograft" in bpy.data.objects["Scan"]


def worker_runs() -> bool:
    return any(thread.name == "isograft" for thread in threading.enumerate())


def note_ends() -> None:
    """Have `ended` say when an operator has written what its worker found, or given up."""
    modal = sys.modules["isograft_addon.operators"]._Modal
    end = modal._end

    def noted(self: Any, context: Any) -> None:
        end(self, context)
        ended.append(self.verb)

    modal._end = noted


def wait_for_end() -> Iterator[float]:
    """Until the operator has taken notice that its worker has ended."""
    start = time.monotonic()
    while not ended and time.monotonic() - start < PATIENCE:
        yield 0.1
    ended.clear()
    yield 0.5


def press(key: str) -> Iterator[float]:
    area = view()["area"]
    x, y = area.x + area.width // 2, area.y + area.height // 2
    window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield 0.2
    for value in ("PRESS", "RELEASE"):
        window().event_simulate(type=key, value=value, x=x, y=y)
        yield 0.2


def open_sidebar_tab() -> Iterator[float]:
    """Click down the sidebar's tabs until the add-on's panel is drawn; Blender 3.4 has no call for it."""
    panel = bpy.types.VIEW3D_PT_isograft
    draw, seen["panel_drawn"] = panel.draw, False

    def noted(self: Any, context: Any) -> None:
        draw(self, context)
        seen["panel_drawn"] = True

    panel.draw = noted
    area = view()["area"]
    sidebar = next(region for region in area.regions if region.type == "UI")
    x = sidebar.x + sidebar.width - 8
    for y in range(sidebar.y + sidebar.height - 120, sidebar.y, -25):
        window().event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
        yield 0.1
        for value in ("PRESS", "RELEASE"):
            window().event_simulate(type="LEFTMOUSE", value=value, x=x, y=y)
            yield 0.3
        if seen["panel_drawn"]:
            break
    panel.draw = draw
    yield 0.5


def screenshot(name: str) -> None:
    with bpy.context.temp_override(**view()):
        bpy.ops.screen.screenshot(filepath=str(FOLDER / name))


def start_match() -> list[str]:
    with bpy.context.temp_override(**view()):
        return sorted(bpy.ops.object.isograft_match("INVOKE_DEFAULT", preset="fast"))


def undo() -> None:
    with bpy.context.temp_override(**view()):
        bpy.ops.ed.undo()


def paint_donor() -> None:
    """Give the donor a material with an image."""
    made, shader = material("Skin")
    texture(made, new_image("Paint", atlas(32)), shader.inputs["Base Color"])
    bpy.data.objects["Donor"].data.materials.append(made)


def bake_and_undo() -> Iterator[float]:
    """A bake into a new unwrap, and one step back."""
    paint_donor()
    with bpy.context.temp_override(**view()):
        bpy.ops.ed.undo_push(message="Painted")
    before_bake = state()
    with bpy.context.temp_override(**view()):
        bpy.ops.object.isograft_bake("INVOKE_DEFAULT", size=64, uv_source="UNWRAP")
    yield from wait_for_end()
    seen["baked"] = [item.name for item in bpy.data.objects["Scan"].data.materials if item]
    undo()
    yield 0.5
    seen["one_undo_takes_the_bake_back"] = state() == before_bake


def wrap_and_undo() -> Iterator[float]:
    """The donor's mesh onto the scan, and one step back."""
    before_wrap = state()
    with bpy.context.temp_override(**view()):
        bpy.ops.object.isograft_wrap("INVOKE_DEFAULT", True)
    yield from wait_for_end()
    seen["wrapped"] = sorted(bpy.data.objects.keys())
    undo()
    yield 0.5
    seen["objects_after_undo"] = sorted(bpy.data.objects.keys())
    seen["one_undo_takes_the_wrap_back"] = state() == before_wrap


def session() -> Iterator[float]:
    view()["area"].spaces.active.show_region_ui = True
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    Pair()
    note_ends()
    with bpy.context.temp_override(**view()):
        bpy.ops.view3d.view_all()
        bpy.ops.ed.undo_push(message="Ready")
    yield 1.0
    yield from open_sidebar_tab()
    screenshot("panel.png")
    before = state()

    seen["started"] = start_match()
    yield 0.3
    seen["worker_ran"] = worker_runs()
    screenshot("running.png")
    # The operator is modal: a key that deletes objects must not reach Blender.
    yield from press("X")
    yield from wait_for_end()
    seen["objects_after_delete_key"] = sorted(bpy.data.objects.keys())
    seen["matched"] = is_matched()
    screenshot("matched.png")

    undo()
    yield 0.5
    seen["one_undo_restores"] = state() == before

    seen["started_again"] = start_match()
    yield 0.3
    cancelled = time.monotonic()
    yield from press("ESC")
    while worker_runs():
        yield 0.05
    seen["seconds_to_cancel"] = time.monotonic() - cancelled
    yield from wait_for_end()
    seen["cancel_changes_nothing"] = state() == before

    start_match()
    yield from wait_for_end()
    after_match = state()
    faces = len(bpy.data.objects["Scan"].data.polygons)
    with bpy.context.temp_override(**view()):
        # True: with an undo step, as a button does; a script's call has none of its own.
        seen["transferred"] = sorted(
            bpy.ops.object.isograft_transfer("INVOKE_DEFAULT", True, what={"UV", "COLOR"}, cut_seams=True)
        )
    yield from wait_for_end()
    seen["cut"] = len(bpy.data.objects["Scan"].data.polygons) - faces
    seen["received"] = sorted(bpy.data.objects["Scan"].data.uv_layers.keys())
    undo()
    yield 0.5
    seen["one_undo_takes_the_transfer_back"] = state() == after_match
    seen["still_matched"] = is_matched()
    yield from wrap_and_undo()
    yield from bake_and_undo()


def finish(error: str | None = None) -> None:
    seen["error"] = error
    (FOLDER / "seen.json").write_text(json.dumps(seen))
    # The window is nobody's: leave without asking to save.
    os._exit(1 if error else 0)


def tick() -> float:
    try:
        return next(steps)
    except StopIteration:
        finish()
    except BaseException:
        finish(traceback.format_exc())
    raise AssertionError("finish() does not return")


bpy.context.preferences.view.show_splash = False
bpy.context.preferences.system.viewport_aa = "OFF"
steps = session()
bpy.app.timers.register(tick, first_interval=1.0, persistent=True)
