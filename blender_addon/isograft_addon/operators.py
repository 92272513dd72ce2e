# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: read the settings, let the bridge read, compute, let the bridge write, report."""

from collections.abc import Callable
from typing import Any

import bpy
import isograft

from . import baking, bridge, grafting, matching, properties, transfer_properties, wrapping
from .job import Job, ReceiverError
from .settings import Settings

TICK = 0.1
"""Seconds between two looks at a running job."""

_REFUSALS = (bridge.RefusedError, ReceiverError, isograft.InvalidInput, isograft.ResourceLimit)

_NAVIGATION = {"MIDDLEMOUSE", "WHEELUPMOUSE", "WHEELDOWNMOUSE", "WHEELINMOUSE", "WHEELOUTMOUSE", "MOUSEMOVE"}


def participants(context: bpy.types.Context) -> tuple[Any, list[Any]]:
    """The donor and its receivers: the active object, and every other selected mesh object."""
    donor = context.active_object
    receivers = [obj for obj in context.selected_objects if obj.type == "MESH" and obj != donor]
    return donor, receivers


def selection_problem(context: bpy.types.Context) -> str:
    """What to select first; empty if the selection will do."""
    if context.mode != "OBJECT":
        return "Switch to Object Mode first (Tab)"
    donor, receivers = participants(context)
    if donor is None or donor.type != "MESH":
        return "Make a mesh the active object: it gives"
    if not receivers:
        return "Select the meshes that receive, then the one that gives last, so that it is active"
    return ""


class _DonorToReceivers:
    # Of bpy.types.Operator, which Blender wants to see last among the bases.
    report: Callable[..., None]
    poll_message_set: Callable[[str], None]

    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        problem = selection_problem(context)
        if problem:
            cls.poll_message_set(problem)
        return not problem

    def fail(self, error: BaseException) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def tell(self, messages: list[tuple[str, str]]) -> set[str]:
        for level, text in messages:
            self.report({level}, text)
        return {"FINISHED"}


class _Modal(_DonorToReceivers):
    """An operator whose work runs beside Blender; _plan() reads what it needs and later writes what it found."""

    properties: Any
    verb: str

    def _plan(self, context: bpy.types.Context) -> Any:
        raise NotImplementedError

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Work in the calling thread."""
        try:
            plan = self._plan(context)
            results = Job(plan.task()).run()
            while (following := _following(plan, results, context)) is not None:
                plan = following
                results = Job(plan.task()).run()
            return self.tell(plan.write(results))
        except isograft.Cancelled:
            return self._cancelled()
        except _REFUSALS as error:
            return self.fail(error)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Work in a worker thread; Esc cancels."""
        if bpy.app.background:
            return self.execute(context)
        try:
            self._begin(self._plan(context))
        except _REFUSALS as error:
            return self.fail(error)
        self._timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        self._show(context)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Look after the job. The view may be turned meanwhile, nothing else reaches Blender."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
        if event.type in _NAVIGATION:
            return {"PASS_THROUGH"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        if self._job.is_running():
            self._show(context)
            return {"RUNNING_MODAL"}
        return self._after_run(context)

    def _after_run(self, context: bpy.types.Context) -> set[str]:
        """Run what follows, or write and end."""
        goes_on = False
        try:
            results = self._job.result()
            following = _following(self._running, results, context)
            if following is None:
                return self.tell(self._running.write(results))
            self._begin(following)
            goes_on = True
            return {"RUNNING_MODAL"}
        except isograft.Cancelled:
            return self._cancelled()
        except _REFUSALS as error:
            return self.fail(error)
        finally:
            if not goes_on:
                self._end(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender ends the operator: another file is loaded, or the window closes."""
        self._job.cancel()
        self._job.join()
        self._end(context)

    def _begin(self, plan: Any) -> None:
        """Run a plan's task in the worker."""
        self._running = plan
        self._job = Job(plan.task())
        self._job.start()

    def _cancelled(self) -> set[str]:
        self.report({"WARNING"}, f"{self.verb} cancelled, nothing was changed")
        return {"CANCELLED"}

    def _show(self, context: bpy.types.Context) -> None:
        doing, fraction = self._job.progress
        if context.workspace:
            context.workspace.status_text_set(f"Isograft  {fraction:.0%}  {doing}   |   Esc: Cancel")

    def _end(self, context: bpy.types.Context) -> None:
        context.window_manager.event_timer_remove(self._timer)
        if context.workspace:
            context.workspace.status_text_set(None)


def _following(plan: Any, results: list[Any], context: bpy.types.Context) -> Any:
    """The plan to run next, of one that has to look at Blender between two runs; None if `results` can be written."""
    return plan.then(results, context) if isinstance(plan, grafting.CutSearch) else None


class OBJECT_OT_isograft_match(_Modal, bpy.types.Operator):
    """Find for every vertex of the other selected objects its point on the active object"""

    bl_idname = "object.isograft_match"
    bl_label = "Match"
    verb = "Match"

    def _plan(self, context: bpy.types.Context) -> matching.Plan:
        return matching.plan(*participants(context), context, properties.match_options(self.properties))


class OBJECT_OT_isograft_transfer(_Modal, bpy.types.Operator):
    """Graft what the active object carries onto the other selected objects, along their match"""

    bl_idname = "object.isograft_transfer"
    bl_label = "Transfer"
    verb = "Transfer"

    def _plan(self, context: bpy.types.Context) -> grafting.TransferTask:
        return grafting.prepare(*participants(context), context, Settings.of(self.properties))


class OBJECT_OT_isograft_bake(_Modal, bpy.types.Operator):
    """Bake the images of the active object's materials into the other selected objects' own UV maps"""

    bl_idname = "object.isograft_bake"
    bl_label = "Bake Textures"
    verb = "Bake"

    def _plan(self, context: bpy.types.Context) -> baking.BakeTask:
        settings = baking.BakeSettings.of(self.properties)
        return baking.prepare(*participants(context), context, settings)


class OBJECT_OT_isograft_wrap(_Modal, bpy.types.Operator):
    """Make a new object of the active object's mesh with the shape of each other selected object"""

    bl_idname = "object.isograft_wrap"
    bl_label = "Wrap"
    verb = "Wrap"

    def _plan(self, context: bpy.types.Context) -> wrapping.WrapTask:
        settings = wrapping.WrapSettings.of(self.properties)
        return wrapping.prepare(*participants(context), context, settings)


_CLASSES = (OBJECT_OT_isograft_match, OBJECT_OT_isograft_transfer, OBJECT_OT_isograft_bake, OBJECT_OT_isograft_wrap)


def register() -> None:
    """Register the operators with the native defaults."""
    OBJECT_OT_isograft_match.__annotations__ = properties.match_settings(properties.native_defaults())
    OBJECT_OT_isograft_transfer.__annotations__ = transfer_properties.transfer_settings()
    OBJECT_OT_isograft_bake.__annotations__ = transfer_properties.bake_settings()
    OBJECT_OT_isograft_wrap.__annotations__ = transfer_properties.wrap_settings()
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    """Undo register()."""
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
