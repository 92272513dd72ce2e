# SPDX-License-Identifier: GPL-3.0-or-later
"""match(): from two surfaces to ranked correspondences."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from isograft import _native
from isograft.arguments import to_int, to_scale
from isograft.correspondence import Correspondence
from isograft.errors import InvalidInput
from isograft.formats.npz import read_npz, write_npz
from isograft.landmarks import to_landmarks
from isograft.presets import check_overrides, preset_options
from isograft.progress import part_of
from isograft.report import Report
from isograft.surface import ProgressCallback, Surface, as_surfaces, check_progress


@dataclass(frozen=True, eq=False)
class Match:
    """Result of match(): correspondences, the best first, and what the call did."""

    best: Correspondence
    #: Maps that contradict the best but are consistent too (the surface maps onto itself), best first.
    alternatives: list[Correspondence]
    report: Report

    def save(self, path: str | os.PathLike[str], source: npt.NDArray[np.float64] | None = None) -> None:
        """Write an .npz: the best's arrays, the alternatives' as `alternative1_...`, and `report` (JSON text).

        With the source's vertices (n, 3) `isograft transfer` knows a map of another shape.
        """
        everyone = [self.best, *self.alternatives]
        write_npz(path, [one.arrays() for one in everyone], self.best.target_size, self.report.to_json(), source)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Match:
        """Read what save() wrote. Raises InvalidInput if the file holds something else."""
        everyone, target_size, text = read_npz(path)
        try:
            report = Report.from_json("{}" if text is None else text)
        except InvalidInput as error:
            raise InvalidInput(f"{path}: {error}") from None
        best, *alternatives = [Correspondence(**arrays, target_size=target_size) for arrays in everyone]
        return cls(best, alternatives, report)


def match(
    source: Any,
    target: Any,
    *,
    preset: str = "default",
    landmarks: Any = None,
    scale: str | float = "auto",
    threads: int | None = None,
    seed: int = 0,
    memory_limit: int | None = None,
    progress: ProgressCallback | None = None,
    names: tuple[str, str] = ("source", "target"),
    **overrides: Any,
) -> Match:
    """Find a dense partial near-isometric correspondence from `source` to `target`.

    No common position, unit or landmarks are needed. What cannot be matched is left unmatched; at worst everything
    is. The result depends on the input, the options and `seed` alone, bit for bit.

    Args:
        source, target: a Surface each, or tuples (vertices, faces) of (n, 3) numbers and (k, 3) integers.
        preset: see presets().
        landmarks: known pairs of points: (k, 2) vertex indices, (k, 2, 3) positions, or {"source": ..., "target": ...}
            with a list of either on each side and perhaps "weight", numbers in (0, 1]. They lead; our own matches
            help, unless `seed_landmarks_only` is True.
        scale: target units per source unit: "auto" finds it, "fixed" is 1, or the number itself.
        threads: worker threads; None takes all cores. The result does not depend on it.
        seed: of every random choice.
        memory_limit: bytes that the match may take. What it will take is estimated before anything is allocated.
        progress: called as progress(stage, fraction) on the calling thread, with fractions that rise to 1, and again
            with the last one while a stage is long; returning False cancels. Other Python threads run meanwhile.
        names: what errors call the two.
        overrides: single options by name, `<stage>_<field>`; see preset_options().

    Raises:
        InvalidInput: an argument cannot be used; the text says which and why.
        ResourceLimit: the surfaces are too large for this build, or for `memory_limit`.
        Cancelled: `progress` returned False. What it raises is passed on; so is KeyboardInterrupt.
    """
    check_progress(progress)
    options = preset_options(preset) | check_overrides(overrides, preset)
    scale_mode, scale_value = to_scale(scale)
    thread_count = 0 if threads is None else to_int(threads, "threads", 1, 1024)
    seed_value = to_int(seed, "seed", 0, 2**64 - 1)
    limit = 0 if memory_limit is None else to_int(memory_limit, "memory_limit", 1, 2**62)
    if limit:
        _native.check_memory(_size(source), _size(target), preset, options, thread_count, limit)
    gate = _gate_share([source], target, preset, options, thread_count)
    s, t = as_surfaces([(names[0], source), (names[1], target)], thread_count, part_of(progress, 0.0, gate))
    marks = to_landmarks(landmarks, s.vertices, t.vertices)

    found = _native.match(
        s.native,
        t.native,
        preset=preset,
        overrides=options,
        landmarks=np.ascontiguousarray(marks.pairs),
        landmark_weights=np.ascontiguousarray(marks.weights),
        scale_mode=scale_mode,
        scale_value=scale_value,
        threads=thread_count,
        seed=seed_value,
        memory_limit=limit,
        progress=part_of(progress, gate, 1.0),
    )
    correspondences = [Correspondence.from_native(item, t.faces, len(t.vertices)) for item in found.correspondences]
    report = Report.from_native(found.report, preset, seed_value, options)
    return Match(correspondences[0], correspondences[1:], report)


def make_surfaces(
    sources: Sequence[tuple[str, Any]],
    target: tuple[str, Any],
    *,
    preset: str = "default",
    threads: int | None = None,
    progress: ProgressCallback | None = None,
) -> tuple[list[Surface], Surface, ProgressCallback | None]:
    """Check several sources and the target they are going to be matched with, side by side; (name, surface) each.

    Returns them with what is left of the progress: the callback that takes it from where this left it to its end.
    """
    thread_count = 0 if threads is None else to_int(threads, "threads", 1, 1024)
    share = _gate_share([value for _, value in sources], target[1], preset, {}, thread_count)
    *made, last = as_surfaces([*sources, target], thread_count, part_of(progress, 0.0, share))
    return made, last, part_of(progress, share, 1.0)


def _gate_share(sources: Sequence[Any], target: Any, preset: str, options: dict[str, Any], threads: int) -> float:
    """Part of the time of matching all sources with the target that is spent on making surfaces of raw arrays."""
    raw = [_size(value) for value in (*sources, target) if not isinstance(value, Surface)]
    if not raw:
        return 0.0
    share = _native.gate_share(raw, _size(sources[0]), _size(target), preset, options, threads)
    return share / (share + len(sources) * (1.0 - share))


def _size(value: Any) -> tuple[int, int]:
    """Vertices and triangles of what match() was given, before anything is made of it; 0 for what is no array."""
    parts = (value.vertices, value.faces) if isinstance(value, Surface) else value
    if not isinstance(parts, (tuple, list)):
        return 0, 0
    counts = [0 if part is None or np.ndim(part) == 0 else len(part) for part in parts[:2]]
    return (counts[0] if counts else 0, counts[1] if len(counts) > 1 else 0)
