# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress of work that is partly done here and partly in the compiled part."""

from __future__ import annotations

from isograft.errors import Cancelled
from isograft.surface import ProgressCallback


def part_of(progress: ProgressCallback | None, start: float, end: float) -> ProgressCallback | None:
    """The same callback for a part of the whole, to be called as if that were all of it; fractions of 1 stay exact."""
    if progress is None:
        return None
    report = progress
    return lambda stage, fraction: report(stage, max(start, end - (end - start) * (1.0 - fraction)))


def tell(progress: ProgressCallback | None, stage: str, fraction: float) -> None:
    """Raises Cancelled if the answer is False."""
    if progress is not None and progress(stage, fraction) is False:
        raise Cancelled("cancelled")
