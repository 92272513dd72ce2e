# SPDX-License-Identifier: GPL-3.0-or-later
"""The match of several receivers as a job: in the calling thread, or in a worker with progress and cancellation.

Imports no bpy: what runs here never touches Blender's data.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import isograft

Progress = Callable[[str, float], bool]
SurfaceArrays = tuple[Any, Any]


@dataclass(frozen=True)
class Task:
    """What is to be matched: names for the messages, surfaces as (vertices, triangles)."""

    donor_name: str
    donor: SurfaceArrays
    receivers: Sequence[tuple[str, SurfaceArrays]]
    options: dict[str, Any]


class ReceiverError(Exception):
    """An object cannot be matched; the text names it. The cause is the engine's error."""


class Job:
    """One run of a Task. Nothing is kept on cancel or error."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self._cancelled = threading.Event()
        self._thread: threading.Thread | None = None
        self._results: list[Any] | None = None
        self._error: BaseException | None = None
        self._state = ("start", 0.0)

    @property
    def progress(self) -> tuple[str, float]:
        """What is being done, and the fraction done in [0, 1] over all receivers."""
        return self._state

    def cancel(self) -> None:
        """Ask the run to stop; from any thread."""
        self._cancelled.set()

    def start(self) -> None:
        """Run in a worker thread."""
        self._thread = threading.Thread(target=self._run, name="isograft", daemon=True)
        self._thread.start()

    def run(self) -> list[Any]:
        """Run in the calling thread. Returns and raises as result()."""
        self._run()
        return self.result()

    def is_running(self) -> bool:
        """True until a started run has ended."""
        return self._thread is not None and self._thread.is_alive()

    def join(self, timeout: float | None = None) -> None:
        """Wait for the worker, at most `timeout` seconds."""
        if self._thread is not None:
            self._thread.join(timeout)

    def result(self) -> list[Any]:
        """One isograft.Match per receiver, in order, after the run has ended.

        Raises:
            ReceiverError: the input was refused; isograft.Cancelled: cancel() was called.
        """
        if self._error is not None:
            raise self._error
        if self._results is None:
            raise RuntimeError("the job has not run to its end")
        return self._results

    def _run(self) -> None:
        try:
            self._results = self._match_all()
        except BaseException as error:  # carried over to the thread that asks for the result
            self._error = error

    def _match_all(self) -> list[Any]:
        task = self._task
        # All of them first: a mesh that is refused is refused before minutes are spent on the others.
        donor = _surface(task.donor_name, task.donor)
        receivers = [(name, _surface(name, arrays)) for name, arrays in task.receivers]
        results = []
        for index, (name, receiver) in enumerate(receivers):
            if self._cancelled.is_set():
                raise isograft.Cancelled("cancelled by the caller")
            try:
                results.append(isograft.match(receiver, donor, progress=self._progress_of(index, name), **task.options))
            except (isograft.InvalidInput, isograft.ResourceLimit) as error:
                raise ReceiverError(f"{name}: {error}") from error
        self._state = ("done", 1.0)
        return results

    def _progress_of(self, index: int, name: str) -> Progress:
        count = len(self._task.receivers)

        def report(stage: str, fraction: float) -> bool:
            self._state = (f"{name}: {stage}", (index + fraction) / count)
            return not self._cancelled.is_set()

        return report


def _surface(name: str, arrays: SurfaceArrays) -> isograft.Surface:
    try:
        return isograft.Surface(*arrays)
    except (isograft.InvalidInput, isograft.ResourceLimit) as error:
        raise ReceiverError(f"{name}: {error}") from error
