# SPDX-License-Identifier: GPL-3.0-or-later
"""The three steps of every kind of data."""

from collections.abc import Callable
from typing import Any, ClassVar

import isograft
import numpy as np

from ..bridge import Array
from ..job import Progress
from ..pairing import Donor, Pair
from ..settings import Names, Settings
from .filling import fill_corners

MANY = 6
"""More names than this are counted instead of listed."""


class Kind:
    """One kind of data on its way to one receiver.

    `read` and the constructor read and refuse, `compute` works on arrays alone, `write` writes what is ready.
    """

    noun: ClassVar[str]

    def __init__(self, pair: Pair, gift: Any, settings: Settings, names: Names) -> None:
        self.pair = pair
        self.gift = gift
        self.settings = settings
        self.names = names
        self.warnings: list[str] = []
        self.filled: Array = np.zeros(len(pair.own.vertices), dtype=bool)
        """Receiver vertices that got values though they are unmatched."""
        self._progress: Progress | None = None
        self._done = 0
        self._told = 0.0

    @classmethod
    def read(cls, donor: Donor, settings: Settings) -> Any:
        """What the donor has of this kind.

        Raises:
            RefusedError: nothing, or not what is asked for.
        """
        raise NotImplementedError

    def run(self, progress: Progress | None = None) -> None:
        """compute(), with what is done in [0, 1]; a False from `progress` raises isograft.Cancelled."""
        self._progress, self._done, self._told = progress, 0, 0.0
        self.compute()

    def compute(self) -> None:
        """Work out what the receiver gets; touches no object of Blender's."""
        raise NotImplementedError

    def step(self, parts: int = 1) -> Progress:
        """What to pass to the next of so many long calls of compute() as its progress."""
        begin, self._done = self._done / parts, self._done + 1

        def report(stage: str, fraction: float) -> bool:
            self._told = min(1.0, begin + fraction / parts)
            return self._progress is None or self._progress(stage, self._told)

        if not report(self.noun, 0.0):
            raise isograft.Cancelled("cancelled by the caller")
        return report

    def hold(self, stage: str, fraction: float) -> bool:
        """The progress of a call that has no share of it: stays where it was, and may cancel."""
        return self._progress is None or self._progress(stage, self._told)

    def write(self) -> None:
        """Give it to the receiver."""
        raise NotImplementedError

    def received(self) -> list[str]:
        """Names of what the receiver gets."""
        raise NotImplementedError

    def move_corners(
        self, move: Callable[..., Any], values: Array, parts: int = 1, complete: Callable[..., Any] = fill_corners
    ) -> tuple[Array, Array]:
        """Values (l, ...) of the donor's loops moved by a function of isograft.transfer, and filled if wanted.

        One of so many parts of this kind's work.

        Returns:
            Rows per corner of the receiver's triangles, and which triangles (F,) have any.
        """
        pair = self.pair
        moved = move(
            pair.correspondence,
            *pair.geometry(),
            values[pair.given.corners],
            receiver_polygons=pair.own.polygons,
            progress=self.step(parts),
        )
        if not self.settings.fill:
            return moved[0], moved.mask
        result, mask, filled = complete(pair, moved[0], moved.mask, self.hold)
        self.filled |= filled
        return result, mask

    def to_loops(self, values: Array, mask: Array, own: Array | None) -> Array:
        """Rows per triangle corner as rows per loop; the receiver's own, or zeros, in polygons that have none."""
        pair = self.pair
        return beside(pair.to_loops(values, mask), pair.whole_polygons(mask)[pair.arrays.loop_polygons], own)

    def summary(self) -> str:
        """What the receiver gets, for the report; empty if nothing."""
        names = self.received()
        if len(names) > MANY:
            return f"{len(names)} {self.noun}s"
        return f"{self.noun} {', '.join(names)}" if names else ""


def beside(values: Array, known: Array, own: Array | None) -> Array:
    """Values, and the receiver's own rows, if it has any that are written over, where nothing is known."""
    return values if own is None else np.where(known.reshape(-1, *[1] * (values.ndim - 1)), values, own)
