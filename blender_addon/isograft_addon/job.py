# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work as a job: in the calling thread, or in a worker with progress and cancellation.

Imports no bpy: what runs here never touches Blender's data.
"""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import isograft
from isograft.matching import make_surfaces

Progress = Callable[[str, float], bool]
SurfaceArrays = tuple[Any, Any]


def in_turn(
    items: Sequence[Any], progress: Progress, label: Callable[[Any, str], str] = lambda _, text: text
) -> list[tuple[Any, Progress]]:
    """Every item with its equal part of the progress, for work done one after the other.

    Args:
        label: of the item and of what it tells, what is told.
    """

    def part(index: int) -> Progress:
        return lambda text, fraction: progress(label(items[index], text), (index + fraction) / len(items))

    return [(item, part(index)) for index, item in enumerate(items)]


class Work(Protocol):
    """What a job runs."""

    def run(self, progress: Progress) -> list[Any]:
        """One result per receiver; calls `progress`, which returns False to cancel, with what is done in [0, 1]."""


@dataclass(frozen=True)
class Task:
    """What is to be matched: names for the messages, surfaces as (vertices, triangles)."""

    donor_name: str
    donor: SurfaceArrays
    receivers: Sequence[tuple[str, SurfaceArrays]]
    options: dict[str, Any]

    def run(self, progress: Progress) -> list[Any]:
        """One isograft.Match per receiver, in order."""
        # All of them first: a mesh that is refused is refused before minutes are spent on the others.
        chosen = {name: self.options[name] for name in ("preset", "threads") if name in self.options}
        try:
            receivers, donor, rest = make_surfaces(
                self.receivers, (self.donor_name, self.donor), progress=progress, **chosen
            )
        except (isograft.InvalidInput, isograft.ResourceLimit) as error:
            raise ReceiverError(str(error)) from error
        assert rest is not None
        results = []
        named = [(name, receiver) for (name, _), receiver in zip(self.receivers, receivers, strict=True)]
        for (name, receiver), part in in_turn(named, rest, lambda item, stage: f"{item[0]}: {stage}"):
            try:
                results.append(isograft.match(receiver, donor, progress=part, **self.options))
            except (isograft.InvalidInput, isograft.ResourceLimit) as error:
                raise ReceiverError(f"{name}: {error}") from error
        return results


class ReceiverError(Exception):
    """An object cannot be matched; the text names it. The cause is the engine's error."""


class Job:
    """One run of some work. Nothing is kept on cancel or error."""

    def __init__(self, work: Work) -> None:
        self._work = work
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
        """What the work returned, after the run has ended.

        Raises:
            ReceiverError: the input was refused; isograft.Cancelled: cancel() was called, be it after the end.
        """
        if self._error is not None:
            raise self._error
        if self._cancelled.is_set():
            raise isograft.Cancelled("cancelled by the caller")
        if self._results is None:
            raise RuntimeError("the job has not run to its end")
        return self._results

    def _run(self) -> None:
        try:
            results = self._work.run(self._report)
            if self._cancelled.is_set():
                raise isograft.Cancelled("cancelled by the caller")
            self._results = results
            self._state = ("done", 1.0)
        except BaseException as error:  # carried over to the thread that asks for the result
            self._error = error

    def _report(self, doing: str, fraction: float) -> bool:
        self._state = (doing, fraction)
        return not self._cancelled.is_set()
